//! The ambient light at the times of lit samples, from the unlit samples around them.
//!
//! In: a channel's unlit samples at their own, irregular times. Out: for each lit time, the level, NaN where it can't
//! be known.
//!
//! Cubic Lagrange interpolation through two unlit samples before and two after. With alternating rows it takes the
//! light from the four neighbours with weights -1/16, 9/16, 9/16, -1/16, which leaves 3/8 (2 pi f T)^4 / 16 of a ripple
//! of frequency f (T the time between unlit samples) where the straight line leaves (2 pi f T)^2 / 8: at 1 Hz and T =
//! 80 ms 0.15 % against 3.1 %, and 50 % where the sample before is taken. It costs little noise: a row's noise is 1.28
//! times a sample's, 1.22 with the line, 1.41 with the sample before. Where there is one neighbour only on a side, and
//! where weights would make more noise than one sample has (neighbours close together and far from the lit sample),
//! three neighbours or two do.
//!
//! Never across a gap: where the unlit samples before and after are further apart than three usual times, and before
//! the first and behind the last of them, the level is not known. Unlit samples with one stamp count as one, with their
//! mean.
//!
//! What can't be had this way: a ripple near half the rate of the unlit samples or above it, such as the hum of lamps
//! at 100 or 120 Hz unless the log's rate divides it (25, 50 and 100 Hz divide 100 Hz). It stays in the rows as noise
//! does; [`roughness`] measures how much there is.

use crate::median::median;

/// Unlit samples further apart than so many usual times have a gap between them.
pub(super) const GAP_PERIODS: f64 = 3.0;

/// When the LED was off, and when it was on.
#[derive(Debug)]
pub(super) struct Unlit {
    lit_s: Vec<f64>,
    dark_s: Vec<f64>,
    /// The longest time between unlit samples to interpolate over, seconds.
    longest_s: f64,
    /// The mean square of a row's noise, in a sample's.
    noise: f64,
}

/// The ambient light at a lit sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ambient {
    /// As the channel's samples; NaN where not known.
    pub(super) level: f64,
    /// Whether a sample went into it that was at the end of the range.
    pub(super) saturated: bool,
}

/// Which unlit samples a level is made of, and with what weights.
#[derive(Debug, Clone, Copy)]
struct Mix {
    first: usize,
    count: usize,
    weights: [f64; 4],
}

impl Unlit {
    /// Of a log's times, the lit and the unlit rows.
    pub(super) fn new(time_s: &[f64], lit: &[usize], dark: &[usize]) -> Self {
        let taken = |rows: &[usize]| -> Vec<f64> { rows.iter().map(|&row| time_s[row]).collect() };
        let (lit_s, dark_s) = (taken(lit), taken(dark));
        let longest_s = GAP_PERIODS * usual_distance_s(&lit_s, &dark_s);
        let mut unlit = Self { lit_s, dark_s, longest_s, noise: f64::NAN };
        let mixes = unlit.mixes(&unlit.dark_s);
        let squares = mixes.iter().flatten().map(|mix| 1.0 + mix.weights.iter().map(|w| w * w).sum::<f64>());
        unlit.noise = squares.sum::<f64>() / mixes.iter().flatten().count() as f64;
        unlit
    }

    /// The ambient light at each lit sample, from a channel's unlit samples (NaN where missing).
    pub(super) fn at_lit(&self, dark: &[f64], reached: impl Fn(f64) -> bool) -> Vec<Ambient> {
        // One sample for each stamp.
        let (mut times_s, mut levels, mut saturated): (Vec<f64>, Vec<f64>, Vec<bool>) =
            (Vec::new(), Vec::new(), Vec::new());
        let mut alike = 0.0;
        for (&time_s, &level) in self.dark_s.iter().zip(dark).filter(|(_, level)| !level.is_nan()) {
            match (levels.last_mut(), saturated.last_mut()) {
                (Some(mean), Some(any)) if times_s.last() == Some(&time_s) => {
                    alike += 1.0;
                    *mean += (level - *mean) / alike;
                    *any |= reached(level);
                }
                _ => {
                    alike = 1.0;
                    times_s.push(time_s);
                    levels.push(level);
                    saturated.push(reached(level));
                }
            }
        }
        let mixed = |mix: Option<Mix>| {
            let Some(Mix { first, count, weights }) = mix else { return Ambient { level: f64::NAN, saturated: false } };
            let level = levels[first..first + count].iter().zip(weights).map(|(level, w)| level * w).sum();
            Ambient { level, saturated: saturated[first..first + count].contains(&true) }
        };
        self.mixes(&times_s).into_iter().map(mixed).collect()
    }

