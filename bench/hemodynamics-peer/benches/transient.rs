//! Time and error of the transient solver against diffsol's BDF, in turns in one run, and against what Python and C
//! have.
//!
//! `cargo bench -p lunula-hemodynamics-peer [-- --quick] [--peers] [--out FILE]`
//!
//! `--peers` runs `bench/peers/hemodynamics.py` of the repository as well (RADAU5, LSODA, CVODE, SciPy,
//! scikit-sundae), right after, and puts its rows into the same table.
//!
//! Twenty step responses (P_F1 alone and P_F1 = P_F2, ten loads each, 0 to 2 s) of 4 s with 400 outputs from rest. All
//! solve the same equations in conductances, in states scaled by the nominal diameters. diffsol has the analytic
//! Jacobian, `atol = rtol` on lumens and `10 rtol` on rates or, "loose rates", `1e4 rtol` (as the Python peers), dense
//! matrices of nalgebra (those of faer take 2.6 times as long), the first step that served it best, and is restarted
//! at 2 s. A row of CSV for each solver and tolerance:
//!
//! `solver,rtol,error,microseconds,evaluations`
//!
//! error: the greatest `|x - x_ref| / D` over the times of that crate's tests/reference, all walls and responses.
//! microseconds: a response, the fastest of several rounds over all. evaluations: of the accelerations of all walls, a
//! response. Then the times at equal error, by straight lines between the logarithms, and one sample a step at 1 kHz.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::process::Command;
use std::time::Instant;

use lunula_hemodynamics::{
    Collapse, Inputs, Live, Load, Loads, Model, Order, Parameters, SolveOptions, Solver, State, Trajectory, simulate,
};

use lunula_hemodynamics_peer::{Peer, Step, bdf};

/// A response: its loads in pascals, when they are asked for, what the lumens are then.
struct Case {
    step: Step,
    loads: Loads,
    reference: Vec<(f64, [f64; 3])>,
}

/// Solves a case for times; lumens of each, and evaluations.
type Solve<'a> = Box<dyn FnMut(&Case, f64, &[f64], &mut Vec<[f64; 3]>) -> Result<u64, String> + 'a>;

struct Row {
    solver: String,
    rtol: f64,
    error: f64,
    microseconds: f64,
    evaluations: f64,
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let quick = arguments.iter().any(|argument| argument == "--quick");
    let out = arguments.iter().position(|argument| argument == "--out").and_then(|at| arguments.get(at + 1));
    let cases = cases();
    let rest = rest();
    let model = Model::new(&Parameters::thesis(), Collapse::Error);
    let times: Vec<f64> = (1..=400).map(|k| f64::from(k) / 100.0).collect();

