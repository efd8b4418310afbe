//! How sure a fit is: standard errors, correlations, and what the data don't determine.
//!
//! From the singular values of the derivatives at the fitted point, offsets and scalings following. A combination of
//! coordinates is not determined where the voltages don't change along it to within the precision of the derivatives,
//! or where their noise leaves its logarithm uncertain by more than ln 10: the order of magnitude within which the
//! parameters are known beforehand.

pub(in crate::fit) mod beside;
pub(in crate::fit) mod delay;
pub(in crate::fit) mod noise;
pub(in crate::fit) mod profile;
use super::free::TENFOLD;
use super::problem::{Evaluation, Problem};
use super::result::{Bound, Calibrated, Combination, Estimate, FitResult, FitStatistics, Group};
use crate::fit::algebra::levenberg::{Minimum, Point};
use crate::fit::algebra::qr;
use crate::fit::algebra::svd::Svd;
use crate::parameters::Symbol;

/// Share of a direction that a parameter may have without being lost with it.
const SMALL: f64 = 1e-3;
/// Weights that are not worth a word.
const UNSPOKEN: f64 = 0.01;
/// Of the data's norm, derivatives that are rounding.
const ROUNDING: f64 = 1e-12;

pub(super) struct Certainty {
    /// What the fit gives, but for its rivals and how much was done.
    pub(super) result: FitResult,
    /// Of the noise of a whitened row.
    pub(super) noise_sd_v: f64,
    /// Of the coordinates; 0 for those at a bound.
    pub(super) covariance: Vec<Vec<f64>>,
}

/// A direction that is not determined: weights of all coordinates, and the SD along it.
struct Lost {
    direction: Vec<f64>,
    sd: Option<f64>,
}

