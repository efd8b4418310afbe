//! What a trajectory is like: how fast, how even, and whether the thesis' limits are kept.

use std::path::PathBuf;

use lunula_predictor::{ConeCoverage, RateLimits, circling_limit_hz, cone_coverage, rate_limit_per_s, rate_limits};
use serde::Serialize;

use super::TrajectoryOptions;
use super::motion::{ForceMotion, Path};
use crate::job::Report;

/// Equation 19 is judged where the force is at least this share of the largest pressing.
const FLOOR: f64 = 0.1;
/// More than this share of the time over the limit is worth a warning.
const MUCH: f64 = 0.02;
/// What presses less is at rest, newtons.
const REST_N: f64 = 1e-3;
/// Rates are measured between moments so far apart, seconds, or at so many moments.
const FINE_S: f64 = 1e-3;
const MOST_MOMENTS: f64 = 1e6;
/// Coverage is measured on at most so many rows.
const MOST_COVERED: f64 = 1e5;

/// What a run did.
pub type TrajectoryReport = Report<TrajectoryFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct TrajectoryFigures {
    /// The trajectory, with all that its kind leaves to defaults.
    pub trajectory: TrajectoryOptions,
    /// The table.
    pub table: PathBuf,
    /// Its rows.
    pub rows: u64,
    /// From its first row to its last, seconds.
    pub span_s: f64,
    /// Of forces.
    pub force: Option<ForceFigures>,
    /// Of postures.
    pub posture: Option<PostureFigures>,
}

/// Figures of a trajectory of forces.
#[derive(Debug, Clone, Serialize)]
pub struct ForceFigures {
    /// How fast forces change, on the table's time, measured a millisecond apart.
    pub rates: Option<RateLimits>,
    /// The relative rate that equation 19 allows, per second.
    pub limit_per_s: f64,
    /// It is judged where the force is at least this, newtons.
    pub floor_n: f64,
    /// Whether it is kept there but for a fiftieth of the time.
    pub keeps_limit: bool,
    /// How evenly the rows cover the cone of friction.
    pub coverage: ConeCoverage,
    /// Correlation of time and pressing: near 1, a drift of the sensor can't be distinguished from the pressing.
    pub time_pressing_correlation: Option<f64>,
    /// Equations 24 to 26.
    pub spiral: Option<SpiralFigures>,
}

/// Figures of a spiral.
#[derive(Debug, Clone, Serialize)]
pub struct SpiralFigures {
    /// Equation 24: f_c has to be less, hertz.
    pub circling_limit_hz: f64,
    /// Equation 25 as printed: half of the true maximum, newtons a second.
    pub radial_rate_printed_n_per_s: f64,
    /// The maximum of equations 21 and 22 as printed, as t goes to 0.
    pub radial_rate_true_n_per_s: f64,
    /// The maximum with the soft start.
    pub radial_rate_max_n_per_s: f64,
    /// Equation 26 as printed: T has to be longer, seconds.
    pub shortest_printed_s: f64,
    /// With the true maximum.
    pub shortest_true_s: f64,
    /// With the soft start.
    pub shortest_s: f64,
}

/// Figures of a trajectory of postures.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct PostureFigures {
    /// The smallest J2, degrees.
    pub lowest_deg: f64,
    /// The largest.
    pub highest_deg: f64,
    /// The fastest change, degrees a second.
    pub fastest_deg_per_s: f64,
    /// How far a sensor that lags by tau is behind at most, degrees.
    pub behind_deg: f64,
}

/// Moments of the whole trajectory, at least `step_s` apart and at most `most`.
fn moments(options: &TrajectoryOptions, step_s: f64, most: f64) -> impl Iterator<Item = f64> + use<> {
    let whole_s = options.whole_s();
    let steps = (whole_s / step_s * (1.0 + 1e-12)).floor().min(most);
    let step_s = step_s.max(whole_s / most);
    (0..=steps as u64).map(move |k| k as f64 * step_s)
}

