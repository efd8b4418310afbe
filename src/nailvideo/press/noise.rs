//! What a trace does beside its course: white noise, and first-order noise of an encoder, of the pulse (about 1 Hz) or
//! of the blood's slow waves (vasomotion, about 0.1 Hz), whichever is likeliest.
//!
//! Where a trace has such waves and only white noise is assumed, a course bends along with them: in the pulse and the
//! waves of real blood (`tests::real_data`) t90's interval held the truth in 36 to 66 %, so in 91 to 95 %. The price:
//! of blood a part of which comes back more slowly t90 is 5 to 16 % short in place of 1 to 9 %, within its interval, as
//! slow waves may look like that.

/// Time constants that are tried, seconds.
const SLOW_S: [f64; 3] = [0.05, 0.5, 2.5];
/// SDs that are tried, in that of the white noise.
const SDS: [f64; 7] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
/// From such a time constant on, the blood's waves.
const WAVES_S: f64 = 1.0;
/// Waves are smoother than first-order noise, whose size is that of its steps: their SD is enlarged by this
/// (chosen on traces with waves of a period of 10 s, so that intervals hold them).
const SMOOTHER: f64 = 1.5;

/// The noise that comes with white noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slow {
    /// Its SD, in that of the white noise.
    sd: f64,
    /// Its time constant, seconds.
    slow_s: f64,
}

impl Slow {
    pub(super) const NONE: Self = Self { sd: 0.0, slow_s: 1.0 };

    /// What is tried.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        let some = SLOW_S.into_iter().flat_map(|slow_s| SDS.map(|sd| Self { sd, slow_s }));
        std::iter::once(Self::NONE).chain(some)
    }

    /// As large as it may be where it was the likeliest.
    pub(super) fn enlarged(self) -> Self {
        if self.slow_s >= WAVES_S { Self { sd: SMOOTHER * self.sd, ..self } } else { self }
    }
}

/// White and slow noise over times: the Kalman filter that predicts each sample from those before.
#[derive(Debug)]
pub(super) struct Noise {
    pub(super) steps: Vec<Prediction>,
    /// The logarithm of the determinant of its covariance in the variance of the white noise.
    pub(super) ln_det: f64,
}

/// How a sample is predicted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prediction {
    /// What is left of the slow noise at the sample before.
    carry: f64,
    /// What is learned from this one.
    gain: f64,
    /// By what the error of the prediction is white.
    scale: f64,
}

impl Noise {
    pub(super) fn new(time_s: &[f64], slow: Slow) -> Self {
        let whole = slow.sd * slow.sd;
        let (mut variance, mut before_s, mut ln_det) = (whole, f64::NEG_INFINITY, 0.0);
        let steps = time_s.iter().map(|&t| {
            let carry = ((before_s - t) / slow.slow_s).exp();
            let ahead = whole + carry * carry * (variance - whole);
            let of_error = ahead + 1.0;
            (before_s, variance) = (t, ahead / of_error);
            ln_det += of_error.ln();
            Prediction { carry, gain: ahead / of_error, scale: of_error.sqrt().recip() }
        });
        let steps = steps.collect();
        Self { steps, ln_det }
    }
}

/// The slow noise as it is known from a series so far.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Level(f64);

impl Level {
    /// The error of the prediction of the next value of the series, white where the series is such noise.
    #[inline]
    pub(super) fn error(&mut self, value: f64, by: Prediction) -> f64 {
        let ahead = by.carry * self.0;
        let error = value - ahead;
        self.0 = ahead + by.gain * error;
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
        for slow in Slow::all().map(Slow::enlarged) {
            let noise = Noise::new(&time_s, slow);
            let mut level = Level::default();
            let sum: f64 =
                series.iter().zip(&noise.steps).map(|(value, step)| level.error(*value, *step).powi(2)).sum();
            let covariance = DMatrix::from_fn(6, 6, |i, k| {
                let apart_s: f64 = time_s[i] - time_s[k];
                slow.sd * slow.sd * (-apart_s.abs() / slow.slow_s).exp() + if i == k { 1.0 } else { 0.0 }
            });
            let factored = covariance.cholesky().unwrap();
            let series = nalgebra::DVector::from_row_slice(&series);
            assert!((sum - series.dot(&factored.solve(&series))).abs() <= 1e-9 * sum, "{slow:?}");
            assert!((noise.ln_det - factored.determinant().ln()).abs() <= 1e-9, "{slow:?}");
        }
    }
}
