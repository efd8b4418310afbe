//! The predictors over their models, sizes and solvers: error against the time of a fit and of a prediction.
//!
//! Models are fitted to one set of recordings and their error is that on another, of random movement (5.3.1, Fig. 110).
//! Solvers are given problems whose exact solution is known: small whole numbers, so that voltages and targets are
//! exact and rounding is the only error.

pub mod switch;

use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

use lunula_predictor::{
    Dataset, Kind, LeastSquaresOptions, Predictor, Recipe, Solver, fit_linear, linear_f0, recording_hashes, score,
};
use ndarray::{Array2, ArrayView2};

use crate::predictor::{Target, Wanted, read_data};
use crate::tradeoff::measure::rows::{Measured, Row};
use crate::tradeoff::measure::timing::{Effort, Run, in_turns};

/// What is measured, and how often.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Recordings of forces to train on.
    pub train: Vec<PathBuf>,
    /// Recordings that the error is of.
    pub test: Vec<PathBuf>,
    /// How much.
    pub effort: Effort,
}

/// Which model, with which size: job and choice.
pub const MODEL: (&str, &str) = ("predictor", "model");
/// On how much it is trained.
pub(super) const ROWS: (&str, &str) = ("predictor", "rows");
/// How least squares are solved: job and choice.
pub const SOLVER: (&str, &str) = ("predictor", "solver");

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
/// Against the time of a fit.
pub const FIT: &str = "RMSE on other recordings, mean of the forces, N; fits";
/// Against the time of a prediction.
pub const PREDICT: &str = "RMSE on other recordings, mean of the forces, N; predictions of one row";
/// Of linear models of some of the rows.
pub(super) const ROWS_ERROR: &str = "RMSE on other recordings, mean of the forces, N; linear fits of some rows";
/// What the most ill-conditioned problem's error begins with.
pub(super) const SOLVER_DECIDES: &str = "two photodiodes 2^-20 apart";
/// One row in so many; of fewer than one in 256, the synthetic recordings have too few for a model.
const ONE_IN: [usize; 5] = [1, 4, 16, 64, 256];
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
/// Rows of a problem with an exact solution.
pub const PROBLEM_ROWS: usize = 12_000;

/// What `lunula train` fits.
pub(super) fn model_default() -> String {
    name(Kind::Linear, 1)
}

/// What `lunula train` fits to.
pub(super) fn rows_default() -> String {
    some(1)
}

/// What solves least squares.
pub(super) fn solver_default() -> String {
    let default = LeastSquaresOptions::default();
    let own = SOLVERS
        .into_iter()
        .find(|&(_, solver, refinements)| (solver, refinements) == (default.solver, default.refinements));
    own.map_or("none of those measured", |(name, ..)| name).to_owned()
}

fn some(one_in: usize) -> String {
    if one_in == 1 { "all rows".to_owned() } else { format!("1 row in {one_in}") }
}

/// What the error is of a problem of which two photodiodes differ by 2 to the minus this.
fn problem(close_bits: i32) -> String {
    format!("two photodiodes 2^-{close_bits} apart: relative error of the worst coefficient, fits of 12 000 rows")
}