pub(super) fn certainty(problem: &Problem, found: &Minimum<Evaluation>) -> Certainty {
    let (best, coordinates) = (&found.point, &problem.coordinates);
    let n = coordinates.len();
    let at_bound: Vec<Option<Bound>> = coordinates
        .iter()
        .zip(best.at())
        .map(|(coordinate, &at)| match at {
            at if at <= coordinate.lower => Some(Bound::Lower),
            at if at >= coordinate.upper => Some(Bound::Upper),
            _ => None,
        })
        .collect();
    let inside: Vec<usize> = (0..n).filter(|&q| at_bound[q].is_none()).collect();
    let mut columns: Vec<Vec<f64>> = inside.iter().map(|&q| best.columns()[q].clone()).collect();
    let triangle = qr::triangle(&mut columns, &mut best.residuals().to_vec());
    let m = inside.len();
    let svd = Svd::of((0..m).map(|j| (0..m).map(|i| triangle[i * m + j]).collect()).collect());
    let precision = (0.1 * problem.options.rtol).max(1e-10);
    let nothing = (precision * best.raw).max(ROUNDING * qr::norm(&problem.target));
    let rank = svd.values.iter().filter(|&&value| value > nothing).count();

    let rows = problem.target.len();
    let of_diodes: usize = best.fitted.iter().map(|fitted| if fitted.varied { 2 } else { 1 }).sum();
    let freedom = rows - rank - of_diodes;
    let ssr = qr::dot(&best.misses, &best.misses);
    let variance = problem.variance(best, freedom);

    // The covariance of the coordinates, and the directions that are lost.
    let mut covariance = vec![vec![0.0; n]; n];
    let mut lost = vec![];
    for (k, (value, vector)) in svd.values.iter().zip(&svd.vectors).enumerate() {
        let sd = (k < rank).then(|| variance.sqrt() / value);
        if let Some(sd) = sd {
            for (&p, a) in inside.iter().zip(vector) {
                for (&q, b) in inside.iter().zip(vector) {
                    covariance[p][q] += (a * sd) * (b * sd);
                }
            }
        }
        if sd.is_none_or(|sd| sd > TENFOLD) {
            let mut direction = vec![0.0; n];
            for (&q, a) in inside.iter().zip(vector) {
                direction[q] = *a;
            }
            lost.push(Lost { direction, sd });
        }
    }
    let null = |q: usize| lost.iter().any(|lost| lost.sd.is_none() && lost.direction[q].abs() > SMALL);
    let groups: Vec<Group> = (0..n)
        .map(|q| {
            let seen = qr::norm(&best.columns()[q]) > nothing;
            let sd = covariance[q][q].sqrt();
            let identifiable = match at_bound[q] {
                Some(_) => seen,
                None => !null(q) && sd <= TENFOLD,
            };
            let errors = || coordinates[q].speeds(best.at()[q]).iter().map(|speed| speed * sd).collect();
            Group {
                symbols: coordinates[q].symbols.clone(),
                start: coordinates[q].start.clone(),
                values: coordinates[q].values(best.at()[q]),
                standard_errors: (identifiable && at_bound[q].is_none()).then(errors),
                interval: [None, None],
                at_bound: at_bound[q],
                identifiable,
            }
        })
        .collect();

    let (photodiodes, full) = photodiodes(problem, best, &covariance, &lost, variance);
    let names = names(problem, !best.fitted.is_empty());
    let known: Vec<bool> = groups
        .iter()
        .map(|group| group.standard_errors.is_some())
        .chain(
            photodiodes
                .iter()
                .flat_map(|diode| [diode.offset.standard_error.is_some(), diode.scaling.standard_error.is_some()]),
        )
        .collect();
    let correlations = (0..full.len())
        .map(|i| {
            (0..full.len())
                .map(|j| match (known[i] && known[j], i == j) {
                    (false, _) => f64::NAN,
                    (true, true) => 1.0,
                    (true, false) => (full[i][j] / (full[i][i].sqrt() * full[j][j].sqrt())).clamp(-1.0, 1.0),
                })
                .collect()
        })
        .collect();
    let undetermined = combinations(&names, best, &lost);
    let result = FitResult {
        parameters: best.parameters.clone(),
        groups,
        photodiodes,
        names,
        correlations,
        residual_sd_v: (ssr / freedom as f64).sqrt(),
        r2: r2(problem, ssr),
        values: rows,
        freedom,
        noises: problem.noises(),
        singular_values_v: svd.values.iter().map(|value| value / (rows as f64).sqrt()).collect(),
        undetermined,
        beside: beside::beside(problem, best, &inside, variance.sqrt()),
        delays: delay::delays(problem, best, &inside, variance.sqrt()),
        rivals: vec![],
        stop: found.stop,
        statistics: FitStatistics::default(),
    };
    Certainty { result, noise_sd_v: variance.sqrt(), covariance }
}

/// Offsets and scalings with their errors, and the covariance of everything.
fn photodiodes(
    problem: &Problem,
    best: &Evaluation,
    covariance: &[Vec<f64>],
    lost: &[Lost],
    variance: f64,
) -> (Vec<Calibrated>, Vec<Vec<f64>>) {
    let n = covariance.len();
    // Each unknown by the coordinates.
    let mut by: Vec<Vec<f64>> = (0..n).map(|q| (0..n).map(|p| if p == q { 1.0 } else { 0.0 }).collect()).collect();
    for fitted in &best.fitted {
        for part in 0..2 {
            by.push(fitted.following.iter().map(|following| following[part]).collect());
        }
    }
    let image: Vec<Vec<f64>> =
        by.iter().map(|row| (0..n).map(|q| (0..n).map(|p| row[p] * covariance[p][q]).sum()).collect()).collect();
    let mut full: Vec<Vec<f64>> =
        image.iter().map(|a| by.iter().map(|b| a.iter().zip(b).map(|(a, b)| a * b).sum()).collect()).collect();
    let mut diodes = vec![];
    for (k, (fitted, diode)) in best.fitted.iter().zip(&problem.diodes).enumerate() {
        let [size, along, rest] = fitted.triangle;
        let (o, s) = (n + 2 * k, n + 2 * k + 1);
        full[o][o] += variance / (size * size);
        if fitted.varied {
            let slope = -along / size;
            let own = variance / (rest * rest);
            full[o][o] += own * slope * slope;
            full[o][s] += own * slope;
            full[s][o] += own * slope;
            full[s][s] += own;
        }
        let estimate = |value: f64, index: usize| {
            let moved = |lost: &Lost| -> f64 { by[index].iter().zip(&lost.direction).map(|(a, b)| a * b).sum() };
            let gone = |lost: &Lost| moved(lost).abs() * lost.sd.unwrap_or(1.0 / SMALL) > fitted.scaling_v.abs();
            let identifiable = fitted.varied && !lost.iter().any(gone);
            Estimate {
                value,
                standard_error: identifiable.then(|| full[index][index].sqrt()),
                interval: [None; 2],
                identifiable,
            }
        };
        let rows = diode.rows.clone();
        let squares: f64 =
            rows.clone().map(|row| best.misses[row] / problem.weights[row]).map(|volts| volts * volts).sum();
        diodes.push(Calibrated {
            unit: diode.unit,
            recordings: diode.recordings.clone(),
            offset: estimate(fitted.offset_v, o),
            scaling: estimate(fitted.scaling_v, s),
            residual_rms_v: (squares / rows.len() as f64).sqrt(),
        });
    }
    (diodes, full)
}

