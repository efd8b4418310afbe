//! Learning curves: exponential and power law, by least squares.
//!
//! In: the mean of each trial, with the number of operators that it is of. Out: a [`Curve`] with standard errors, or
//! why there is none. An asymptote a, a rise b and a pace c:
//!
//! - exponential: y(n) = a + b exp(-(n - 1) / c), c in trials;
//! - power law: y(n) = a + b n^-c (Newell and Rosenbloom 1981, "Mechanisms of skill acquisition and the law of
//!   practice").
//!
//! Squares are weighted with the number of operators. Given c, a and b are linear; c is found by a search over its
//! logarithm, which can't miss the least of several minima that lie on the grid. Standard errors are those of
//! linearized least squares, the variance from the residuals with three degrees of freedom less than trials: they say
//! how well these operators' mean curve is known, not how operators differ. Intervals are those of Student's t with
//! these degrees of freedom: of six trials 3.18 standard errors to either side. That of where a curve is level is the
//! pace's, transformed.

use serde::Serialize;

use crate::spread::t_quantile;

/// Fewer trials are not fitted: Akaike's corrected criterion of three parameters and a variance exists from six on.
pub const FEWEST_TRIALS: usize = 6;
/// What is left of the rise where a curve counts as level (assumed: the usual 95 % of settling).
pub const LEVEL: f64 = 0.05;
/// Paces on the grid of the search.
const PACES: usize = 240;
/// Steps of the search between two of them: each leaves 0.62 of the interval, the last 1e-9.
const STEPS: usize = 60;
/// Residuals of this share of the values are rounding.
const EXACT: f64 = 1e-13;

/// The mean of one trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Which trial, from 1 on.
    pub trial: f64,
    /// The mean over operators.
    pub mean: f64,
    /// The number of operators.
    pub weight: f64,
}

/// Which law a curve follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// a + b exp(-(n - 1) / c).
    Exponential,
    /// a + b n^-c.
    Power,
}

/// A number with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub se: f64,
}

/// A fitted curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Curve {
    /// The law.
    pub law: Law,
    /// The asymptote, in the values' unit.
    pub a: Measured,
    /// The rise: positive where values fall towards the asymptote.
    pub b: Measured,
    /// The pace: trials (exponential) or an exponent (power law).
    pub c: Measured,
    /// Standard deviation of the residuals of one operator's values about the curve, as the means show it.
    pub residual_sd: f64,
    /// Akaike's corrected criterion; none where the curve goes through all points.
    pub aicc: Option<f64>,
    /// Where 5 % of the rise from the first trial on are left. None where the 95 % interval of b holds zero: no change
    /// is seen that could level off.
    pub level_at: Option<LevelAt>,
}

/// Where a curve is level: a trial, not whole.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LevelAt {
    /// The trial and its linearized standard error.
    #[serde(flatten)]
    pub trial: Measured,
    /// Where the 95 % interval begins.
    pub low: f64,
    /// Where it ends; none where the pace may be so slow that the curve is level nowhere.
    pub high: Option<f64>,
}

/// Why there is no curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "the messages say it")]
pub enum NoCurve {
    #[error("there are fewer than {FEWEST_TRIALS} different trials")]
    TooFewTrials,
    #[error("the times do not change from trial to trial")]
    NoChange,
    #[error("the times have not begun to level off: the asymptote is not determined")]
    NotLevelling,
    #[error("all of the change is between two trials: the pace is not determined")]
    AtOnce,
}

impl Law {
    /// The law as it is written.
    #[must_use]
    pub fn formula(self) -> &'static str {
        match self {
            Self::Exponential => "a + b exp(-(n - 1) / c)",
            Self::Power => "a + b n^-c",
        }
    }

    /// The share of the rise that is left at trial `n`, 1 at the first.
    fn left(self, n: f64, c: f64) -> f64 {
        match self {
            Self::Exponential => (-(n - 1.0) / c).exp(),
            Self::Power => n.powf(-c),
        }
    }

    /// Its derivative by c.
    fn left_by_c(self, n: f64, c: f64) -> f64 {
        match self {
            Self::Exponential => (n - 1.0) / (c * c) * self.left(n, c),
            Self::Power => -n.ln() * self.left(n, c),
        }
    }

    /// Paces that so many trials can show: from a rise that is over after the first step to one that is all but a
    /// straight line (or, of the power law, a logarithm).
    fn paces(self, last: f64) -> [f64; 2] {
        match self {
            Self::Exponential => [0.15, 30.0 * last],
            Self::Power => [0.01, 10.0],
        }
    }

    /// Where [`LEVEL`] of the rise is left, and its derivative by c.
    fn level_at(self, c: f64) -> [f64; 2] {
        let logarithm = -LEVEL.ln();
        match self {
            Self::Exponential => [1.0 + c * logarithm, logarithm],
            Self::Power => {
                let at = (logarithm / c).exp();
                [at, -at * logarithm / (c * c)]
            }
        }
    }

    /// The trial at which a curve is level, its pace c known so well; `reach`: standard errors to either side.
    fn level(self, c: Measured, reach: f64) -> LevelAt {
        let [value, by_c] = self.level_at(c.value);
        let [least, most] = [c.value - reach * c.se, c.value + reach * c.se];
        let at = |c: f64| self.level_at(c)[0];
        let (low, high) = match self {
            Self::Exponential => (at(least.max(0.0)), Some(at(most))),
            Self::Power => (at(most), (least > 0.0).then(|| at(least))),
        };
        LevelAt { trial: Measured { value, se: by_c.abs() * c.se }, low, high }
    }
}

