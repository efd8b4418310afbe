//! The course of one trace after one press or release: a first-order lag (4.3) after a step; or after a ramp, as no
//! finger presses or lets go at once; or two of them side by side, as some blood comes back more slowly.
//!
//! The step is taken unless the data say otherwise, the ramp in little noise. A coarse search over onset and tau finds
//! the minimum that Levenberg-Marquardt steps then refine. A ramp shorter than a frame has its length held.
//!
//! The intervals are those of the profile likelihood over shapes: what any of the courses says that are about as likely
//! as the best and whose end is seen, also ramps of lengths and slow shares that are not the best. That a step is taken
//! says nothing against a ramp of 0.2 s (measured on traces: the step's own interval held its onset in 61 to 76 %) or a
//! fifth of the blood that is slower (its t90 in 8 to 81 % without courses of two). They hold the noise with its
//! correlation in time, pulse and slow waves among it, and the choice of the end level.
//!
//! Where a trace has such waves and only white noise is assumed, a course bends along with them: in the pulse and the
//! waves of real blood (`tests::real_data`) t90's interval held the truth in 36 to 66 %, so in 89 to 96 %. The price:
//! of blood a part of which comes back more slowly t90 is 4 to 15 % short in place of 1 to 9 %, within its interval, as
//! slow waves may look like that.

use std::ops::RangeInclusive;

use lunula_hemodynamics::noise::{Level, Noise, Slow};
use nalgebra::{Matrix6, Vector6};

/// Time constants that are looked for, seconds (the thesis' are 0.12 to 0.36).
const TAUS_S: RangeInclusive<f64> = 0.02..=10.0;
/// Ramps that are looked for, seconds; shares of the step that are slower, and by how much.
const RAMPS_S: RangeInclusive<f64> = 0.004..=1.5;
const LEAST_RAMP_S: f64 = 0.01;
const SHARES: RangeInclusive<f64> = 0.001..=0.6;
const SLOWER: RangeInclusive<f64> = 1.5..=20.0;
/// How much slower the slow course is unless the data say otherwise.
const USUALLY_SLOWER: f64 = 4.0;
/// Another model than the step is taken where it lowers the sum of squares by more than so many residual variances (F
/// of one degree of freedom at 5 %).
const BETTER: f64 = 4.0;
/// A step of so many SDs of the residuals shows how long its ramp was (measured on the phantom: releases of 40 to 180
/// SDs are seen 38 ms late by a step, 27 ms by a ramp; at 25 SDs the ramp's length is not determined).
const CLEAR_SDS: f64 = 40.0;
/// Ramps, seconds, and slow shares that a course is compared with.
const LENGTHS_S: [f64; 6] = [0.02, 0.05, 0.1, 0.2, 0.35, 0.6];
const SLOW_SHARES: [f64; 4] = [0.05, 0.1, 0.2, 0.35];
/// Share of a course's step that has to be seen.
pub(super) const LEAST_SEEN: f64 = 0.95;
/// The half width of a 95 % interval in standard errors.
const SES: f64 = 1.96;
/// By how much an onset may be seen late, and by two frames at least; early by one: a force begins more smoothly than a
/// ramp (measured on the phantom at 30 frames a second: presses by 6 to 31 ms, releases by up to 62; at 60 and 120 by
/// 20 and 34 ms in the median).
const LATE_S: f64 = 2.0 / 30.0;

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
    Two,
}

impl Model {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Step => "exponential",
            Self::Ramp => "exponential after a ramp",
            Self::Two => "two exponentials",
        }
    }
}

/// Parameters: onset, ln tau, ln of the ramp's length or of the slow share, level before, level after, ln of how much
/// slower that share is.
type Parameters = [f64; PARAMETERS];
const PARAMETERS: usize = 6;

/// A course with its parameters as they are used: a fit evaluates it thousands of times.
struct Curve {
    model: Model,
    onset_s: f64,
    tau_s: f64,
    /// The ramp's length or the slow share.
    third: f64,
    before: f64,
    step: f64,
    /// The slow course's time constant, in tau.
    slower: f64,
}

impl Curve {
    fn new(model: Model, p: &Parameters) -> Self {
        let [onset_s, tau, third, before, after, slower] = *p;
        let [tau_s, third, slower] = [tau, third, slower].map(f64::exp);
        Self { model, onset_s, tau_s, third, before, step: after - before, slower }
    }

