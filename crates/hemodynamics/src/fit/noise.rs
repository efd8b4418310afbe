//! What a series of samples does beside its course: white noise; first-order noise of an encoder, of the pulse or of
//! the blood's slow waves (vasomotion, about 0.1 Hz); and a pulse that keeps its beat for a while.
//!
//! In: times and what is tried. Out: the Kalman filter that makes such noise white, and the determinant of its
//! covariance, by which the likeliest can be chosen. Whoever fits in it whitens residuals and slopes alike.

use std::f64::consts::TAU;

/// Time constants that are tried, seconds.
const SLOW_S: [f64; 3] = [0.05, 0.5, 2.5];
/// SDs that are tried, in that of the white noise.
const SDS: [f64; 7] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
/// From such a time constant on, the blood's waves.
const WAVES_S: f64 = 1.0;
/// Waves are smoother than first-order noise, whose size is that of its steps: their SD is enlarged by this
/// (chosen on traces with waves of a period of 10 s, so that intervals hold them).
const SMOOTHER: f64 = 1.5;
/// Tenths of a hertz at which a pulse is looked for (36 to 150 beats a minute), and its SD there, in that of the white
/// noise.
const TENTHS_HZ: std::ops::RangeInclusive<u32> = 6..=25;
const BEATING: f64 = 2.0;
/// How long a pulse keeps its beat, s (assumed; a sixth of a hertz wide).
const BEATS_S: f64 = 3.0;
/// Twice the logarithm of the likelihood by which slow noise has to be better than none: its two unknowns, as by
/// Akaike's criterion; twice that where a pulse is among it.
const WORTH: f64 = 4.0;

/// The noise that comes with white noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slow {
    /// Its SD, in that of the white noise.
    sd: f64,
    /// Its time constant, seconds.
    slow_s: f64,
    /// SD of the pulse, in that of the white noise.
    pulse: f64,
    hz: f64,
}

impl Slow {
    /// White noise alone.
    pub const NONE: Self = Self { sd: 0.0, slow_s: 1.0, pulse: 0.0, hz: 1.0 };

    /// What is tried without a pulse.
    pub fn all() -> impl Iterator<Item = Self> {
        let some = SLOW_S.into_iter().flat_map(|slow_s| SDS.map(|sd| Self { sd, slow_s, ..Self::NONE }));
        std::iter::once(Self::NONE).chain(some)
    }

    /// The likeliest by twice the logarithm of the likelihood, with a pulse among it: the likeliest without one, its
    /// likeliest beat, and both again beside each other. A pulse (2 % of a step, 1 % white noise) as slow noise alone
    /// leaves stiffness off by 44 % (RMS of 60), as a pulse by 19 %, as white noise by 27 % (`tests/fit/noise.rs`).
    pub(super) fn likeliest(likelihood: impl Fn(Self) -> f64) -> Self {
        let better = |from: (f64, Self), tried: &mut dyn Iterator<Item = Self>, worth: f64| {
            let all = tried.map(|slow| (likelihood(slow) - worth, slow));
            all.fold(from, |best, one| if one.0 > best.0 { one } else { best })
        };
        let plain = better((likelihood(Self::NONE), Self::NONE), &mut Self::all(), WORTH);
        let beats = TENTHS_HZ.map(|tenths| Self { pulse: BEATING, hz: 0.1 * f64::from(tenths), ..plain.1 });
        let beat = better(plain, &mut { beats }, 2.0 * WORTH);
        let Self { pulse, hz, .. } = beat.1;
        if pulse == 0.0 {
            return plain.1;
        }
        let beside = better(beat, &mut Self::all().map(|slow| Self { pulse, hz, ..slow }), 2.0 * WORTH);
        better(beside, &mut SDS.map(|pulse| Self { pulse, ..beside.1 }).into_iter(), 2.0 * WORTH).1
    }

    /// As large as it may be where it was the likeliest.
    pub fn enlarged(self) -> Self {
        if self.slow_s >= WAVES_S { Self { sd: SMOOTHER * self.sd, ..self } } else { self }
    }
}

impl std::fmt::Display for Slow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { sd, slow_s, pulse, hz } = *self;
        f.write_str("white")?;
        if pulse > 0.0 {
            write!(f, " and a pulse ({hz:.1} Hz, {pulse} times the white)")?;
        }
        if sd > 0.0 { write!(f, " and slow ({slow_s} s, {sd} times the white)") } else { Ok(()) }
    }
}

/// White and slow noise over times: the Kalman filter that predicts each sample from those before.
#[derive(Debug)]
pub struct Noise {
    /// How each sample is predicted.
    pub steps: Vec<Prediction>,
    /// The logarithm of the determinant of its covariance in the variance of the white noise.
    pub ln_det: f64,
}

/// How a sample is predicted.
#[derive(Debug, Clone, Copy)]
pub struct Prediction {
    /// What is left of the slow noise at the sample before.
    carry: f64,
    /// What is learned from this one.
    gain: f64,
    /// By what the error of the prediction is white.
    scale: f64,
    /// The same of the pulse: what is left of it, as far as it has turned, and what is learned.
    pulse: Option<[[f64; 2]; 2]>,
}

