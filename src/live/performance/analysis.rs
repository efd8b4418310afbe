//! From trials to figures.

use std::collections::BTreeMap;

use lunula_live::performance::{Course, Curve, LEVEL, Law, LevelAt, Paired, Point, filled_means};
use lunula_live::spread::{Spread, t_quantile};

use super::read::{Row, Trials};
use super::report::{
    Comparison, Fit, Fitted, Level, MethodFigures, PerformanceFigures, Statement, TrialMean, TrialPair,
};

/// The limit of both statements of the thesis.
const HALF: f64 = 0.5;
/// Curves whose AICc is no further apart fit alike (Burnham and Anderson 2002, section 2.6).
const ALIKE_AICC: f64 = 2.0;

/// The operators' times of one method: by trial, then by operator.
type Times = BTreeMap<u32, BTreeMap<usize, f64>>;

/// All figures; `baseline` is one of the methods.
pub(super) fn figures(data: &str, trials: &Trials, course: Course, baseline: usize) -> PerformanceFigures {
    let mut times = vec![Times::new(); trials.methods.len()];
    for &Row { operator, method, trial, decision_s, .. } in &trials.rows {
        times[method].entry(trial).or_default().insert(operator, decision_s);
    }
    let methods: Vec<MethodFigures> =
        trials.methods.iter().zip(&times).map(|(name, times)| method(name, times)).collect();
    let others = (0..methods.len()).filter(|&other| other != baseline);
    PerformanceFigures {
        data: data.to_owned(),
        shortest_s: course.shortest_s(),
        course,
        rows: trials.rows.len(),
        rows_without_time: trials.missing,
        operators: trials.operators.clone(),
        level: format!(
            "a method levels off at the first trial at which its better curve has less than {:.0} % of its rise from \
             trial 1 to the asymptote left",
            100.0 * LEVEL
        ),
        comparisons: others
            .map(|other| compare([&methods[baseline], &methods[other]], [&times[baseline], &times[other]]))
            .collect(),
        methods,
    }
}

fn method(name: &str, times: &Times) -> MethodFigures {
    let mean = |(&trial, of): (&u32, &BTreeMap<usize, f64>)| {
        Some(TrialMean { trial, over_operators: Spread::of(of.values().copied())? })
    };
    let trials: Vec<TrialMean> = times.iter().filter_map(mean).collect();
    let fitted = fit(&trials, &filled_means(times));
    let last = trials.last().map_or(0.0, |last| f64::from(last.trial));
    let level = fitted.better_curve().and_then(|curve| curve.level_at).map(|trial| {
        // What the search leaves does not make it the next trial.
        let first_trial = (trial.trial.value - 1e-6).ceil().max(1.0);
        Level { trial, first_trial, was_reached: first_trial <= last }
    });
    let operators = times.values().flat_map(BTreeMap::keys).collect::<std::collections::BTreeSet<_>>().len();
    MethodFigures { method: name.to_owned(), operators, trials, fitted, levels_off: level }
}

/// `means`: of each trial, as if every operator had done it.
fn fit(trials: &[TrialMean], means: &[f64]) -> Fitted {
    let point = |(of, &mean): (&TrialMean, &f64)| Point {
        trial: f64::from(of.trial),
        mean,
        weight: of.over_operators.n as f64,
    };
    let points: Vec<Point> = trials.iter().zip(means).map(point).collect();
    let [exponential, power] = [Law::Exponential, Law::Power].map(|law| match Curve::fit(law, &points) {
        Ok(curve) => Fit { curve: Some(curve), not_fitted: None },
        Err(why) => Fit { curve: None, not_fitted: Some(why.to_string()) },
    });
    let better = match (&exponential.curve, &power.curve) {
        // Both have three parameters: AICc and residuals name the same.
        (Some(one), Some(other)) if other.residual_sd < one.residual_sd => Some(Law::Power),
        (Some(_), _) => Some(Law::Exponential),
        (None, other) => other.map(|_| Law::Power),
    };
    let criterion = |fit: &Fit| fit.curve.and_then(|curve| curve.aicc);
    let aicc_difference = criterion(&power).zip(criterion(&exponential)).map(|(power, other)| power - other);
    Fitted { exponential, power, better, aicc_difference }
}

impl Fitted {
    /// The curve with the smaller AICc, or the only one.
    #[must_use]
    pub fn better_curve(&self) -> Option<Curve> {
        match self.better? {
            Law::Exponential => self.exponential.curve,
            Law::Power => self.power.curve,
        }
    }

    /// The trials at which the curves that fit are level; of one that is nowhere, none.
    fn levels(&self) -> Vec<Option<f64>> {
        let alike = self.aicc_difference.is_some_and(|difference| difference.abs() < ALIKE_AICC);
        let both = [(Law::Exponential, &self.exponential), (Law::Power, &self.power)];
        let fitting = both.into_iter().filter(|(law, _)| alike || Some(*law) == self.better);
        fitting.filter_map(|(_, fit)| fit.curve).map(|curve| Some(curve.level_at?.trial.value)).collect()
    }
}

