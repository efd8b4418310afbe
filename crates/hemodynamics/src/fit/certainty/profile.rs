//! How far a parameter may move before the data object: intervals by the profile of the sum of squares.
//!
//! In: a fitted point and the standard errors there. Out: for each coordinate the two places at which the sum of
//! squares, all other unknowns fitted again, has risen by four times the variance of the noise. Where the voltages
//! go straight with the parameters that is two standard errors to each side; where they don't, it covers the truth as
//! often all the same, and standard errors don't (Bates and Watts 1988, doi:10.1002/9780470316757, chapter 6).
//!
//! Offsets and scalings follow the coordinates, and by their derivatives at the best an offset that turns round there
//! does not follow at all. Their intervals are where they were at the walked points, and twice the error that is left
//! where the coordinate is held: as roots of summed squares two standard errors where all is straight. They are never
//! shorter than that, as a walk has few points, and may step over the place where an offset turns round.

use crate::fit::algebra::levenberg::{Point, Search};
use crate::fit::algebra::qr;
use crate::fit::certainty::Certainty;
use crate::fit::problem::{Evaluation, Problem};
use crate::fit::result::FitResult;
use crate::fit::{bounds, settings, squares};

/// The root of the rise over the variance at the ends.
const ERRORS: f64 = 2.0;
/// How closely it is met.
const CLOSE: f64 = 0.02;
const TRIES: usize = 12;
/// The others are fitted again to this part of their standard errors.
const TOLERANCE: f64 = 0.03;
/// The points of a try.
const POINTS: usize = 12;

/// Of the data's norm, residuals that are rounding and have no profile.
const ROUNDING: f64 = 1e-9;

/// Adds the intervals of the groups that have standard errors.
pub(in crate::fit) fn intervals(problem: &mut Problem, best: &Evaluation, certainty: &mut Certainty) {
    if squares(best).sqrt() <= ROUNDING * qr::norm(&problem.target) {
        return;
    }
    let [lower, upper] = bounds(problem);
    let settings = settings(problem, &lower, &upper);
    let profile = Profile { best, covariance: &certainty.covariance, sd: certainty.noise_sd_v, settings };
    for q in 0..certainty.result.groups.len() {
        if certainty.result.groups[q].standard_errors.is_some() {
            let mut walked = Walked::of(best);
            let ends = profile.ends(problem, q, &mut walked);
            certainty.result.groups[q].interval = ends.map(|end| end.map(|at| problem.coordinates[q].values(at)));
            walked.widen(&mut certainty.result, q);
        }
    }
}

/// The least and the largest offset and scaling of each photodiode at the points of a profile.
struct Walked(Vec<[[f64; 2]; 2]>);

impl Walked {
    fn of(point: &Evaluation) -> Self {
        Self(point.fitted.iter().map(|fitted| [[fitted.offset_v; 2], [fitted.scaling_v; 2]]).collect())
    }

    fn add(&mut self, point: &Evaluation) {
        for (ranges, fitted) in self.0.iter_mut().zip(&point.fitted) {
            for ([least, most], value) in ranges.iter_mut().zip([fitted.offset_v, fitted.scaling_v]) {
                (*least, *most) = (least.min(value), most.max(value));
            }
        }
    }

    /// Widens the photodiodes' intervals by what they were while coordinate `q` was walked.
    fn widen(&self, result: &mut FitResult, q: usize) {
        let coordinates = result.groups.len();
        for (k, (diode, ranges)) in result.photodiodes.iter_mut().zip(&self.0).enumerate() {
            for (part, estimate) in [&mut diode.offset, &mut diode.scaling].into_iter().enumerate() {
                let correlation = result.correlations[coordinates + 2 * k + part][q];
                let Some(error) = estimate.standard_error.filter(|_| !correlation.is_nan()) else { continue };
                let rest = ERRORS * error * (1.0 - correlation * correlation).sqrt();
                let [least, most] = ranges[part];
                let straight = ERRORS * error;
                let [low, high] = [(estimate.value - least).hypot(rest), (most - estimate.value).hypot(rest)]
                    .map(|reach| reach.max(straight));
                let [lowest, highest] = estimate.interval.map(|end| end.unwrap_or(estimate.value));
                estimate.interval = [Some(lowest.min(estimate.value - low)), Some(highest.max(estimate.value + high))];
            }
        }
    }
}