    /// The share of the step that is reached some time after the onset, with its slopes in that time and in the
    /// logarithms of tau, the third and what is slower.
    fn reached(&self, since_s: f64) -> [f64; 5] {
        if since_s <= 0.0 {
            return [0.0; 5];
        }
        let Self { tau_s, third, slower, .. } = *self;
        // What is left after a time, and its slope in ln tau.
        let left = |s: f64| {
            let taus = s / tau_s;
            let left = (-taus).exp();
            [left, taus * left]
        };
        let [e, e_tau] = left(since_s);
        match self.model {
            Model::Step => [1.0 - e, e / tau_s, -e_tau, 0.0, 0.0],
            Model::Ramp => {
                let lag = tau_s / third;
                if since_s < third {
                    let reached = since_s / third - lag * (1.0 - e);
                    return [reached, (1.0 - e) / third, lag * (e_tau - (1.0 - e)), -reached, 0.0];
                }
                let [end, end_tau] = left(since_s - third);
                let still = lag * (end - e);
                [1.0 - still, (end - e) / third, lag * (e_tau - end_tau) - still, still - end, 0.0]
            }
            Model::Two => {
                let [slow, slow_tau] = left(since_s / slower);
                let mixed = |fast: f64, slow: f64| (1.0 - third) * fast + third * slow;
                let slope = mixed(e, slow / slower) / tau_s;
                [1.0 - mixed(e, slow), slope, -mixed(e_tau, slow_tau), third * (e - slow), -third * slow_tau]
            }
        }
    }
}