/// Measures every setting.
///
/// # Errors
/// Recordings that can't be read, with their file; [`Interrupted`](crate::job::Interrupted).
pub fn measure(settings: &Settings) -> anyhow::Result<Measured> {
    let ([train, test], warnings) = data(settings)?;
    let effort = &settings.effort;
    // One thread, as the times of all jobs here are.
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut measured = Measured { refused: warnings, ..Measured::default() };
    let models = models(effort.quick);
    let fits = in_turns(&models, effort, |&(kind, restarts), _| one.install(|| fit(kind, restarts, &train)))?;
    let predicted =
        in_turns(&models.iter().copied().zip(&fits).collect::<Vec<_>>(), effort, |(_, fitted), _| match fitted {
            Ok((_, fitted)) => predict(fitted, &test),
            Err(why) => anyhow::bail!("{why:#}"),
        })?;
    for ((&(kind, restarts), fitted), errors) in models.iter().zip(&fits).zip(predicted) {
        let setting = name(kind, restarts);
        match (fitted, &errors) {
            (Ok((fit_time, _)), Ok((predict_time, error))) => {
                measured.rows.push(Row::own(MODEL, &setting, (*error, FIT), *fit_time, train.rows() as u64));
                measured.rows.push(Row::own(MODEL, &setting, (*error, PREDICT), *predict_time, 1));
            }
            (Err(why), _) | (_, Err(why)) => measured.refused.push(format!("{setting}: {why:#}")),
        }
    }
    fewer(&train, &test, &one, effort, &mut measured)?;
    for (unit, data) in &problems() {
        let found = in_turns(&SOLVERS, effort, |&(_, solver, refinements), _| {
            one.install(|| solve(data, &LeastSquaresOptions { solver, refinements, ..LeastSquaresOptions::default() }))
        })?;
        for ((name, ..), found) in SOLVERS.into_iter().zip(found) {
            match found {
                Ok((time, error)) => {
                    measured.rows.push(Row::own(SOLVER, name, (error, unit), time, PROBLEM_ROWS as u64));
                }
                Err(why) => measured.refused.push(format!("{name}, {unit}: {why:#}")),
            }
        }
    }
    Ok(measured)
}

/// The recordings to train on, and those that errors are of; and what is doubtful about them.
///
/// # Errors
/// Recordings that can't be read, with their file.
pub fn data(settings: &Settings) -> anyhow::Result<([Dataset; 2], Vec<String>)> {
    let target = Target::parse("force").map_err(anyhow::Error::msg)?;
    let wanted = Wanted { targets: target.columns().to_vec(), ..Wanted::default() };
    let [train, test] = [read_data(&settings.train, &wanted)?, read_data(&settings.test, &wanted)?];
    let trained = recording_hashes(&train.data);
    let recordings = test.data.recordings().iter().zip(recording_hashes(&test.data));
    let again = recordings.filter(|(_, hash)| trained.contains(hash)).map(|(one, _)| {
        format!("{} is trained on as well: its error is that of the fit, which flatters; give another", one.name)
    });
    let warnings = again.chain(train.warnings).chain(test.warnings).collect();
    Ok(([train.data, test.data], warnings))
}

/// The problems with an exact solution, each with the name of its error.
#[must_use]
pub fn problems() -> [(String, Dataset); 3] {
    CLOSE_BITS.map(|bits| (problem(bits), exact(bits)))
}

/// Models with their starts; in a hurry without the largest.
fn models(quick: bool) -> Vec<(Kind, usize)> {
    let starts = |kind| if matches!(kind, Kind::Network { .. }) { &RESTARTS[..] } else { &RESTARTS[..1] };
    let all = KINDS.into_iter().flat_map(|kind| starts(kind).iter().map(move |&restarts| (kind, restarts)));
    let small = |&(kind, restarts): &(Kind, usize)| !matches!(kind, Kind::Network { hidden } if hidden * restarts > 80);
    all.filter(|model| !quick || small(model)).collect()
}

/// Linear models of fewer and fewer rows.
fn fewer(
    train: &Dataset,
    test: &Dataset,
    one: &rayon::ThreadPool,
    effort: &Effort,
    measured: &mut Measured,
) -> anyhow::Result<()> {
    let parts = ONE_IN.map(|n| train.only_rows(&(0..train.rows()).step_by(n).collect::<Vec<_>>()));
    let found = in_turns(&parts, effort, |part, _| {
        let (seconds, fitted) = one.install(|| fit(Kind::Linear, 1, part))?;
        let fitted = fitted.ok_or_else(|| anyhow::anyhow!("no model"))?;
        Ok((seconds, Some((error(&fitted, test)?, part.rows() as u64))))
    })?;
    for (n, found) in ONE_IN.into_iter().zip(found) {
        measured.add(ROWS, &some(n), ROWS_ERROR, found);
    }
    Ok(())
}

fn name(kind: Kind, restarts: usize) -> String {
    match kind {
        Kind::Network { .. } if restarts != 1 => format!("{kind}, {restarts} starts"),
        _ => kind.to_string(),
    }
}