/// How a pulse turns in a time, and what is left of it.
fn turned(since_s: f64, hz: f64) -> [f64; 2] {
    let (sin, cos) = (TAU * hz * since_s).sin_cos();
    [cos, sin].map(|of| (-since_s / BEATS_S).exp() * of)
}

/// A covariance (its upper triangle, row by row) after a time.
fn moved([ss, sx, sy, xx, xy, yy]: [f64; 6], carry: f64, [c, s]: [f64; 2]) -> [f64; 6] {
    let [cc, cs, of_s] = [c * c, c * s, s * s];
    let [xx, xy, yy] =
        [cc * xx + 2.0 * cs * xy + of_s * yy, (cc - of_s) * xy + cs * (yy - xx), of_s * xx - 2.0 * cs * xy + cc * yy];
    [carry * carry * ss, carry * (c * sx + s * sy), carry * (c * sy - s * sx), xx, xy, yy]
}

impl Noise {
    /// Of samples at growing times, s.
    pub fn new(time_s: &[f64], slow: Slow) -> Self {
        let [whole, of_pulse] = [slow.sd, slow.pulse].map(|sd| sd * sd);
        // The covariance of the slow part, the pulse and what it is a quarter of a period later, less that without any
        // samples.
        let (mut known, mut before_s, mut ln_det) = ([0.0; 6], time_s.first().copied().unwrap_or(0.0), 0.0);
        let steps = time_s.iter().map(|&t| {
            let since_s = t - before_s;
            let carry = (-since_s / slow.slow_s).exp();
            let turned = if of_pulse > 0.0 { turned(since_s, slow.hz) } else { [0.0; 2] };
            let [ss, sx, sy, xx, xy, yy] = moved(known, carry, turned);
            let seen = [whole + ss + sx, of_pulse + xx + sx, sy + xy];
            let of_error = seen[0] + seen[1] + 1.0;
            let gain = seen.map(|of| of / of_error);
            let less = |of: f64, i: usize, k: usize| of - gain[i] * seen[k];
            known = [less(ss, 0, 0), less(sx, 0, 1), less(sy, 0, 2), less(xx, 1, 1), less(xy, 1, 2), less(yy, 2, 2)];
            before_s = t;
            ln_det += of_error.ln();
            let pulse = (of_pulse > 0.0).then_some([turned, [gain[1], gain[2]]]);
            Prediction { carry, gain: gain[0], scale: of_error.sqrt().recip(), pulse }
        });
        let steps = steps.collect();
        Self { steps, ln_det }
    }

    /// Makes a series white.
    pub(super) fn whiten(&self, values: &mut [f64]) {
        let mut level = Level::default();
        values.iter_mut().zip(&self.steps).for_each(|(value, by)| *value = level.error(*value, *by));
    }

    /// The slow part of a series, as it is known at each sample from those up to it.
    pub(super) fn levels(&self, values: &[f64]) -> Vec<f64> {
        let mut level = Level::default();
        let known = |(value, by): (&f64, &Prediction)| {
            level.error(*value, *by);
            level.slow + level.pulse[0]
        };
        values.iter().zip(&self.steps).map(known).collect()
    }
}

/// The slow noise as it is known from a series so far.
#[derive(Debug, Clone, Copy, Default)]
pub struct Level {
    slow: f64,
    pulse: [f64; 2],
}

impl Level {
    /// The error of the prediction of the next value of the series, white where the series is such noise.
    #[inline]
    pub fn error(&mut self, value: f64, by: Prediction) -> f64 {
        let ahead = by.carry * self.slow;
        let mut error = value - ahead;
        if let Some([[c, s], gain]) = by.pulse {
            let [x, y] = self.pulse;
            let ahead = [c * x + s * y, c * y - s * x];
            error -= ahead[0];
            self.pulse = [ahead[0] + gain[0] * error, ahead[1] + gain[1] * error];
        }
        self.slow = ahead + by.gain * error;
        error * by.scale
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    #[test]
    fn errors_and_determinant_are_those_of_the_covariance() {
        let time_s = [0.0, 0.03, 0.07, 0.5, 0.53, 3.0];
        let series = [1.0, -0.5, 2.0, 0.3, 0.0, -1.0];
        for slow in Slow::all().map(Slow::enlarged).chain([Slow { sd: 2.0, slow_s: 0.5, pulse: 3.0, hz: 1.2 }]) {
            let noise = Noise::new(&time_s, slow);
            let mut white = series;
            noise.whiten(&mut white);
            let sum: f64 = white.iter().map(|value| value * value).sum();
            let covariance = DMatrix::from_fn(6, 6, |i, k| {
                let apart_s: f64 = time_s[i] - time_s[k];
                slow.sd * slow.sd * (-apart_s.abs() / slow.slow_s).exp()
                    + slow.pulse.powi(2) * (-apart_s.abs() / BEATS_S).exp() * (TAU * slow.hz * apart_s).cos()
                    + if i == k { 1.0 } else { 0.0 }
            });
            let factored = covariance.cholesky().unwrap();
            let series = nalgebra::DVector::from_row_slice(&series);
            assert!((sum - series.dot(&factored.solve(&series))).abs() <= 1e-9 * sum, "{slow:?}");
            assert!((noise.ln_det - factored.determinant().ln()).abs() <= 1e-9, "{slow:?}");
        }
    }
}