    /// How much light was taken away and what it costs, for a note on the channels' shares.
    pub(super) fn note(&self, shares: &[Share]) -> Option<String> {
        // Of a channel that shows nothing, there is no share.
        let known = || shares.iter().filter(|share| share.ambient.is_finite() && share.rough.is_finite());
        let least = known().map(|share| share.ambient).reduce(f64::min)?;
        let most = known().map(|share| share.ambient).reduce(f64::max)?;
        let rough = known().map(|share| share.rough).fold(0.0, f64::max);
        self.noise.is_finite().then(|| {
            format!(
                "ambient light taken away, as interpolated between the unlit samples around: {:.1} to {:.1} % of what \
                 the photodiodes read lit; a row's noise is {:.2} times a sample's; \
                 noise and ripple of the unlit light too fast to follow are up to {:.3} % of the LED's",
                100.0 * least,
                100.0 * most,
                self.noise.sqrt(),
                100.0 * rough
            )
        })
    }

    /// For each lit sample, how its level is made of the samples at `times_s`, which ascend.
    fn mixes(&self, times_s: &[f64]) -> Vec<Option<Mix>> {
        let mut after = 0;
        let mixes = self.lit_s.iter().map(|&lit_s| {
            while times_s.get(after).is_some_and(|&t| t < lit_s) {
                after += 1;
            }
            self.mix(times_s, after, lit_s)
        });
        mixes.collect()
    }

    /// `after` is the first sample that is not before `lit_s`.
    fn mix(&self, times_s: &[f64], after: usize, lit_s: f64) -> Option<Mix> {
        let right_s = *times_s.get(after)?;
        if right_s == lit_s {
            return Some(Mix { first: after, count: 1, weights: [1.0, 0.0, 0.0, 0.0] });
        }
        let before = after.checked_sub(1)?;
        let near = |k: usize| times_s[k + 1] - times_s[k] <= self.longest_s;
        if !near(before) {
            return None;
        }
        let first = if before > 0 && near(before - 1) { before - 1 } else { before };
        let last = if after + 1 < times_s.len() && near(after) { after + 1 } else { after };
        let calm = |mix: &Mix| mix.weights.iter().map(|w| w * w).sum::<f64>() <= 1.0;
        let through = |first: usize, last: usize| Mix {
            first,
            count: last - first + 1,
            weights: lagrange(&times_s[first..=last], lit_s),
        };
        let mixes = [through(first, last), through(first, after), through(before, last)];
        mixes.into_iter().find(calm).or_else(|| Some(through(before, after)))
    }
}

/// How much of a channel's light is ambient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Share {
    /// The mean ambient light, as a share of the mean light that is read lit.
    pub(super) ambient: f64,
    /// What of the unlit light no cubic follows, root mean square, as a share of the LED's mean light.
    pub(super) rough: f64,
}

/// What of a channel's unlit samples no cubic follows, root mean square, as if all of it were noise: by fourth
/// differences, whose variance is 70 times that of independent noise. A ripple at the unlit samples' own half rate
/// counts 1.9 times.
pub(super) fn roughness(dark: &[f64]) -> f64 {
    let squares = dark.windows(5).filter_map(|v| {
        let fourth = v[0] - 4.0 * v[1] + 6.0 * v[2] - 4.0 * v[3] + v[4];
        (!fourth.is_nan()).then_some(fourth * fourth / 70.0)
    });
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
}

/// The weights of up to four samples in the value of the polynomial through them.
fn lagrange(times_s: &[f64], at_s: f64) -> [f64; 4] {
    let mut weights = [0.0; 4];
    for (k, weight) in weights.iter_mut().enumerate().take(times_s.len()) {
        let others = (0..times_s.len()).filter(|&j| j != k);
        *weight = others.map(|j| (at_s - times_s[j]) / (times_s[k] - times_s[j])).product();
    }
    weights
}

/// The usual distance of the unlit samples before and after a lit one, seconds; infinite where no lit one stands
/// between two.
fn usual_distance_s(lit_s: &[f64], dark_s: &[f64]) -> f64 {
    let mut after = 0;
    let mut distances: Vec<f64> = Vec::new();
    for &lit_s in lit_s {
        while dark_s.get(after).is_some_and(|&t| t < lit_s) {
            after += 1;
        }
        if after > 0 && after < dark_s.len() && dark_s[after] > lit_s {
            distances.push(dark_s[after] - dark_s[after - 1]);
        }
    }
    median(&mut distances).unwrap_or(f64::INFINITY)
}