impl ForceFigures {
    pub(super) fn new(options: &TrajectoryOptions, motion: &ForceMotion) -> Self {
        let floor_n = FLOOR * options.fz_max_n;
        let limit_per_s = rate_limit_per_s(options.error, options.tau_s);
        let fine = moments(options, FINE_S, MOST_MOMENTS).map(|time_s| (time_s, motion.at(time_s)));
        let rates = rate_limits(fine, floor_n, limit_per_s);
        let rows: Vec<(f64, [f64; 3])> =
            moments(options, options.every_s, MOST_COVERED).map(|time_s| (time_s, motion.at(time_s))).collect();
        let spiral = motion.spiral.map(|spiral| SpiralFigures {
            circling_limit_hz: circling_limit_hz(limit_per_s),
            radial_rate_printed_n_per_s: spiral.radial_rate_printed_n_per_s(),
            radial_rate_true_n_per_s: spiral.radial_rate_true_n_per_s(),
            radial_rate_max_n_per_s: spiral.radial_rate_max_n_per_s(),
            shortest_printed_s: spiral.shortest_printed_s(),
            shortest_true_s: spiral.shortest_true_s(),
            shortest_s: spiral.shortest_s(),
        });
        Self {
            keeps_limit: rates.is_some_and(|rates| rates.over_share.is_some_and(|share| share <= MUCH)),
            rates,
            limit_per_s,
            floor_n,
            coverage: cone_coverage(rows.iter().map(|row| row.1), &motion.space, REST_N.min(1e-3 * options.fz_max_n)),
            time_pressing_correlation: correlation(&rows),
            spiral,
        }
    }

    /// What a person has to know before playing it.
    pub(super) fn warnings(&self, options: &TrajectoryOptions) -> Vec<String> {
        let mut warnings = Vec::new();
        let judged = self.rates.as_ref().and_then(|rates| Some((rates.relative_per_s?, rates.over_share?)));
        if let Some((relative, share)) = judged.filter(|_| !self.keeps_limit) {
            warnings.push(format!(
                "forces change by up to {:.2} of themselves a second; equation 19 allows {:.2} for {:.0} % at {} s, \
                     which {:.0} % of the time is exceeded; choose longer --seconds or lower rates",
                relative,
                self.limit_per_s,
                100.0 * options.error,
                options.tau_s,
                100.0 * share
            ));
        }
        if options.soft_s == 0.0 && self.spiral.is_some() {
            warnings.push(
                "without a soft start the pressing begins infinitely fast (equation 21); no finger follows that"
                    .to_owned(),
            );
        }
        if let Some(spiral) = self.spiral.as_ref().filter(|spiral| options.seconds < spiral.shortest_printed_s) {
            warnings.push(format!(
                "{} s are less than the {:.0} s of equation 26: less than a circle for each newton of shear; choose \
                 longer --seconds, or a smaller --fs or --fz-max",
                options.seconds, spiral.shortest_printed_s
            ));
        }
        warnings
    }
}

impl PostureFigures {
    pub(super) fn new(options: &TrajectoryOptions, path: &Path) -> Self {
        let at = |time_s: f64| path.during(time_s, options.lead_s, options.seconds);
        let (mut lowest_deg, mut highest_deg, mut fastest) = (f64::INFINITY, f64::NEG_INFINITY, 0.0f64);
        let mut before: Option<(f64, f64)> = None;
        for time_s in moments(options, FINE_S, MOST_MOMENTS) {
            let angle = at(time_s);
            (lowest_deg, highest_deg) = (lowest_deg.min(angle), highest_deg.max(angle));
            if let Some((from_s, from)) = before.replace((time_s, angle)) {
                fastest = fastest.max(((angle - from) / (time_s - from_s)).abs());
            }
        }
        Self { lowest_deg, highest_deg, fastest_deg_per_s: fastest, behind_deg: fastest * options.tau_s }
    }
}

/// Correlation of the time and the pressing of rows that press.
fn correlation(rows: &[(f64, [f64; 3])]) -> Option<f64> {
    let pairs = || rows.iter().filter(|row| -row.1[2] > REST_N).map(|row| [row.0, -row.1[2]]);
    let count = pairs().count() as f64;
    let mean = |k: usize| pairs().map(|pair| pair[k]).sum::<f64>() / count;
    let means = [mean(0), mean(1)];
    let product = |i: usize, j: usize| pairs().map(|pair| (pair[i] - means[i]) * (pair[j] - means[j])).sum::<f64>();
    let found = product(0, 1) / (product(0, 0) * product(1, 1)).sqrt();
    found.is_finite().then_some(found)
}
