//! What a fit gives.

use crate::fit::algebra::levenberg::Stop;
use crate::fit::certainty::beside::Beside;
use crate::fit::certainty::delay::Delay;
use crate::fit::noise::Slow;
use crate::parameters::{Parameters, Symbol};

/// What a fit gives.
///
/// Standard errors are those of the linearized model at the fitted point, in the noise of the residuals; a parameter at
/// its bound is held there for those of the others. What the data don't determine has none: see
/// [`FitResult::undetermined`]. Where one recording leaves a parameter uncertain by more than about a tenth, the
/// voltages bend within that: two standard errors to each side hold the truth of a proximal step less often (k in 183
/// of 200 cases) than they should (191), [`Group::interval`] as often (195; `tests/fit/coverage.rs`).
#[derive(Clone, Debug, PartialEq)]
pub struct FitResult {
    /// The fitted parameters; those that were not free are those of the start. Offset and scaling of a unit are the
    /// fitted ones where its photodiode has one calibration, otherwise they are those of the start and
    /// [`FitResult::photodiodes`] has the fitted ones.
    pub parameters: Parameters,
    /// The free groups, in the order given.
    pub groups: Vec<Group>,
    /// Offsets and scalings; none where calibration is fixed.
    pub photodiodes: Vec<Calibrated>,
    /// What the rows and columns of [`FitResult::correlations`] are: the groups, and then offset and scaling of each
    /// photodiode.
    pub names: Vec<String>,
    /// Correlations of the estimates; NaN where one has no standard error.
    pub correlations: Vec<Vec<f64>>,
    /// SD of the residuals, V, with the degrees of freedom; where photodiodes differ in noise, that of the quietest.
    pub residual_sd_v: f64,
    /// Share of the variance about each photodiode's mean that is explained; `None` where there is no variance.
    pub r2: Option<f64>,
    /// Voltages that were fitted.
    pub values: usize,
    /// Voltages less unknowns that the data determine.
    pub freedom: usize,
    /// The noise beside the white one that was found in each photodiode of each recording, in their order; `None` where
    /// it was not looked for, and taken as white: in equilibrium, where values are few, where the fit is exact.
    pub noises: Vec<Vec<Option<Slow>>>,
    /// Singular values of the derivatives of all voltages by the groups that are at no bound, offsets and scalings
    /// following (whitened where there is slow noise): RMS change of a voltage, V, for a change by a factor e (or by
    /// the scale of what moves by addition), falling.
    pub singular_values_v: Vec<f64>,
    /// Combinations of parameters that the data don't determine.
    pub undetermined: Vec<Combination>,
    /// Of each recording by how much its photodiodes come after their loads; `None` in equilibrium, or where nothing
    /// shows it.
    pub delays: Vec<Option<Delay>>,
    /// What the voltages may hold beside the model; `None` where nothing is free, or nothing shows it.
    pub beside: Option<Beside>,
    /// Other minima, found from other starts, that these data don't separate from the best one, the nearest first.
    /// Standard errors know nothing of them.
    pub rivals: Vec<Rival>,
    /// Why the fit stopped.
    pub stop: Stop,
    /// How much was done.
    pub statistics: FitStatistics,
}

/// A free group after the fit.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Group {
    /// The parameters.
    #[serde(rename = "names")]
    pub symbols: Vec<Symbol>,
    /// What they were at the start, each in its unit.
    pub start: Vec<f64>,
    /// Their fitted values, each in its unit.
    pub values: Vec<f64>,
    /// Their standard errors, each in its unit; `None` where the data don't determine them, or at a bound.
    pub standard_errors: Option<Vec<f64>>,
    /// Where the sum of squares, all else fitted again, has risen by four times the variance of the noise: values
    /// below and above. Two standard errors to each side where the voltages go straight with the parameters, and as
    /// sure where they don't. An end is `None` where a bound, or parameters at which a vessel closes, come first; both
    /// are where there is no standard error, where the fit is exact, and where
    /// [`FitOptions::intervals`](super::FitOptions::intervals) asks for none.
    pub interval: [Option<Vec<f64>>; 2],
    /// The bound on which the fit ended.
    pub at_bound: Option<Bound>,
    /// Whether the data determine it.
    pub identifiable: bool,
}

/// A bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Bound {
    /// The lower one.
    Lower,
    /// The upper one.
    Upper,
}

impl Bound {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Bound::Lower => "lower",
            Bound::Upper => "upper",
        }
    }
}

/// A photodiode after the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// The unit below it, from 0.
    pub unit: usize,
    /// The recordings that share this calibration, from 0.
    pub recordings: Vec<usize>,
    /// Offset `V_0`, V.
    pub offset: Estimate,
    /// Scaling `V_1`, V.
    pub scaling: Estimate,
    /// RMS of its residuals, V.
    pub residual_rms_v: f64,
}

/// An estimate with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard error; `None` where the data don't determine it.
    pub standard_error: Option<f64>,
    /// Ends of two standard errors: how far it goes while the parameters go to the ends of their intervals, and its own
    /// error there. Both are `None` where there is no standard error, and where no parameter has an interval.
    pub interval: [Option<f64>; 2],
    /// Whether the data determine it.
    pub identifiable: bool,
}

impl Estimate {
    /// How much farther its interval reaches than two standard errors, to the side on which that is more.
    #[must_use]
    pub fn beyond_linear(&self) -> Option<f64> {
        let ([Some(low), Some(high)], Some(error)) = (self.interval, self.standard_error) else { return None };
        Some((self.value - low).max(high - self.value) / (2.0 * error))
    }
}

/// Parameters that can change together with (next to) no change of the voltages.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Combination {
    /// Names and weights: changes of logarithms; of an offset or scaling, over the scaling; of what else moves by
    /// addition, over its scale.
    pub weights: Vec<(String, f64)>,
    /// SD of the change along it; `None` where the voltages don't change at all.
    pub sd: Option<f64>,
}

/// Another minimum.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Rival {
    /// The values of each group's parameters there.
    pub values: Vec<Vec<f64>>,
    /// By how much the sum of squares is larger, over the variance of the noise: less than 9 (three standard
    /// errors).
    pub rise: f64,
}

/// How much was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct FitStatistics {
    /// Starts begun.
    pub starts: u64,
    /// Starts at which the model has no response.
    pub starts_refused: u64,
    /// Steps of the fit that was best.
    pub iterations: u64,
    /// Points in the space of parameters that were tried.
    pub points: u64,
    /// Those at which the model has no response: a vessel closes.
    pub refused: u64,
    /// Transients that were simulated.
    pub simulations: u64,
    /// Steps of their solver.
    pub steps: u64,
}