fn fit(kind: Kind, restarts: usize, train: &Dataset) -> Run<Predictor> {
    let recipe = Recipe { restarts, ..Recipe::new(kind) };
    let start = Instant::now();
    let fitted = Predictor::fit(black_box(train), None, &recipe)?;
    Ok((start.elapsed().as_secs_f64(), Some(fitted)))
}

/// On recordings that the model has not seen.
fn error(fitted: &Predictor, test: &Dataset) -> anyhow::Result<f64> {
    let (seen, predicted) = fitted.predict(test)?;
    Ok(mean_rmse(&seen, predicted.view()))
}

/// How wrong predictions are ([`FIT`], [`PREDICT`]): the mean of the targets.
#[must_use]
pub fn mean_rmse(test: &Dataset, predicted: ArrayView2<'_, f64>) -> f64 {
    let scores = score(test.y().view(), predicted, test.targets());
    scores.targets.iter().map(|one| one.rmse).sum::<f64>() / scores.targets.len() as f64
}

/// Row by row: seconds each, and the error.
fn predict(fitted: &Predictor, test: &Dataset) -> Run<f64> {
    let (seen, predicted) = fitted.predict(test)?;
    let mut out = vec![0.0; seen.targets().len()];
    let start = Instant::now();
    for x in seen.x().outer_iter() {
        if let Some(x) = x.as_slice() {
            fitted.predict_row(black_box(x), &mut out);
            black_box(&out);
        }
    }
    let seconds = start.elapsed().as_secs_f64() / seen.rows() as f64;
    Ok((seconds, Some(mean_rmse(&seen, predicted.view()))))
}

/// Voltages about 3 V in steps of 2^-20, two of them alike but for so little; forces are small whole multiples of them:
/// all exact.
fn exact(close_bits: i32) -> Dataset {
    let step = f64::exp2(-20.0);
    let wave = |row: usize, k: usize| (((row * (2 * k + 3) * 2_654_435_761) >> 7) % (1 << 20)) as f64 * step;
    let x = Array2::from_shape_fn((PROBLEM_ROWS, 8), |(row, k)| match k {
        7 => 3.0 + wave(row, 0) + f64::exp2(f64::from(-close_bits)) * wave(row, 7),
        _ => 3.0 + wave(row, k),
    });
    let y = Array2::from_shape_fn((PROBLEM_ROWS, 3), |(row, target)| {
        (0..8).map(|k| coefficient(target, k) * x[[row, k]]).sum::<f64>() + 1.0
    });
    let inputs = (1..=8).map(|k| format!("P{k}")).collect();
    let targets = ["Fx_N", "Fy_N", "Fz_N"].map(str::to_owned).to_vec();
    Dataset::plain(inputs, targets, x, y, 0.04).expect("finite rows of one size")
}

fn coefficient(target: usize, k: usize) -> f64 {
    ((3 * target + 5 * k) % 7) as f64 - 3.5
}

/// The time, and the largest relative error.
fn solve(data: &Dataset, options: &LeastSquaresOptions) -> Run<f64> {
    let start = Instant::now();
    let (model, _) = fit_linear(black_box(data), options)?;
    let seconds = start.elapsed().as_secs_f64();
    Ok((seconds, Some(worst(model.jacobian().view(), &linear_f0(&model).to_vec()))))
}

/// How wrong a problem's solution is: the largest relative error of its coefficients, targets x photodiodes, and
/// offsets.
#[must_use]
pub fn worst(coefficients: ArrayView2<'_, f64>, offsets: &[f64]) -> f64 {
    let of = |((target, k), found): ((usize, usize), &f64)| (found / coefficient(target, k) - 1.0).abs();
    let offsets = offsets.iter().map(|found| (found - 1.0).abs());
    // What is not a number is worst of all.
    let larger = |most: f64, miss: f64| if miss > most || miss.is_nan() { miss } else { most };
    coefficients.indexed_iter().map(of).chain(offsets).fold(FLOOR, larger)
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
            solve(&data, &options).unwrap().1.unwrap()
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
