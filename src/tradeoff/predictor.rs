//! The predictors over their models, sizes and solvers: error against the time of a fit and of a prediction.
//!
//! Models are fitted to one set of recordings and their error is that on another, of random movement (5.3.1, Fig. 110). Solvers are given
//! problems whose exact solution is known: small whole numbers, so that voltages and targets are exact and rounding is the only error.

use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

use lunula_predictor::{Dataset, Kind, LeastSquaresOptions, Predictor, Recipe, Solver, fit_linear, linear_f0, score};
use ndarray::Array2;

use super::{Row, median};
use crate::predictor::{Target, Wanted, read_data};

/// What is measured, and how often.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Recordings of forces to train on.
    pub train: Vec<PathBuf>,
    /// Recordings to tell the error on.
    pub test: Vec<PathBuf>,
    /// Runs of each setting; the median time counts.
    pub repeats: usize,
}

/// Models and their hidden nodes.
const KINDS: [Kind; 7] = [
    Kind::Linear,
    Kind::Quadratic,
    Kind::Network { hidden: 2 },
    Kind::Network { hidden: 4 },
    Kind::Network { hidden: 8 },
    Kind::Network { hidden: 16 },
    Kind::Network { hidden: 32 },
];
/// Networks are trained from so many starts.
const RESTARTS: [usize; 2] = [1, 10];
const FIT: &str = "RMSE on random movement, mean of the forces, N; fits";
const TELL: &str = "RMSE on random movement, mean of the forces, N; predictions of one row";
const SOLVER: &str = "two photodiodes 2^-k apart: relative error of the worst coefficient, fits of 12 000 rows";
/// Below this an error is that of the numbers themselves.
const FLOOR: f64 = 1e-17;
/// Each problem: two of its photodiodes differ by 2 to the minus this.
const CLOSE_BITS: [i32; 3] = [0, 10, 20];
/// Solvers: name, solver, refinement.
const SOLVERS: [(&str, Solver, usize); 3] = [
    ("orthogonal, refined", Solver::Orthogonal, 2),
    ("orthogonal", Solver::Orthogonal, 0),
    ("normal equations (11)", Solver::Normal, 0),
];
const ROWS: usize = 12_000;

/// Measures every setting; the words say which gave no solution, and why.
///
/// # Errors
/// Recordings that can't be read, with their file.
pub fn measure(settings: &Settings) -> anyhow::Result<(Vec<Row>, Vec<String>)> {
    let target = Target::parse("force").map_err(anyhow::Error::msg)?;
    let wanted = Wanted { targets: target.columns().to_vec(), ..Wanted::default() };
    let train = read_data(&settings.train, &wanted)?.data;
    let test = read_data(&settings.test, &wanted)?.data;
    let (mut rows, mut refused) = (Vec::new(), Vec::new());
    for kind in KINDS {
        let starts: &[usize] = if matches!(kind, Kind::Network { .. }) { &RESTARTS } else { &RESTARTS[..1] };
        for &restarts in starts {
            match model(kind, restarts, &train, &test, settings.repeats) {
                Ok(both) => rows.extend(both),
                Err(why) => refused.push(format!("{}: {why:#}", name(kind, restarts))),
            }
        }
    }
    for bits in CLOSE_BITS {
        let data = exact(bits);
        for (solver, how, refinements) in SOLVERS {
            let setting = format!("{solver}, 2^-{bits}");
            let options = LeastSquaresOptions { solver: how, refinements, ..LeastSquaresOptions::default() };
            match solve(&data, &options, settings.repeats) {
                Ok((error, run_s)) => rows.push(row(setting, SOLVER, error, run_s, ROWS as u64)),
                Err(why) => refused.push(format!("{setting}: {why:#}")),
            }
        }
    }
    Ok((rows, refused))
}

fn name(kind: Kind, restarts: usize) -> String {
    match kind {
        Kind::Linear => "linear".to_owned(),
        Kind::Quadratic => "quadratic".to_owned(),
        Kind::Network { hidden } if restarts == 1 => format!("network of {hidden}"),
        Kind::Network { hidden } => format!("network of {hidden}, {restarts} starts"),
    }
}