impl Curve {
    /// Fits a curve to the means of trials.
    pub fn fit(law: Law, points: &[Point]) -> Result<Self, NoCurve> {
        let m = points.len();
        if m < FEWEST_TRIALS {
            return Err(NoCurve::TooFewTrials);
        }
        let last = points.iter().map(|point| point.trial).fold(1.0, f64::max);
        let size = points.iter().map(|point| point.weight * point.mean.powi(2)).sum::<f64>();
        let flat = Line::of(points, |_| 0.0).squares;
        if flat <= EXACT * EXACT * size {
            return Err(NoCurve::NoChange);
        }
        let squares = |log_c: f64| Line::of(points, |n| law.left(n, log_c.exp())).squares;
        let [low, high] = law.paces(last).map(f64::ln);
        let pace = |k: usize| low + (high - low) * k as f64 / (PACES - 1) as f64;
        let best = (0..PACES).min_by(|&i, &j| squares(pace(i)).total_cmp(&squares(pace(j)))).unwrap_or(0);
        if best == 0 || best == PACES - 1 {
            let at_once = (best == 0) == (law == Law::Exponential);
            return Err(if at_once { NoCurve::AtOnce } else { NoCurve::NotLevelling });
        }
        let c = least(squares, pace(best - 1), pace(best + 1)).exp();
        let Line { a, b, squares } = Line::of(points, |n| law.left(n, c));
        let exact = squares <= EXACT * EXACT * size;
        let squares = if exact { 0.0 } else { squares };
        let variance = squares / (m - 3) as f64;
        let gradient = |n: f64| [1.0, law.left(n, c), b * law.left_by_c(n, c)];
        let [a_se, b_se, c_se] = standard_errors(points, gradient, variance).ok_or(NoCurve::NotLevelling)?;
        let reach = t_quantile(m - 3).ok_or(NoCurve::TooFewTrials)?;
        let c = Measured { value: c, se: c_se };
        Ok(Self {
            law,
            a: Measured { value: a, se: a_se },
            b: Measured { value: b, se: b_se },
            c,
            residual_sd: variance.sqrt(),
            aicc: (!exact).then(|| corrected_criterion(squares, m)),
            level_at: (b.abs() > reach * b_se).then(|| law.level(c, reach)),
        })
    }

    /// The curve's value at a trial.
    #[must_use]
    pub fn at(&self, trial: f64) -> f64 {
        self.a.value + self.b.value * self.law.left(trial, self.c.value)
    }
}

/// AICc of three parameters and a variance, up to a constant that all curves of the same points share.
fn corrected_criterion(squares: f64, points: usize) -> f64 {
    let (m, k) = (points as f64, 4.0);
    m * (squares / m).ln() + 2.0 * k + 2.0 * k * (k + 1.0) / (m - k - 1.0)
}

/// y = a + b x by weighted least squares, and the weighted squares that are left.
struct Line {
    a: f64,
    b: f64,
    squares: f64,
}

impl Line {
    fn of(points: &[Point], x: impl Fn(f64) -> f64) -> Self {
        let all = points.iter().map(|point| point.weight).sum::<f64>();
        let mean = |value: &dyn Fn(&Point) -> f64| points.iter().map(|p| p.weight * value(p)).sum::<f64>() / all;
        let (x_mean, y_mean) = (mean(&|point| x(point.trial)), mean(&|point| point.mean));
        let xx = mean(&|point| (x(point.trial) - x_mean).powi(2));
        let xy = mean(&|point| (x(point.trial) - x_mean) * (point.mean - y_mean));
        let b = if xx > 0.0 { xy / xx } else { 0.0 };
        let squares = all * mean(&|point| (point.mean - y_mean - b * (x(point.trial) - x_mean)).powi(2));
        Self { a: y_mean - b * x_mean, b, squares }
    }
}

/// The least of a function with one minimum between `low` and `high`: golden section.
fn least(of: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut left, mut right) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_left, mut at_right) = (of(left), of(right));
    for _ in 0..STEPS {
        if at_left <= at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - golden * (high - low);
            at_left = of(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + golden * (high - low);
            at_right = of(right);
        }
    }
    0.5 * (low + high)
}

/// Roots of the diagonal of the covariance: `variance` times the inverse of the weighted normal matrix; none where it
/// has none.
fn standard_errors(points: &[Point], gradient: impl Fn(f64) -> [f64; 3], variance: f64) -> Option<[f64; 3]> {
    let mut normal = [[0.0; 3]; 3];
    for point in points {
        let of = gradient(point.trial);
        for (row, &one) in normal.iter_mut().zip(&of) {
            row.iter_mut().zip(&of).for_each(|(cell, &other)| *cell += point.weight * one * other);
        }
    }
    let cofactor = |i: usize| {
        let [j, k] = [(i + 1) % 3, (i + 2) % 3];
        normal[j][j] * normal[k][k] - normal[j][k] * normal[k][j]
    };
    let determinant = (0..3).map(|k| normal[0][k] * minor(&normal, k)).sum::<f64>();
    let scale = (0..3).map(|k| normal[k][k]).product::<f64>();
    // Columns that are one to twelve digits determine nothing.
    let determined = determinant > 1e-12 * scale;
    determined.then(|| [0, 1, 2].map(|i| (variance * cofactor(i) / determinant).max(0.0).sqrt()))
}

/// The cofactor of the first row's cell `k`.
fn minor(of: &[[f64; 3]; 3], k: usize) -> f64 {
    let [i, j] = [(k + 1) % 3, (k + 2) % 3];
    of[1][i] * of[2][j] - of[1][j] * of[2][i]
}

#[cfg(test)]
mod tests;
