//! How long predictions and epochs take for 12 000 rows of 8 photodiodes to 3 forces on one thread: the least of many.
//! Fits: `least_squares.rs`; other programs: `lunula tradeoff predictor` with `make peers`.
//!
//! `cargo bench -p lunula-predictor --bench predictor`

use std::hint::black_box;
use std::time::Instant;

use lunula_predictor::{Dataset, LeastSquaresOptions, Model, TrainOptions};
use lunula_predictor::{fit_linear, fit_quadratic, train_network};
use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const ROWS: usize = 12_000;
const INPUTS: usize = 8;
const TARGETS: usize = 3;
const NODES: usize = 8;
/// Epochs timed at once.
const EPOCHS: usize = 10;
/// Runs of which the least counts: what other work on the machine disturbs least.
const RUNS: usize = 35;

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

fn main() {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    one_thread.install(run);
}

fn run() {
    let data = sensor();
    let options = LeastSquaresOptions::default();
    let epochs = TrainOptions {
        hidden: NODES,
        restarts: 1,
        max_epochs: EPOCHS,
        min_gradient: 0.0,
        min_decrease: 0.0,
        ..TrainOptions::default()
    };
    let train = || train_network(&data, None, &epochs).expect("a network");
    println!("{ROWS} rows, {INPUTS} inputs, {TARGETS} targets, one thread; the least of {RUNS} runs");
    let one_row = data.x().row(ROWS / 2).to_vec();
    let mut all = Array2::zeros((ROWS, TARGETS));
    for (name, model) in [
        ("linear", Model::Linear(fit_linear(&data, &options).expect("a fit").0)),
        ("quadratic", Model::Quadratic(fit_quadratic(&data, &options).expect("a fit").0)),
        ("network of 8", Model::Network(train().0)),
    ] {
        let batch = nanoseconds(|| model.predict_into(black_box(data.x().view()), all.view_mut()));
        let mut out = [0.0; TARGETS];
        // As many as a batch has: a single one is shorter than the clock's steps.
        let rows = nanoseconds(|| (0..ROWS).for_each(|_| model.predict_row(black_box(&one_row), black_box(&mut out))));
        let [batch, row] = [batch, rows].map(|time| time / ROWS as f64);
        println!("{name:<14} {batch:>7.1} ns a row of a batch, {row:>7.1} ns a single row");
    }
    let mut done = 0;
    let epochs_ns = nanoseconds(|| done = train().1.restarts[0].epochs);
    println!("epoch of Levenberg-Marquardt, {NODES} nodes: {:.2} ms", 1e-6 * epochs_ns / done as f64);
}

fn nanoseconds(mut work: impl FnMut()) -> f64 {
    let times = (0..RUNS).map(|_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64() * 1e9
    });
    times.fold(f64::INFINITY, f64::min)
}