/// A fitted point and what is known about it.
struct Profile<'a> {
    best: &'a Evaluation,
    /// Of the coordinates; 0 for those at a bound.
    covariance: &'a [Vec<f64>],
    /// Of the noise.
    sd: f64,
    settings: Search<'a>,
}

impl Profile<'_> {
    /// The lower and the upper end of a coordinate that has a standard error; `None` where a bound, or parameters at
    /// which the model has no response, come first.
    fn ends(&self, problem: &mut Problem, q: usize, walked: &mut Walked) -> [Option<f64>; 2] {
        [-1.0, 1.0].map(|side| self.end(problem, q, side, walked))
    }

    fn end(&self, problem: &mut Problem, q: usize, side: f64, walked: &mut Walked) -> Option<f64> {
        let at = self.best.at()[q];
        let bound = if side > 0.0 { self.settings.upper[q] } else { self.settings.lower[q] };
        let room = (bound - at).abs();
        // Distances and the roots of the rise there: below the end, and beyond it or without a response.
        let (mut below, mut beyond): ([f64; 2], Option<[f64; 2]>) = ([0.0; 2], None);
        let mut far = ERRORS * self.covariance[q][q].sqrt();
        // How the others follow: at first as the covariance says.
        let mut follows: Vec<f64> = self.covariance.iter().map(|row| row[q] / self.covariance[q][q]).collect();
        for _ in 0..TRIES {
            far = far.min(room);
            let step = self.rise(problem, q, side * far, &mut follows);
            if let Some((_, point)) = step.as_ref().filter(|(rise, _)| *rise <= ERRORS + CLOSE) {
                walked.add(point);
            }
            match step.map(|(rise, _)| rise) {
                Some(rise) if (rise - ERRORS).abs() <= CLOSE => return Some(at + side * far),
                Some(rise) if rise < ERRORS => below = [far, rise],
                Some(rise) => beyond = Some([far, rise]),
                None => beyond = Some([far, f64::NAN]),
            }
            let [low, less] = below;
            if low >= room {
                return None;
            }
            far = match beyond {
                None => far * (ERRORS / less.max(1.0)),
                Some([high, more]) if more.is_nan() => 0.5 * (low + high),
                Some([high, more]) => low + (high - low) * ((ERRORS - less) / (more - less)).clamp(0.05, 0.95),
            };
        }
        None
    }

    /// The root of the rise over the variance where a coordinate is held so far from the best, and the point there; the
    /// others start as they followed before.
    fn rise(&self, problem: &mut Problem, q: usize, by: f64, follows: &mut [f64]) -> Option<(f64, Evaluation)> {
        let (mut lower, mut upper) = (self.settings.lower.to_vec(), self.settings.upper.to_vec());
        let best = self.best.at();
        let held = (best[q] + by).clamp(lower[q], upper[q]);
        (lower[q], upper[q]) = (held, held);
        let from: Vec<f64> = (0..best.len()).map(|p| (best[p] + follows[p] * by).clamp(lower[p], upper[p])).collect();
        let first = problem.evaluate(&from).ok()?;
        let search =
            Search { lower: &lower, upper: &upper, tolerance: TOLERANCE, most_points: POINTS, ..self.settings };
        let found = search.run(first, |at| problem.evaluate(at).ok());
        for ((follows, at), best) in follows.iter_mut().zip(found.point.at()).zip(best) {
            *follows = (at - best) / by;
        }
        let rise = (squares(&found.point) - squares(self.best)).max(0.0).sqrt() / self.sd;
        Some((rise, found.point))
    }
}