    let mut solvers: Vec<(String, Solve<'_>)> = Vec::new();
    for (name, order) in [
        ("lunula", Order::Auto),
        ("lunula order 5", Order::Fifth),
        ("lunula order 9", Order::Ninth),
        ("lunula order 13", Order::Thirteenth),
    ] {
        solvers.push((name.to_owned(), ours(&model, &rest, order)));
    }
    for (name, rates) in [("", 10.0), (" loose rates", 1e4)] {
        let peer = Peer { rest: &rest, rates };
        solvers.push((format!("diffsol BDF{name}"), Box::new(move |c, r, t, o| bdf(&peer, c.step, r, t, o))));
    }

    let exponents: Vec<i32> = if quick { vec![4, 6, 9, 12] } else { (3..=12).collect() };
    let rounds = if quick { 5 } else { 15 };
    let mut rows: Vec<Row> = Vec::new();
    for &exponent in &exponents {
        let rtol = 10f64.powi(-exponent);
        let mut slots = Vec::new();
        for (name, solve) in &mut solvers {
            match error(solve, &cases, rtol) {
                Ok((error, evaluations)) => slots.push((name.clone(), solve, error, evaluations, f64::INFINITY)),
                Err(fault) => eprintln!("{name} at {rtol:e}: {fault}"),
            }
        }
        let mut lumens = Vec::new();
        for _ in 0..rounds {
            for (_, solve, _, _, best) in &mut slots {
                let begun = Instant::now();
                for case in &cases {
                    solve(case, rtol, &times, &mut lumens).expect("it came through before");
                }
                *best = best.min(begun.elapsed().as_secs_f64() / cases.len() as f64);
            }
        }
        for (solver, _, error, evaluations, best) in slots {
            eprintln!("{solver:34} {rtol:6.0e}  error {error:8.1e}  {:7.1} us  {evaluations:6.0}", best * 1e6);
            rows.push(Row { solver, rtol, error, microseconds: best * 1e6, evaluations });
        }
    }

    if arguments.iter().any(|argument| argument == "--peers") {
        rows.extend(python(quick));
    }
    let mut csv = String::from("solver,rtol,error,microseconds,evaluations\n");
    for Row { solver, rtol, error, microseconds, evaluations } in &rows {
        writeln!(csv, "{solver},{rtol:e},{error:e},{microseconds:.2},{evaluations:.0}").expect("a string takes it");
    }
    match out {
        Some(path) => std::fs::write(path, csv).expect("the table is written"),
        None => print!("{csv}"),
    }
    at_equal_error(&rows);
    live(&model, &rest);
}

fn ours<'a>(model: &Model, rest: &'a State, order: Order) -> Solve<'a> {
    let (mut solver, mut trajectory) = (Solver::new(model), Trajectory::default());
    Box::new(move |case, rtol, times, lumens| {
        let options = SolveOptions { order, start_s: Some(0.0), ..SolveOptions::at(rtol) };
        solver.run(&case.loads, rest, times, &options, &mut trajectory).map_err(|fault| fault.to_string())?;
        lumens.clear();
        lumens.extend((0..trajectory.len()).map(|k| [0, 1, 2].map(|j| trajectory.lumens(k)[j])));
        Ok(trajectory.statistics().evaluations)
    })
}

/// The greatest error over all cases, and the mean number of evaluations.
fn error(solve: &mut Solve<'_>, cases: &[Case], rtol: f64) -> Result<(f64, f64), String> {
    let (mut worst, mut evaluations, mut lumens) = (0.0f64, 0, Vec::new());
    for case in cases {
        let times: Vec<f64> = case.reference.iter().map(|row| row.0).collect();
        evaluations += solve(case, rtol, &times, &mut lumens)?;
        for ((_, exact), got) in case.reference.iter().zip(&lumens) {
            for j in 0..3 {
                let error = (got[j] - 1.0 - exact[j]).abs();
                worst = if error <= worst { worst } else { error };
            }
        }
    }
    Ok((worst, evaluations as f64 / cases.len() as f64))
}

/// The rows of the Python script, which says itself what it leaves out.
fn python(quick: bool) -> Vec<Row> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../bench/peers/hemodynamics.py");
    let answer = Command::new(&python).arg(script).args(quick.then_some("--quick")).output().expect("python3 runs");
    eprint!("{}", String::from_utf8_lossy(&answer.stderr));
    let rows = String::from_utf8_lossy(&answer.stdout).into_owned();
    let lines = rows.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let number = |k: usize| fields[k].parse::<f64>().unwrap_or_else(|_| panic!("{line}"));
            let [rtol, error, microseconds, evaluations] = [1, 2, 3, 4].map(number);
            Row { solver: fields[0].to_owned(), rtol, error, microseconds, evaluations }
        })
        .collect()
}

/// Our time and every peer's at the errors of a tolerance.
fn at_equal_error(rows: &[Row]) {
    let mut solvers: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.error > 0.0) {
        solvers.entry(&row.solver).or_default().push((row.error.log10(), row.microseconds.log10()));
    }
    for error in [1e-4f64, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12] {
        let time = |name: &str| interpolate(&solvers[name], error.log10()).map(|time| 10f64.powf(time));
        let Some(ours) = time("lunula") else { continue };
        eprintln!("at an error of {error:e}: {ours:.1} us");
        for peer in solvers.keys().filter(|name| !name.starts_with("lunula")) {
            match time(peer) {
                Some(theirs) => eprintln!("  {peer:34} {theirs:9.1} us, {:6.1} times", theirs / ours),
                None => eprintln!("  {peer:34} has no such error"),
            }
        }
    }
}