/// `[baseline, method]`.
fn compare(methods: [&MethodFigures; 2], [baseline, other]: [&Times; 2]) -> Comparison {
    let both = baseline.iter().filter_map(|(trial, times)| Some((*trial, times, other.get(trial)?)));
    let mut trials = Vec::new();
    let mut sums: BTreeMap<usize, ([f64; 2], f64)> = BTreeMap::new();
    for (trial, baseline, other) in both {
        let pairs = baseline.iter().filter_map(|(operator, time)| Some((*operator, [*time, *other.get(operator)?])));
        let pairs: Vec<(usize, [f64; 2])> = pairs.collect();
        for (operator, [one, other]) in &pairs {
            let (sum, count) = sums.entry(*operator).or_default();
            *sum = [sum[0] + one, sum[1] + other];
            *count += 1.0;
        }
        let paired = Paired::of(&pairs.iter().map(|(_, pair)| *pair).collect::<Vec<_>>());
        trials.extend(paired.map(|paired| TrialPair { trial, paired }));
    }
    let means: Vec<[f64; 2]> = sums.values().map(|(sum, count)| sum.map(|sum| sum / count)).collect();
    Comparison {
        method: methods[1].method.clone(),
        baseline: methods[0].method.clone(),
        overall: Paired::of(&means),
        initially: initially(trials.first()),
        to_level_off: to_level_off(methods),
        trials,
    }
}

/// A statement of which nothing is known.
const NONE: Statement =
    Statement { ratio: None, ratio_se: None, ratio_interval: None, at_most: HALF, holds: None, unsettled: None };
/// Why a statement is not settled whose ratio may as well be on the other side of half.
const HOLDS_HALF: &str = "its 95 % interval holds half";

/// Whether the method takes less than half as long in the first trial with both.
fn initially(first: Option<&TrialPair>) -> Statement {
    let Some(Paired { n, ratio_of_means: Some(ratio), ratio_of_means_se, .. }) = first.map(|first| first.paired) else {
        return NONE;
    };
    let reach = ratio_of_means_se.zip(t_quantile(n - 1)).map(|(se, t)| t * se);
    // Times are positive.
    let ratio_interval = reach.map(|reach| [(ratio - reach).max(0.0), ratio + reach]);
    let unsettled = match ratio_interval {
        None => Some("one operator does not say how much operators differ"),
        Some(interval) => holds_half(interval).then_some(HOLDS_HALF),
    };
    let holds = unsettled.is_none().then_some(ratio < HALF);
    Statement { ratio: Some(ratio), ratio_se: ratio_of_means_se, ratio_interval, holds, unsettled, ..NONE }
}

fn holds_half([low, high]: [f64; 2]) -> bool {
    low <= HALF && HALF <= high
}

/// The 95 % interval of `to` over `from`, of which each has its own: of the logarithms' difference the distances to
/// either end are the roots of the squared sums (Zou and Donner 2008, doi:10.1002/sim.3095). None where an end is not
/// known.
fn ratio_interval(from: LevelAt, to: LevelAt) -> Option<[f64; 2]> {
    let below = |level: LevelAt| (level.trial.value / level.low).ln();
    let above = |level: LevelAt| Some((level.high? / level.trial.value).ln());
    let ratio = to.trial.value / from.trial.value;
    Some([ratio * (-below(to).hypot(above(from)?)).exp(), ratio * above(to)?.hypot(below(from)).exp()])
}

/// Of `[baseline, method]`, whether the method is level in half the trials.
fn to_level_off(methods: [&MethodFigures; 2]) -> Statement {
    let [Some(from), Some(to)] = methods.map(|method| method.levels_off) else { return NONE };
    let [one, other] = [from.trial.trial, to.trial.trial];
    let ratio = other.value / one.value;
    let ratio_se = ratio * (other.se / other.value).hypot(one.se / one.value);
    let ratio_interval = ratio_interval(from.trial, to.trial);
    let holds = ratio <= HALF;
    let [froms, tos] = methods.map(|method| method.fitted.levels());
    let alike =
        |from: &Option<f64>, to: &Option<f64>| from.zip(*to).is_some_and(|(from, to)| (to / from <= HALF) == holds);
    let unsettled = if !(from.was_reached && to.was_reached) {
        Some("a level was not reached")
    } else if ratio_interval.is_none_or(holds_half) {
        Some(HOLDS_HALF)
    } else if !froms.iter().all(|from| tos.iter().all(|to| alike(from, to))) {
        Some("the other law fits as well, and does not say the same")
    } else {
        None
    };
    Statement {
        ratio: Some(ratio),
        ratio_se: Some(ratio_se),
        ratio_interval,
        holds: unsettled.is_none().then_some(holds),
        unsettled,
        ..NONE
    }
}
