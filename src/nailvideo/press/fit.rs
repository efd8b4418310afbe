//! The course of one trace after one press or release: a first-order lag (4.3) after a step; or after a ramp, as no
//! finger presses or lets go at once; or stretched, exp(-(t/tau)^beta).
//!
//! The step is taken unless the data say otherwise, the ramp in little noise. A coarse search over onset and tau finds
//! the minimum that Levenberg-Marquardt steps then refine. A ramp shorter than a frame has its length held.
//!
//! The intervals are those of the profile likelihood over shapes: what any of the courses says that are about as likely
//! as the best, also ramps of lengths that are not the best. That a step is taken says nothing against a ramp of 0.2 s
//! (measured on traces: the step's own interval held its onset in 61 to 76 %). They hold the noise with its correlation
//! in time, and the choice of the end level.

use nalgebra::{DMatrix, DVector};

/// Time constants that are looked for, seconds (the thesis' are 0.12 to 0.36).
const TAUS_S: std::ops::RangeInclusive<f64> = 0.02..=10.0;
/// Ramps and exponents that are looked for: seconds, and powers.
const RAMPS_S: std::ops::RangeInclusive<f64> = 0.004..=1.5;
const LEAST_RAMP_S: f64 = 0.01;
const POWERS: std::ops::RangeInclusive<f64> = 0.4..=2.5;
/// Another model than the step is taken where it lowers the sum of squares by more than so many residual variances (F
/// of one degree of freedom at 5 %).
const BETTER: f64 = 4.0;
/// A step of so many SDs of the residuals shows how long its ramp was (measured on the phantom: releases of 40 to 180
/// SDs are seen 38 ms late by a step, 27 ms by a ramp; at 25 SDs the ramp's length is not determined).
const CLEAR_SDS: f64 = 40.0;
/// Ramps that a course is compared with, seconds.
const LENGTHS_S: [f64; 6] = [0.02, 0.05, 0.1, 0.2, 0.35, 0.6];
/// The half width of a 95 % interval in standard errors.
const SES: f64 = 1.96;

/// A number with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval {
    pub(super) value: f64,
    pub(super) low: f64,
    pub(super) high: f64,
}

/// What the fit says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Course {
    pub(super) onset_s: Interval,
    pub(super) t50_s: Interval,
    pub(super) t90_s: Interval,
    pub(super) tau_s: Interval,
    /// The step, in the trace's unit.
    pub(super) depth: f64,
    /// SD of the residuals.
    pub(super) sd: f64,
    /// Share of the step that the window's end has seen.
    pub(super) seen: f64,
    pub(super) model: Model,
}

/// What the course is like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Model {
    Step,
    Ramp,
    Stretched,
}

impl Model {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Step => "exponential",
            Self::Ramp => "exponential after a ramp",
            Self::Stretched => "stretched exponential",
        }
    }
}

/// Parameters: onset, ln tau, ln of the ramp's length or of the power, level before, level after.
type Parameters = [f64; 5];

/// A course with its parameters as they are used: a fit evaluates it thousands of times.
struct Curve {
    model: Model,
    onset_s: f64,
    tau_s: f64,
    /// The ramp's length or the power.
    third: f64,
    before: f64,
    step: f64,
}

impl Curve {
    fn new(model: Model, p: &Parameters) -> Self {
        Self { model, onset_s: p[0], tau_s: p[1].exp(), third: p[2].exp(), before: p[3], step: p[4] - p[3] }
    }

    /// The share of the step that is reached some time after the onset.
    fn reached(&self, since_s: f64) -> f64 {
        if since_s <= 0.0 {
            return 0.0;
        }
        let Self { tau_s, third, .. } = *self;
        let left = |s: f64| (-s / tau_s).exp();
        match self.model {
            Model::Step => 1.0 - left(since_s),
            Model::Ramp if since_s < third => (since_s - tau_s * (1.0 - left(since_s))) / third,
            Model::Ramp => 1.0 - tau_s / third * (left(since_s - third) - left(since_s)),
            Model::Stretched => 1.0 - (-(since_s / tau_s).powf(third)).exp(),
        }
    }