fn names(problem: &Problem, calibrated: bool) -> Vec<String> {
    let mut names: Vec<String> = problem.coordinates.iter().map(|coordinate| coordinate.name()).collect();
    for diode in problem.diodes.iter().filter(|_| calibrated) {
        let alone = problem.diodes.iter().filter(|other| other.unit == diode.unit).count() == 1;
        let numbers: Vec<String> = diode.recordings.iter().map(|k| (k + 1).to_string()).collect();
        let of = if alone { String::new() } else { format!(" of recording {}", numbers.join(", ")) };
        for symbol in [Symbol::Offset(diode.unit), Symbol::Scaling(diode.unit)] {
            names.push(format!("{symbol}{of}"));
        }
    }
    names
}

/// What is lost, in words.
fn combinations(names: &[String], best: &Evaluation, lost: &[Lost]) -> Vec<Combination> {
    let n = best.columns().len();
    let mut all = vec![];
    for (k, fitted) in best.fitted.iter().enumerate().filter(|(_, fitted)| !fitted.varied) {
        // V_0 + V_1 f stays the same.
        let [size, along, _] = fitted.triangle;
        let (signal, name) = (along / size, |part: usize| names[n + 2 * k + part].clone());
        let length = (1.0 + signal * signal).sqrt();
        all.push(Combination { weights: vec![(name(0), -signal / length), (name(1), 1.0 / length)], sd: None });
    }
    for lost in lost {
        let mut weights: Vec<(String, f64)> = names.iter().cloned().zip(lost.direction.iter().copied()).collect();
        for (k, fitted) in best.fitted.iter().enumerate() {
            for part in 0..2 {
                let moved: f64 = fitted.following.iter().zip(&lost.direction).map(|(f, a)| f[part] * a).sum();
                let over = if moved == 0.0 { 0.0 } else { moved / fitted.scaling_v.abs() };
                weights.push((names[n + 2 * k + part].clone(), over));
            }
        }
        weights.retain(|(_, weight)| weight.abs() >= UNSPOKEN);
        all.push(Combination { weights, sd: lost.sd });
    }
    all
}

fn r2(problem: &Problem, ssr: f64) -> Option<f64> {
    let mut total = 0.0;
    for diode in &problem.diodes {
        let (weights, target) = (&problem.weights[diode.rows.clone()], &problem.target[diode.rows.clone()]);
        let mean = qr::dot(weights, target) / qr::dot(weights, weights);
        total += weights.iter().zip(target).map(|(w, y)| y - w * mean).map(|part| part * part).sum::<f64>();
    }
    let rounding = ROUNDING * qr::norm(&problem.target);
    (total > rounding * rounding).then(|| 1.0 - ssr / total)
}
