//! How long fits, predictions and epochs take for 12 000 rows of 8 photodiodes to 3 forces on one thread, as ratios in
//! one run with numpy and scikit-learn (`bench/peers/predictor.py`, versions in its `requirements.txt`), in turns.
//!
//! `cargo bench -p lunula-predictor --bench predictor [-- NAME]` (only lines whose name holds NAME); `PYTHON` names the
//! interpreter (default python3). Where it lacks the packages, or has other versions than those pinned, that is said.

use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;

use lunula_predictor::{Dataset, LeastSquaresOptions, Linear, Model, Network, Quadratic, TrainOptions};
use lunula_predictor::{fit_linear, fit_quadratic, train_network};
use ndarray::Array2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const ROWS: usize = 12_000;
const INPUTS: usize = 8;
const TARGETS: usize = 3;
const NODES: usize = 8;
/// Rounds: ours, then every peer, and again.
const ROUNDS: usize = 5;
/// Epochs timed at once.
const EPOCHS: usize = 10;

/// One line of the table: ours, and whose names begin alike.
struct Job<'a> {
    name: &'static str,
    peers: Vec<&'static str>,
    /// Returns nanoseconds a sample (batch) or a call.
    ours: Box<dyn FnMut() -> f64 + 'a>,
}

/// As from a sensor: volts about 3, a mixture of three forces with curvature, and noise of 2 mV.
fn sensor() -> Dataset {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
    let slopes: Vec<f64> = (0..INPUTS * TARGETS).map(|_| 0.1 * normal()).collect();
    let bends: Vec<f64> = (0..INPUTS).map(|_| 0.3 + 0.1 * normal().abs()).collect();
    let offsets: Vec<f64> = (0..INPUTS).map(|_| 3.0 + 0.2 * normal()).collect();
    let y = Array2::from_shape_fn((ROWS, TARGETS), |(row, k)| {
        let (t, phase) = (row as f64 * 0.01, k as f64 * 2.1);
        if k == 2 { -1.5 + 1.5 * (0.11 * t).cos() } else { (0.11 * t).sin() * (1.3 * t + phase).cos() }
    });
    let x = Array2::from_shape_fn((ROWS, INPUTS), |(row, i)| {
        let push: f64 = (0..TARGETS).map(|k| slopes[i * TARGETS + k] * y[[row, k]]).sum();
        offsets[i] + push / (1.0 + bends[i] * push.abs()) + 0.002 * normal()
    });
    let names = |letter: &str, n: usize| (1..=n).map(|k| format!("{letter}{k}")).collect();
    Dataset::plain(names("P", INPUTS), names("F", TARGETS), x, y, 0.01).expect("rows")
}

/// Numbers of the right sizes: what they are does not change the time.
fn models(data: &Dataset) -> [Model; 3] {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let mut some =
        |rows: usize, columns: usize| Array2::from_shape_simple_fn((rows, columns), || random.random_range(-1.0..1.0));
    let centre = data.x().mean_axis(ndarray::Axis(0)).expect("rows").to_vec();
    let offset = vec![0.5; TARGETS];
    [
        Linear::new(centre.clone(), offset.clone(), some(TARGETS, INPUTS)).map(Model::Linear),
        Quadratic::new(centre.clone(), vec![0.125; INPUTS], offset.clone(), some(TARGETS, 44)).map(Model::Quadratic),
        Network::new(
            centre,
            vec![0.125; INPUTS],
            some(NODES, INPUTS),
            vec![0.1; NODES],
            some(TARGETS, NODES),
            offset.clone(),
            offset,
            vec![1.5; TARGETS],
        )
        .map(Model::Network),
    ]
    .map(|model| model.expect("a model"))
}

/// Nanoseconds of one call: the least of a few blocks that last milliseconds.
fn nanoseconds(mut work: impl FnMut()) -> f64 {
    let start = Instant::now();
    work();
    let once = start.elapsed().as_secs_f64().max(1e-8);
    let repeats = (0.007 / once).ceil() as u32;
    let times: Vec<f64> = (0..7)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..repeats {
                work();
            }
            start.elapsed().as_secs_f64() * 1e9 / f64::from(repeats)
        })
        .collect();
    least(&times)
}