    fn at(&self, t: f64) -> f64 {
        self.before + self.step * self.reached(t - self.onset_s)
    }
}

/// Time from the onset to a share of the step, by halving: it only grows.
fn to_share(model: Model, p: &Parameters, share: f64) -> f64 {
    let curve = Curve::new(model, p);
    let (mut low, mut high) = (0.0, 1e3);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if curve.reached(middle) < share { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

/// Fits times and values (all known, times ascending) about a step near `near_s`; `rest` is another possible end level.
pub(super) fn fit(time_s: &[f64], values: &[f64], near_s: f64, rest: Option<f64>) -> Option<Course> {
    let start = search(time_s, values, near_s)?;
    let plain = refine(Model::Step, time_s, values, start, &[0, 1, 3, 4])?;
    let n = values.len() as f64;
    let with = |model: Model, third: f64, earlier_s: f64| {
        let mut start = plain.parameters;
        (start[0], start[2]) = (start[0] - earlier_s, third.ln());
        refine(model, time_s, values, start, &[0, 1, 2, 3, 4])
    };
    let mut fits = vec![with(Model::Ramp, 0.1, 0.05), with(Model::Stretched, 1.0, 0.0)];
    fits.push(Some(plain));
    let mut fits: Vec<Fitted> = fits.into_iter().flatten().collect();
    // A ramp of no length is a step, and nothing determines its length.
    fits.retain(|one| one.model != Model::Ramp || one.parameters[2].exp() > LEAST_RAMP_S);
    fits.sort_by(|a, b| a.sum.total_cmp(&b.sum));
    // Residuals that go together count less: the effective number of samples.
    let sd = |one: &Fitted| (one.sum / (n - 5.0).max(1.0)).sqrt();
    let variance = |one: &Fitted| sd(one).powi(2) * correlation_factor(&one.residuals);
    let behind = |one: &Fitted, best: &Fitted| (one.sum - best.sum) / variance(best);
    // In little noise a ramp's length is determined, and its onset is earlier than the step's by half of it.
    let is_clear = |one: &Fitted| (one.parameters[4] - one.parameters[3]).abs() > CLEAR_SDS * sd(one);
    let simplest = if fits.first().is_some_and(is_clear) { Model::Ramp } else { Model::Step };
    let good_enough = fits.iter().position(|one| one.model == simplest && behind(one, &fits[0]) <= BETTER);
    let mut taken = fits.remove(good_enough.unwrap_or(0));
    let model = taken.model;
    let span_s = time_s[time_s.len() - 1] - time_s[0];
    let frame_s = span_s / (n - 1.0).max(1.0);
    let held = |model: Model, mut start: Parameters, third: f64| {
        start[2] = third.ln();
        refine(model, time_s, values, start, &[0, 1, 3, 4])
    };
    let (p, length_s) = (taken.parameters, taken.parameters[2].exp());
    // What else the course may be, of a shape that is held: the data need not tell what length or power is the best.
    let mut others: Vec<Fitted> =
        fits.iter().filter_map(|one| held(one.model, one.parameters, one.parameters[2].exp())).collect();
    if model == Model::Ramp && length_s < frame_s {
        // Frames do not show how long it was.
        taken = held(model, p, length_s)?;
        others.extend([*RAMPS_S.start(), frame_s].into_iter().filter_map(|length_s| held(model, p, length_s)));
    }
    let mut start = p;
    for length_s in LENGTHS_S {
        let one = held(Model::Ramp, start, length_s);
        let Some(one) = one.filter(|one| behind(one, &taken) <= SES * SES) else { break };
        start = one.parameters;
        others.push(one);
    }
    let best = others.iter().fold(&taken, |best, one| if one.sum < best.sum { one } else { best });
    let (least, variance) = (best.sum, variance(best));
    let at_rest = rest.and_then(|level| {
        let mut start = taken.parameters;
        start[4] = level;
        let free: Vec<usize> = taken.free.iter().copied().filter(|&k| k != 4).collect();
        refine(model, time_s, values, start, &free)
    });
    // An end level that the data refuse is not a choice.
    let at_rest = at_rest.filter(|one| one.sum <= 1.5 * taken.sum);
    let p = &taken.parameters;
    let interval = |of: &dyn Fn(Model, &Parameters) -> f64| {
        let value = of(model, p);
        let shift = |one: &Fitted| of(one.model, &one.parameters) - value;
        let (mut down, mut up) = (0.0_f64, 0.0_f64);
        for one in others.iter().chain([&taken]) {
            let room = SES * SES - (one.sum - least) / variance;
            if room >= 0.0 {
                let half = (room * variance * one.spread(of)).sqrt();
                (down, up) = (down.max(half - shift(one)), up.max(half + shift(one)));
            }
        }
        let rest = at_rest.as_ref().map_or(0.0, shift);
        Interval { value, low: value - down.hypot(rest), high: value + up.hypot(rest) }
    };
    // What takes time takes some.
    let time = |of: &dyn Fn(Model, &Parameters) -> f64| {
        let one = interval(of);
        Interval { low: one.low.max(0.0), ..one }
    };
    let course = Course {
        onset_s: wider(interval(&|_, p| p[0]), frame_s),
        t50_s: time(&|model, p| to_share(model, p, 0.5)),
        t90_s: time(&|model, p| to_share(model, p, 0.9)),
        tau_s: time(&|_, p| p[1].exp()),
        depth: p[4] - p[3],
        sd: sd(&taken),
        seen: Curve::new(model, p).reached(time_s[time_s.len() - 1] - p[0]),
        model,
    };
    let all = [course.onset_s, course.t50_s, course.t90_s, course.tau_s];
    // An onset's interval longer than what was looked at says that nothing is known.
    let is_known = course.onset_s.high - course.onset_s.low <= 2.0 * span_s;
    (is_known && all.iter().all(|one| one.low.is_finite() && one.high.is_finite())).then_some(course)
}

/// An onset's interval with a frame after it and two before: a force begins more smoothly than a ramp, so that its
/// onset is seen late (measured on the phantom at 30 frames a second: presses by 6 to 31 ms, releases by up to 62).
fn wider(one: Interval, frame_s: f64) -> Interval {
    let (down, up) = (one.value - one.low, one.high - one.value);
    Interval { low: one.value - down.hypot(2.0 * frame_s), high: one.value + up.hypot(frame_s), ..one }
}

/// For slopes.
const SMALL: f64 = 1e-5;

/// The best onset and tau of a grid, with their levels.
fn search(time_s: &[f64], values: &[f64], near_s: f64) -> Option<Parameters> {
    let (first, last) = (*time_s.first()?, *time_s.last()?);
    let frame = (last - first) / (time_s.len() - 1).max(1) as f64;
    let onsets =
        (0..60).map(|k| near_s + (f64::from(k) - 40.0) * 0.5 * frame.max(0.02)).filter(|t| *t > first && *t < last);
    // What is left of a step from time 0 on: that from an onset on is a multiple of it.
    let left = |tau: f64| time_s.iter().map(|t| (-t / tau).exp()).collect::<Vec<f64>>();
    let taus: Vec<(f64, Vec<f64>)> = (0..22).map(|k| 0.03 * 1.3_f64.powi(k)).map(|tau| (tau, left(tau))).collect();
    let mut best: Option<(f64, Parameters)> = None;
    for onset in onsets {
        for (tau, left) in &taus {
            let mut p = [onset, tau.ln(), 0.0, 0.0, 1.0];
            let since = (onset / tau).exp();
            let (mut n, mut x, mut y, mut xx, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for ((&t, &value), left) in time_s.iter().zip(values).zip(left) {
                // A product of infinity and nothing is taken for the start of the step.
                let shape = if t <= onset { 0.0 } else { 1.0 - (since * left).min(1.0) };
                (n, x, y) = (n + 1.0, x + shape, y + value);
                (xx, xy) = (xx + shape * shape, xy + shape * value);
            }
            let spread = xx - x * x / n;
            if spread < 1e-6 {
                continue;
            }
            let step = (xy - x * y / n) / spread;
            let gain = step * (xy - x * y / n);
            (p[3], p[4]) = ((y - step * x) / n, (y - step * x) / n + step);
            if best.as_ref().is_none_or(|(most, _)| gain > *most) {
                best = Some((gain, p));
            }
        }
    }
    best.map(|(_, p)| p)
}

struct Fitted {
    model: Model,
    parameters: Parameters,
    free: Vec<usize>,
    /// Of J'J.
    inverse: DMatrix<f64>,
    residuals: Vec<f64>,
    sum: f64,
}

impl Fitted {
    /// The variance of a figure in that of the values.
    fn spread(&self, of: &dyn Fn(Model, &Parameters) -> f64) -> f64 {
        let value = of(self.model, &self.parameters);
        let slope = |&k: &usize| {
            let mut moved = self.parameters;
            moved[k] += SMALL;
            (of(self.model, &moved) - value) / SMALL
        };
        let slopes = DVector::from_iterator(self.free.len(), self.free.iter().map(slope));
        (slopes.transpose() * &self.inverse * &slopes)[(0, 0)].max(0.0)
    }
}

/// Levenberg-Marquardt steps in the free parameters.
fn refine(model: Model, time_s: &[f64], values: &[f64], start: Parameters, free: &[usize]) -> Option<Fitted> {
    let residuals = |p: &Parameters| -> Vec<f64> {
        let curve = Curve::new(model, p);
        time_s.iter().zip(values).map(|(&t, value)| value - curve.at(t)).collect()
    };
    let sum = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    let allowed = |p: &Parameters| {
        let third = match model {
            Model::Step => true,
            Model::Ramp => RAMPS_S.contains(&p[2].exp()),
            Model::Stretched => POWERS.contains(&p[2].exp()),
        };
        third && TAUS_S.contains(&p[1].exp()) && p.iter().all(|part| part.is_finite())
    };
    let jacobian = |p: &Parameters, at: &[f64]| {
        let moved = |&k: &usize| {
            let mut moved = *p;
            moved[k] += SMALL;
            Curve::new(model, &moved)
        };
        let moved: Vec<Curve> = free.iter().map(moved).collect();
        DMatrix::from_fn(values.len(), free.len(), |row, column| {
            (at[row] - (values[row] - moved[column].at(time_s[row]))) / SMALL
        })
    };
    let mut p = start;
    let mut r = residuals(&p);
    let (mut least, mut damping) = (sum(&r), 1e-3);
    for _ in 0..60 {
        let j = jacobian(&p, &r);
        let mut normal = j.transpose() * &j;
        let right = j.transpose() * DVector::from_column_slice(&r);
        for k in 0..free.len() {
            normal[(k, k)] *= 1.0 + damping;
        }
        let Some(factored) = normal.cholesky() else {
            damping *= 10.0;
            continue;
        };
        let step = factored.solve(&right);
        let mut next = p;
        free.iter().enumerate().for_each(|(k, &at)| next[at] += step[k]);
        let next_r = residuals(&next);
        let next_sum = sum(&next_r);
        if allowed(&next) && next_sum <= least {
            let settled = least - next_sum <= 1e-10 * least;
            (p, r, least, damping) = (next, next_r, next_sum, damping * 0.3);
            if settled {
                break;
            }
        } else {
            damping *= 5.0;
            if damping > 1e8 {
                break;
            }
        }
    }
    let j = jacobian(&p, &r);
    let inverse = (j.transpose() * &j).try_inverse()?;
    Some(Fitted { model, parameters: p, free: free.to_vec(), inverse, residuals: r, sum: least })
}

/// By how much correlation in time enlarges a variance: (1 + r)/(1 - r), r that of neighbours, never below 1.
fn correlation_factor(residuals: &[f64]) -> f64 {
    let squares: f64 = residuals.iter().map(|r| r * r).sum();
    let neighbours: f64 = residuals.windows(2).map(|r| r[0] * r[1]).sum();
    let r = (neighbours / squares.max(1e-30)).clamp(0.0, 0.95);
    (1.0 + r) / (1.0 - r)
}