/// Fits and predicts: a row for the time of each.
fn model(kind: Kind, restarts: usize, train: &Dataset, test: &Dataset, repeats: usize) -> anyhow::Result<[Row; 2]> {
    let recipe = Recipe { restarts, ..Recipe::new(kind) };
    let mut fit_s = Vec::new();
    let mut fitted = None;
    for _ in 0..repeats {
        let start = Instant::now();
        // One thread, as the times of all jobs here are.
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
        fitted = Some(one.install(|| Predictor::fit(black_box(train), None, &recipe))?);
        fit_s.push(start.elapsed().as_secs_f64());
    }
    let Some(fitted) = fitted else { anyhow::bail!("no repeats") };
    let (seen, predicted) = fitted.predict(test)?;
    let scores = score(seen.y().view(), predicted.view(), seen.targets());
    let error = scores.targets.iter().map(|one| one.rmse).sum::<f64>() / scores.targets.len() as f64;
    let mut tell_s = Vec::new();
    let mut out = vec![0.0; seen.targets().len()];
    for _ in 0..repeats {
        let start = Instant::now();
        for x in seen.x().outer_iter() {
            if let Some(x) = x.as_slice() {
                fitted.predict_row(black_box(x), &mut out);
                black_box(&out);
            }
        }
        tell_s.push(start.elapsed().as_secs_f64() / seen.rows() as f64);
    }
    let setting = name(kind, restarts);
    let work = train.rows() as u64;
    Ok([row(setting.clone(), FIT, error, median(fit_s), work), row(setting, TELL, error, median(tell_s), 1)])
}

/// Voltages about 3 V in steps of 2^-20, two of them alike but for so little; forces are small whole multiples of them: all exact.
fn exact(close_bits: i32) -> Dataset {
    let step = f64::exp2(-20.0);
    let wave = |row: usize, k: usize| (((row * (2 * k + 3) * 2_654_435_761) >> 7) % (1 << 20)) as f64 * step;
    let x = Array2::from_shape_fn((ROWS, 8), |(row, k)| match k {
        7 => 3.0 + wave(row, 0) + f64::exp2(f64::from(-close_bits)) * wave(row, 7),
        _ => 3.0 + wave(row, k),
    });
    let y = Array2::from_shape_fn((ROWS, 3), |(row, target)| {
        (0..8).map(|k| coefficient(target, k) * x[[row, k]]).sum::<f64>() + 1.0
    });
    let inputs = (1..=8).map(|k| format!("P{k}")).collect();
    let targets = ["Fx_N", "Fy_N", "Fz_N"].map(str::to_owned).to_vec();
    Dataset::plain(inputs, targets, x, y, 0.04).expect("finite rows of one size")
}

fn coefficient(target: usize, k: usize) -> f64 {
    ((3 * target + 5 * k) % 7) as f64 - 3.5
}

/// The largest relative error, and the time.
fn solve(data: &Dataset, options: &LeastSquaresOptions, repeats: usize) -> anyhow::Result<(f64, f64)> {
    let mut seconds = Vec::new();
    let mut worst = f64::NAN;
    for _ in 0..repeats {
        let start = Instant::now();
        let (model, _) = fit_linear(black_box(data), options)?;
        seconds.push(start.elapsed().as_secs_f64());
        let of = |(target, k): (usize, usize), found: f64| (found / coefficient(target, k) - 1.0).abs();
        let offsets = linear_f0(&model).into_iter().map(|found| (found - 1.0).abs());
        worst = model.jacobian().indexed_iter().map(|(at, found)| of(at, *found)).chain(offsets).fold(FLOOR, f64::max);
    }
    Ok((worst, median(seconds)))
}

fn row(setting: String, unit: &str, error: f64, run_s: f64, work: u64) -> Row {
    Row { job: "predictor", setting, error, error_unit: unit.to_owned(), run_s, work }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refinement_keeps_the_digits_that_the_normal_equations_lose() {
        // Measured: orthogonal 2e-16, normal equations 2e-5 (2^-20 apart).
        let data = exact(20);
        let error = |(_, solver, refinements)| {
            let options = LeastSquaresOptions { solver, refinements, ..LeastSquaresOptions::default() };
            solve(&data, &options, 1).map_or(f64::INFINITY, |(error, _)| error)
        };
        assert!(error(SOLVERS[0]) <= 1e-12);
        assert!(error(SOLVERS[2]) >= 1e-9);
    }

    #[test]
    fn the_problems_are_exact() {
        let data = exact(20);
        for (row, y) in data.y().outer_iter().enumerate().step_by(501) {
            for (target, y) in y.iter().enumerate() {
                // In whole steps of 2^-41: nothing is rounded.
                let whole = |value: f64| (value * f64::exp2(41.0)) as i128;
                let sum: i128 =
                    (0..8).map(|k| (2.0 * coefficient(target, k)) as i128 * whole(data.x()[[row, k]])).sum();
                assert_eq!(sum + 2 * whole(1.0), 2 * whole(*y), "row {row}");
            }
        }
    }
}