/// Time from the onset to a share of the step, by halving: it only grows.
fn to_share(model: Model, p: &Parameters, share: f64) -> f64 {
    let curve = Curve::new(model, p);
    let (mut low, mut high) = (0.0, 1e3);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if curve.reached(middle)[0] < share { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

/// Fits times and values (all known, times ascending) about a step near `near_s`; `rest` is another possible end level.
pub(super) fn fit(time_s: &[f64], values: &[f64], near_s: f64, rest: Option<f64>) -> Option<Course> {
    let start = search(time_s, values, near_s)?;
    let white = Noise::new(time_s, Slow::NONE);
    let mut fits = Samples { time_s, values, noise: &white }.fits(start)?;
    // From the step's residuals at first: what is no step would take the waves for its own.
    let (mut noise, mut slow, mut of) = (white, Slow::NONE, fits.len() - 1);
    for _ in 0..2 {
        let likely = Samples { time_s, values, noise: &noise }.likeliest(&fits[of]);
        if likely == slow {
            break;
        }
        (noise, slow) = (Noise::new(time_s, likely), likely);
        fits = Samples { time_s, values, noise: &noise }.fits(fits[of].parameters)?;
        of = simplest(&fits, false);
    }
    let samples = Samples { time_s, values, noise: &noise };
    let mut slow_start = fits[fits.len() - 1].parameters;
    let mut taken = fits.swap_remove(simplest(&fits, true));
    if taken.model == Model::Two
        && let Some(free) = samples.refine(Model::Two, taken.parameters, &[0, 1, 2, 3, 4, 5])
    {
        slow_start = free.parameters;
        fits.push(if taken.behind(&free) > BETTER { std::mem::replace(&mut taken, free) } else { free });
    }
    let model = taken.model;
    let last_s = time_s[time_s.len() - 1];
    let span_s = last_s - time_s[0];
    let frame_s = span_s / (time_s.len() - 1).max(1) as f64;
    let held = |model: Model, mut start: Parameters, third: f64| {
        start[2] = third.ln();
        samples.refine(model, start, &[0, 1, 3, 4])
    };
    let (p, length_s) = (taken.parameters, taken.parameters[2].exp());
    // What else the course may be, of a shape that is held: the data need not tell what length or share is the best.
    let mut others: Vec<Fitted> =
        fits.iter().filter_map(|one| held(one.model, one.parameters, one.parameters[2].exp())).collect();
    if model == Model::Ramp && length_s < frame_s {
        // Frames do not show how long it was.
        taken = held(model, p, length_s)?;
        others.extend([*RAMPS_S.start(), frame_s].into_iter().filter_map(|length_s| held(model, p, length_s)));
    }
    for (model, mut start, thirds) in [(Model::Ramp, p, &LENGTHS_S[..]), (Model::Two, slow_start, &SLOW_SHARES[..])] {
        for &third in thirds {
            let one = held(model, start, third).filter(|one| one.behind(&taken) <= SES * SES);
            let Some(one) = one else { break };
            start = one.parameters;
            others.push(one);
        }
    }
    let seen = |one: &Fitted| Curve::new(one.model, &one.parameters).reached(last_s - one.parameters[0])[0];
    others.retain(|one| seen(one) >= LEAST_SEEN);
    let best = others.iter().fold(&taken, |best, one| if one.sum < best.sum { one } else { best });
    let (least, variance) = (best.sum, best.variance());
    let at_rest = rest.and_then(|level| {
        let mut start = taken.parameters;
        start[4] = level;
        let free: Vec<usize> = taken.free.iter().copied().filter(|&k| k != 4).collect();
        samples.refine(model, start, &free)
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
    let time = |one: Interval| Interval { low: one.low.max(0.0), ..one };
    let (early_s, late_s) = (frame_s, LATE_S.max(2.0 * frame_s));
    // An onset that is seen late makes what is counted from it short.
    let since_onset = |share: f64| wider(interval(&|model, p| to_share(model, p, share)), early_s, late_s);
    let course = Course {
        onset_s: wider(interval(&|_, p| p[0]), late_s, early_s),
        t50_s: time(since_onset(0.5)),
        t90_s: time(since_onset(0.9)),
        tau_s: time(interval(&|_, p| p[1].exp())),
        depth: p[4] - p[3],
        sd: taken.raw_sd,
        seen: seen(&taken),
        model,
    };
    let all = [course.onset_s, course.t50_s, course.t90_s, course.tau_s];
    // An onset's interval longer than what was looked at says that nothing is known.
    let is_known = course.onset_s.high - course.onset_s.low <= 2.0 * span_s;
    (is_known && all.iter().all(|one| one.low.is_finite() && one.high.is_finite())).then_some(course)
}

/// Which of some fits is the simplest that is about as good as the best; `ramps`: that is a ramp's in little noise,
/// where its length is determined and its onset is earlier than the step's by half of it.
fn simplest(fits: &[Fitted], ramps: bool) -> usize {
    // A ramp of no length is a step, and nothing determines its length.
    let is_one = |one: &Fitted| one.model != Model::Ramp || one.parameters[2].exp() > LEAST_RAMP_S;
    let mut known = (0..fits.len()).filter(|&k| is_one(&fits[k]));
    let best = known.clone().min_by(|&a, &b| fits[a].sum.total_cmp(&fits[b].sum)).unwrap_or(fits.len() - 1);
    let step = fits[best].parameters[4] - fits[best].parameters[3];
    let simplest = if ramps && step.abs() > CLEAR_SDS * fits[best].sd { Model::Ramp } else { Model::Step };
    let is_good_enough = |&k: &usize| fits[k].model == simplest && fits[k].behind(&fits[best]) <= BETTER;
    known.find(is_good_enough).unwrap_or(best)
}

/// An interval with so much more below and above.
fn wider(one: Interval, below: f64, above: f64) -> Interval {
    let (down, up) = (one.value - one.low, one.high - one.value);
    Interval { low: one.value - down.hypot(below), high: one.value + up.hypot(above), ..one }
}

/// For slopes.
const SMALL: f64 = 1e-5;

/// The best onset and tau of a grid, with their levels.
fn search(time_s: &[f64], values: &[f64], near_s: f64) -> Option<Parameters> {
    let (first, last) = (*time_s.first()?, *time_s.last()?);
    let n = time_s.len() as f64;
    let frame = (last - first) / (n - 1.0).max(1.0);
    let onsets =
        (0..60).map(|k| near_s + (f64::from(k) - 40.0) * 0.5 * frame.max(0.02)).filter(|t| *t > first && *t < last);
    let onsets: Vec<(f64, usize)> = onsets.map(|onset| (onset, time_s.partition_point(|&t| t <= onset))).collect();
    let all: f64 = values.iter().sum();
    let mut best: Option<(f64, Parameters)> = None;
    for tau in (0..22).map(|k| 0.03 * 1.3_f64.powi(k)) {
        // Sums from each sample on: of the values, and of what is left of a step from time 0 on, its squares, and its
        // products with them. What is left of a step from an onset on is a multiple of it.
        let mut sums = vec![[0.0; 4]; values.len() + 1];
        for (k, (&t, &value)) in time_s.iter().zip(values).enumerate().rev() {
            let left = (-t / tau).exp();
            let [of_values, of_left, squares, products] = sums[k + 1];
            sums[k] = [of_values + value, of_left + left, squares + left * left, products + left * value];
        }
        for &(onset, from) in &onsets {
            let by = (onset / tau).exp();
            let after = n - from as f64;
            let [of_values, of_left, squares, products] = sums[from];
            let (x, xx) = (after - by * of_left, after - by * (2.0 * of_left - by * squares));
            let spread = xx - x * x / n;
            if spread < 1e-6 {
                continue;
            }
            let gained = of_values - by * products - x * all / n;
            let step = gained / spread;
            let before = (all - step * x) / n;
            if best.as_ref().is_none_or(|(most, _)| step * gained > *most) {
                best = Some((step * gained, [onset, tau.ln(), 0.0, before, before + step, USUALLY_SLOWER.ln()]));
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
    inverse: Matrix6<f64>,
    /// Of the squares of the whitened residuals, their SD, and that of the residuals themselves.
    sum: f64,
    sd: f64,
    raw_sd: f64,
    /// By how much correlation of what is whitened enlarges a variance: (1 + r)/(1 - r), r that of neighbours, never
    /// below 1.
    correlation: f64,
}

impl Fitted {
    /// Of the residuals; those that go together count less.
    fn variance(&self) -> f64 {
        self.sd * self.sd * self.correlation
    }

    /// By how many variances its sum of squares is larger.
    fn behind(&self, best: &Self) -> f64 {
        (self.sum - best.sum) / best.variance()
    }

    /// The variance of a figure in that of the values.
    fn spread(&self, of: &dyn Fn(Model, &Parameters) -> f64) -> f64 {
        let value = of(self.model, &self.parameters);
        let mut slopes = Vector6::zeros();
        for &k in &self.free {
            let mut moved = self.parameters;
            moved[k] += SMALL;
            slopes[k] = (of(self.model, &moved) - value) / SMALL;
        }
        (slopes.transpose() * self.inverse * slopes)[(0, 0)].max(0.0)
    }
}

/// The normal equations about a course, of whitened residuals and slopes.
struct Normal {
    /// Of the squares of the residuals, before and after, and of the products of neighbours.
    raw: f64,
    sum: f64,
    neighbours: f64,
    /// J'J and J'r; what is held has a one on the diagonal and nothing beside it.
    square: Matrix6<f64>,
    right: Vector6<f64>,
}

/// What is fitted, and the noise in it.
struct Samples<'a> {
    time_s: &'a [f64],
    values: &'a [f64],
    noise: &'a Noise,
}

impl Samples<'_> {
    /// Two exponentials, one after a ramp, one after a step, which comes last.
    fn fits(&self, start: Parameters) -> Option<Vec<Fitted>> {
        let plain = self.refine(Model::Step, start, &[0, 1, 3, 4])?;
        let with = |model: Model, third: f64, earlier_s: f64| {
            let mut start = plain.parameters;
            (start[0], start[2]) = (start[0] - earlier_s, third.ln());
            self.refine(model, start, &[0, 1, 2, 3, 4])
        };
        let others = [with(Model::Two, 0.2, 0.0), with(Model::Ramp, 0.1, 0.05)];
        Some(others.into_iter().flatten().chain([plain]).collect())
    }

    /// The noise about a course by its restricted likelihood, which knows that the course bends along with it.
    fn likeliest(&self, about: &Fitted) -> Slow {
        let free = (self.values.len() - about.free.len()) as f64;
        let likelihood = |slow: Slow| {
            let noise = &Noise::new(self.time_s, slow);
            let at = Samples { noise, ..*self }.normal(about.model, &about.parameters, &about.free);
            let Some(factored) = at.square.cholesky() else { return f64::NEG_INFINITY };
            let left = at.sum - at.right.dot(&factored.solve(&at.right));
            -(free * left.ln() + noise.ln_det + factored.ln_determinant())
        };
        let all = Slow::all().map(|slow| (likelihood(slow), slow));
        let best = all.fold((f64::NEG_INFINITY, Slow::NONE), |best, one| if one.0 > best.0 { one } else { best });
        best.1.enlarged()
    }

    fn normal(&self, model: Model, p: &Parameters, free: &[usize]) -> Normal {
        let curve = Curve::new(model, p);
        let (mut raw, mut sum, mut neighbours, mut before) = (0.0, 0.0, 0.0, 0.0);
        let (mut level, mut levels) = (Level::default(), [Level::default(); PARAMETERS]);
        let (mut square, mut right) = ([[0.0; PARAMETERS]; PARAMETERS], [0.0; PARAMETERS]);
        for ((&t, &value), &predicted) in self.time_s.iter().zip(self.values).zip(&self.noise.steps) {
            let [reached, since, tau, third, slower] = curve.reached(t - curve.onset_s);
            let residual = value - curve.before - curve.step * reached;
            raw += residual * residual;
            let residual = level.error(residual, predicted);
            (sum, neighbours, before) = (sum + residual * residual, neighbours + residual * before, residual);
            let step = curve.step;
            let mut slopes = [-step * since, step * tau, step * third, 1.0 - reached, reached, step * slower];
            for (count, &k) in free.iter().enumerate() {
                slopes[k] = levels[k].error(slopes[k], predicted);
                right[k] += slopes[k] * residual;
                for &l in &free[..=count] {
                    square[k][l] += slopes[k] * slopes[l];
                }
            }
        }
        for (count, &k) in free.iter().enumerate() {
            free[..count].iter().for_each(|&l| square[l][k] = square[k][l]);
        }
        (0..PARAMETERS).filter(|k| !free.contains(k)).for_each(|k| square[k][k] = 1.0);
        Normal { raw, sum, neighbours, square: square.into(), right: right.into() }
    }

    /// Levenberg-Marquardt steps in the free parameters.
    fn refine(&self, model: Model, start: Parameters, free: &[usize]) -> Option<Fitted> {
        let allowed = |p: &Parameters| {
            let third = match model {
                Model::Step => true,
                Model::Ramp => RAMPS_S.contains(&p[2].exp()),
                Model::Two => SHARES.contains(&p[2].exp()) && SLOWER.contains(&p[5].exp()),
            };
            third && TAUS_S.contains(&p[1].exp()) && p.iter().all(|part| part.is_finite())
        };
        let (mut p, mut at, mut damping) = (start, self.normal(model, &start, free), 1e-3);
        for _ in 0..60 {
            let mut damped = at.square;
            for k in 0..PARAMETERS {
                damped[(k, k)] *= 1.0 + damping;
            }
            let Some(factored) = damped.cholesky() else {
                damping *= 10.0;
                continue;
            };
            let step = factored.solve(&at.right);
            let next = std::array::from_fn(|k| p[k] + step[k]);
            let tried = allowed(&next).then(|| self.normal(model, &next, free)).filter(|tried| tried.sum <= at.sum);
            if let Some(tried) = tried {
                let settled = at.sum - tried.sum <= 1e-8 * at.sum;
                (p, at, damping) = (next, tried, damping * 0.3);
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
        let together = (at.neighbours / at.sum.max(1e-30)).clamp(0.0, 0.95);
        let degrees = (self.values.len() as f64 - 5.0).max(1.0);
        Some(Fitted {
            model,
            parameters: p,
            free: free.to_vec(),
            inverse: at.square.try_inverse()?,
            sum: at.sum,
            sd: (at.sum / degrees).sqrt(),
            raw_sd: (at.raw / degrees).sqrt(),
            correlation: (1.0 + together) / (1.0 - together),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_differences() {
        let p = [0.3, 0.5_f64.ln(), 0.2_f64.ln(), 1.0, 4.0, 3.0_f64.ln()];
        for model in [Model::Step, Model::Ramp, Model::Two] {
            let at = |p: &Parameters, since_s: f64| Curve::new(model, p).reached(since_s);
            for since_s in [-0.1, 0.05, 0.15, 0.25, 1.0, 4.0] {
                let slopes = at(&p, since_s);
                let difference = (at(&p, since_s + SMALL)[0] - at(&p, since_s - SMALL)[0]) / (2.0 * SMALL);
                assert!((slopes[1] - difference).abs() <= 1e-6, "{model:?} {since_s} {slopes:?} {difference}");
                for (slope, k) in slopes[2..].iter().zip([1, 2, 5]) {
                    let [up, down] = [SMALL, -SMALL].map(|by| {
                        let mut moved = p;
                        moved[k] += by;
                        at(&moved, since_s)[0]
                    });
                    let difference = (up - down) / (2.0 * SMALL);
                    assert!((slope - difference).abs() <= 1e-6, "{model:?} {since_s} {k} {slope} {difference}");
                }
            }
        }
    }
}