struct Peers {
    process: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl Peers {
    /// `None` where python3 or a package is missing, which is reported.
    fn start(folder: &Path) -> Option<Self> {
        let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
        let there = Command::new(&python).args(["-c", "import numpy, sklearn"]).stderr(Stdio::null()).status();
        if !there.is_ok_and(|status| status.success()) {
            println!(
                "peers left out: {python} has no numpy or no scikit-learn (pip install -r \
                 bench/peers/requirements.txt)"
            );
            return None;
        }
        versions(&python);
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../bench/peers/predictor.py");
        let mut process =
            Command::new(&python).arg(script).arg(folder).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().ok()?;
        let (to, from) = (process.stdin.take()?, BufReader::new(process.stdout.take()?));
        Some(Self { process, to, from })
    }

    fn nanoseconds(&mut self, name: &str) -> f64 {
        writeln!(self.to, "{name}").expect("the peers listen");
        let mut line = String::new();
        self.from.read_line(&mut line).expect("the peers answer");
        let answer: serde_json::Value = serde_json::from_str(&line).unwrap_or_else(|_| panic!("{name}: {line}"));
        answer["min_ns"].as_f64().expect("a time")
    }
}

/// Says where the packages are not those of `requirements.txt`.
fn versions(python: &str) {
    for pinned in include_str!("../../../bench/peers/requirements.txt").lines() {
        let Some((package, wanted)) = pinned.split_once("==") else { continue };
        let code = format!("from importlib.metadata import version; print(version('{package}'), end='')");
        let found = Command::new(python).args(["-c", &code]).output().map(|output| output.stdout).unwrap_or_default();
        let found = String::from_utf8_lossy(&found);
        if found != wanted {
            println!(
                "{package} is {found}, not {wanted} as pinned in bench/peers/requirements.txt: ratios are another \
                 version's"
            );
        }
    }
}

fn main() {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    one_thread.install(run);
}

fn run() {
    let data = sensor();
    let models = models(&data);
    let folder = std::env::temp_dir().join(format!("lunula-predictor-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    for (name, values) in [("x.f64", data.x()), ("y.f64", data.y())] {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        std::fs::write(folder.join(name), bytes).expect("a file");
    }
    let mut peers = Peers::start(&folder);
    let mut jobs = jobs(&data, &models);
    println!("{ROWS} rows, {INPUTS} inputs, {TARGETS} targets, one thread; least of {ROUNDS} rounds in turns");
    let only = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).unwrap_or_default();
    for job in jobs.iter_mut().filter(|job| job.name.contains(&only)) {
        let mut ours = Vec::new();
        let mut theirs = vec![Vec::new(); job.peers.len()];
        for _ in 0..ROUNDS {
            ours.push((job.ours)());
            if let Some(peers) = &mut peers {
                for (times, name) in theirs.iter_mut().zip(&job.peers) {
                    times.push(peers.nanoseconds(name));
                }
            }
        }
        println!("{:<44} {}", job.name, time(least(&ours)));
        for (name, times) in job.peers.iter().zip(&theirs).filter(|(_, times)| !times.is_empty()) {
            let ratio = least(times) / least(&ours);
            println!("  {name:<42} {}   {ratio:>8.2} times ours", time(least(times)));
        }
    }
    if let Some(Peers { mut process, to, .. }) = peers {
        drop(to);
        process.wait().expect("the peers end");
    }
    std::fs::remove_dir_all(&folder).expect("the temporary folder goes");
}

fn jobs<'a>(data: &'a Dataset, models: &'a [Model; 3]) -> Vec<Job<'a>> {
    let batch = |model: &'a Model| -> Box<dyn FnMut() -> f64 + 'a> {
        let mut out = Array2::zeros((ROWS, TARGETS));
        Box::new(move || nanoseconds(|| model.predict_into(black_box(data.x().view()), out.view_mut())) / ROWS as f64)
    };
    let row = |model: &'a Model| -> Box<dyn FnMut() -> f64 + 'a> {
        let x = data.x().row(ROWS / 2).to_vec();
        let mut out = [0.0; TARGETS];
        Box::new(move || nanoseconds(|| model.predict_row(black_box(&x), black_box(&mut out))))
    };
    let [linear, quadratic, network] = models;
    let epochs = TrainOptions {
        hidden: NODES,
        restarts: 1,
        max_epochs: EPOCHS,
        min_gradient: 0.0,
        min_decrease: 0.0,
        ..TrainOptions::default()
    };
    let whole = TrainOptions { restarts: 1, ..TrainOptions::default() };
    vec![
        Job {
            name: "fit linear",
            peers: vec!["fit linear: numpy lstsq", "fit linear: numpy design + lstsq", "fit linear: scikit-learn"],
            ours: Box::new(|| {
                nanoseconds(|| drop(black_box(fit_linear(data, &LeastSquaresOptions::default()).expect("a fit"))))
            }),
        },
        Job {
            name: "fit quadratic",
            peers: vec![
                "fit quadratic: numpy lstsq",
                "fit quadratic: numpy design + lstsq",
                "fit quadratic: scikit-learn",
            ],
            ours: Box::new(|| {
                nanoseconds(|| drop(black_box(fit_quadratic(data, &LeastSquaresOptions::default()).expect("a fit"))))
            }),
        },
        Job {
            name: "batch linear, a sample",
            peers: vec!["batch linear: numpy", "batch linear: scikit-learn"],
            ours: batch(linear),
        },
        Job {
            name: "batch quadratic, a sample",
            peers: vec![
                "batch quadratic: numpy, 44 columns",
                "batch quadratic: numpy, forms",
                "batch quadratic: scikit-learn",
            ],
            ours: batch(quadratic),
        },
        Job {
            name: "batch network of 8, a sample",
            peers: vec!["batch network: numpy", "batch network: scikit-learn"],
            ours: batch(network),
        },
        Job { name: "row linear", peers: vec!["row linear: numpy", "row linear: scikit-learn"], ours: row(linear) },
        Job {
            name: "row quadratic",
            peers: vec!["row quadratic: numpy, forms", "row quadratic: scikit-learn"],
            ours: row(quadratic),
        },
        Job {
            name: "row network of 8",
            peers: vec!["row network: numpy", "row network: scikit-learn"],
            ours: row(network),
        },
        Job {
            name: "epoch of Levenberg-Marquardt, 8 nodes",
            peers: vec!["epoch: numpy, whole Jacobian", "epoch: numpy, target by target", "epoch: numpy, shared sums"],
            ours: Box::new(move || {
                let run = || {
                    let start = Instant::now();
                    let (_, report) = train_network(data, None, &epochs).expect("a network");
                    start.elapsed().as_secs_f64() * 1e9 / report.restarts[0].epochs as f64
                };
                // As often as the peers' epochs.
                least(&std::array::from_fn::<f64, 7, _>(|_| run()))
            }),
        },
        Job {
            name: "train network of 8, one start, to convergence",
            peers: vec!["train network: scikit-learn L-BFGS"],
            ours: Box::new(move || {
                let start = Instant::now();
                black_box(train_network(data, None, &whole).expect("a network"));
                start.elapsed().as_secs_f64() * 1e9
            }),
        },
    ]
}

/// What other work on the machine disturbs least.
fn least(times: &[f64]) -> f64 {
    times.iter().copied().fold(f64::INFINITY, f64::min)
}

fn time(nanoseconds: f64) -> String {
    match nanoseconds {
        n if n < 1e4 => format!("{n:>9.1} ns"),
        n if n < 1e7 => format!("{:>9.1} us", n / 1e3),
        n => format!("{:>9.1} ms", n / 1e6),
    }
}
