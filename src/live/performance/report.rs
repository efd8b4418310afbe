//! What trials say: means, curves, comparisons.

use lunula_live::performance::{Course, Curve, Law, LevelAt, Paired};
use lunula_live::spread::Spread;
use serde::Serialize;

use crate::job::Report;

/// What a run did.
pub type PerformanceReport = Report<PerformanceFigures>;

/// The figures of a table of trials; all times are seconds per decision unless a name says otherwise.
#[derive(Debug, Clone, Serialize)]
pub struct PerformanceFigures {
    /// The table of trials.
    pub data: String,
    /// What was driven.
    pub course: Course,
    /// The time of driving alone, seconds: path / speed.
    pub shortest_s: f64,
    /// Rows that are counted.
    pub rows: usize,
    /// Rows without a time.
    pub rows_without_time: usize,
    /// Operators, in the order in which they first appear.
    pub operators: Vec<String>,
    /// What "level" means here.
    pub level: String,
    /// Each method, in the order in which they first appear.
    pub methods: Vec<MethodFigures>,
    /// Each method but the baseline, against it.
    pub comparisons: Vec<Comparison>,
}

/// One method.
#[derive(Debug, Clone, Serialize)]
pub struct MethodFigures {
    /// Its name.
    pub method: String,
    /// Operators who did it.
    pub operators: usize,
    /// Each trial.
    pub trials: Vec<TrialMean>,
    /// Learning curves of the means, weighted with the number of operators.
    pub fitted: Fitted,
    /// Where the better curve is level; none where that is not known.
    pub levels_off: Option<Level>,
}

impl MethodFigures {
    /// Trials that an operator did not do and others did, of all operators.
    pub(super) fn not_done(&self) -> usize {
        self.trials.iter().map(|of| self.operators - of.over_operators.n).sum()
    }
}

/// The mean over operators of one trial.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct TrialMean {
    /// Which.
    pub trial: u32,
    /// Over operators, SD with n - 1.
    #[serde(flatten)]
    pub over_operators: Spread,
}

/// Both learning curves.
#[derive(Debug, Clone, Serialize)]
pub struct Fitted {
    /// a + b exp(-(n - 1) / c).
    pub exponential: Fit,
    /// a + b n^-c.
    pub power: Fit,
    /// The one with the smaller AICc, or the only one; none of none.
    pub better: Option<Law>,
    /// AICc of the power law less that of the exponential; none where one is missing or exact.
    pub aicc_difference: Option<f64>,
}

/// A learning curve, or why there is none.
#[derive(Debug, Clone, Serialize)]
pub struct Fit {
    /// The curve; a and b in seconds, c in trials (exponential) or an exponent.
    pub curve: Option<Curve>,
    /// Why there is none.
    pub not_fitted: Option<String>,
}

/// Where a curve is level.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Level {
    /// Not whole.
    pub trial: LevelAt,
    /// The first trial that is as level.
    pub first_trial: f64,
    /// Whether so many trials were done; else the curve is prolonged.
    pub was_reached: bool,
}

/// A method against the baseline.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// The method.
    pub method: String,
    /// What it is compared with.
    pub baseline: String,
    /// Each trial that operators did with both.
    pub trials: Vec<TrialPair>,
    /// Each operator's mean over the trials that he did with both.
    pub overall: Option<Paired>,
    /// "Less than half the time per decision initially": the ratio of means of the first trial with both.
    pub initially: Statement,
    /// "About half the number of trials at most to level off": the ratio of the trials at which the curves are level.
    pub to_level_off: Statement,
}

/// A trial by both methods.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct TrialPair {
    /// Which.
    pub trial: u32,
    /// Method less baseline, and method over baseline.
    #[serde(flatten)]
    pub paired: Paired,
}

/// A statement of the thesis as a figure.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Statement {
    /// A ratio, method over baseline; none where it is not known.
    pub ratio: Option<f64>,
    /// Its standard error; none where it is not known.
    pub ratio_se: Option<f64>,
    /// Its 95 % interval; none where it is not known, or has no end.
    pub ratio_interval: Option<[f64; 2]>,
    /// The statement holds up to this.
    pub at_most: f64,
    /// Whether it does; none where that is not known.
    pub holds: Option<bool>,
    /// Why that is not known although there is a ratio.
    pub unsettled: Option<&'static str>,
}