/// Straight between points, which need not be in order; none outside.
fn interpolate(points: &[(f64, f64)], at: f64) -> Option<f64> {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let pair = points.windows(2).find(|pair| pair[0].0 <= at && at <= pair[1].0)?;
    let part = if pair[1].0 > pair[0].0 { (at - pair[0].0) / (pair[1].0 - pair[0].0) } else { 0.0 };
    Some(pair[0].1 + part * (pair[1].1 - pair[0].1))
}

/// A second at 1 kHz: a force that rises within 50 ms and falls again, over blood that beats once a second.
fn live(model: &Model, rest: &State) {
    let smooth = |x: f64| 0.5 - 0.5 * (PI * x.clamp(0.0, 1.0)).cos();
    let samples: Vec<Inputs> = (0..=1000)
        .map(|k| {
            let time_s = f64::from(k) / 1000.0;
            let force = 5000.0 * (smooth((time_s - 0.1) / 0.05) - smooth((time_s - 0.6) / 0.05));
            let upstream_pa = 1e4 + 1000.0 * (TAU * time_s).sin();
            Inputs { upstream_pa, downstream_pa: 0.0, proximal_pa: force, distal_pa: 0.5 * force }
        })
        .collect();
    let times: Vec<f64> = (0..=1000).map(|k| f64::from(k) / 1000.0).collect();
    let table = |value: fn(&Inputs) -> f64| -> Load {
        Load::table(&times, &samples.iter().map(value).collect::<Vec<f64>>()).expect("a recording")
    };
    let loads = Loads {
        upstream: table(|u| u.upstream_pa),
        downstream: table(|u| u.downstream_pa),
        proximal: table(|u| u.proximal_pa),
        distal: table(|u| u.distal_pa),
    };
    let exact = simulate(model, &loads, rest, &times, &SolveOptions::at(1e-12)).expect("a tight run");
    let (mut best, mut worst) = (f64::INFINITY, 0.0f64);
    for _ in 0..50 {
        let mut live = Live::new(model, rest, &samples[0], 1e-3).expect("a start");
        let begun = Instant::now();
        for (k, sample) in samples.iter().enumerate().skip(1) {
            let state = live.sample(sample).expect("a sample");
            for j in 0..3 {
                worst = worst.max((state.lumens[j] - exact.lumens(k)[j]).abs());
            }
        }
        best = best.min(begun.elapsed().as_secs_f64() / 1000.0);
    }
    eprintln!("live at 1 kHz: {:.2} us a sample, error {worst:.1e}", best * 1e6);
}

/// The state of no load, of the reference tables' first rows.
fn rest() -> State {
    State { lumens: vec![1.927_397_108_816_434_3, 1.927_397_108_816_434_3, 2.076_925_007_320_9], rates: vec![0.0; 3] }
}

fn cases() -> Vec<Case> {
    let tables = [
        include_str!("../../../crates/hemodynamics/tests/reference/proximal.csv"),
        include_str!("../../../crates/hemodynamics/tests/reference/both.csv"),
    ];
    let mut cases = Vec::new();
    for (kind, table) in tables.into_iter().enumerate() {
        let mut of: BTreeMap<u64, Vec<(f64, [f64; 3])>> = BTreeMap::new();
        for line in table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())) {
            let row: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
            of.entry(row[0] as u64).or_default().push((row[1], [row[2], row[3], row[4]]));
        }
        for (load_pa, reference) in of {
            let (proximal_pa, distal_pa) = (load_pa as f64, if kind == 1 { load_pa as f64 } else { 0.0 });
            let step = |height: f64| format!("step:{height}@0..2").parse().expect("a load");
            let loads = Loads::on(&Parameters::thesis(), step(proximal_pa), step(distal_pa));
            cases.push(Case { step: Step { proximal_pa, distal_pa }, loads, reference });
        }
    }
    assert_eq!(cases.len(), 20);
    cases
}
