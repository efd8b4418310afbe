//! What noise alone makes a switch do: Rice's formula.
//!
//! A Gaussian error of standard deviation s that goes up through zero n times a second goes up through a level u
//! n exp(-u^2 / 2 s^2) times a second (Rice 1945, DOI 10.1002/j.1538-7305.1945.tb00453.x). Only distance from the noise
//! helps: at 3 s it makes 42 false switches an hour where n is 1.05 a second, at 4 s 1.3.

use serde::Serialize;

/// How fast and how large an error is while nothing presses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NoiseRate {
    /// Mean, N.
    pub mean_n: f64,
    /// Standard deviation, N.
    pub sd_n: f64,
    /// How often a second it goes up through its mean.
    pub up_hz: f64,
}

/// How often an hour a Gaussian error goes up through a level.
#[must_use]
pub fn crossings_per_hour(noise: NoiseRate, level_n: f64) -> f64 {
    let away = (level_n - noise.mean_n) / noise.sd_n;
    3600.0 * noise.up_hz * (-0.5 * away * away).exp()
}

impl NoiseRate {
    /// Of values that follow each other in time, gaps as NaN; `seconds` is the time that they take. None of less than
    /// two values, or of values without any difference.
    #[must_use]
    pub fn of(values: &[f64], seconds: f64) -> Option<Self> {
        let known = || values.iter().copied().filter(|value| value.is_finite());
        let count = known().count() as f64;
        if count < 2.0 || seconds.is_nan() || seconds <= 0.0 {
            return None;
        }
        let mean_n = known().sum::<f64>() / count;
        let sd_n = (known().map(|value| (value - mean_n).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
        let ups = values.windows(2).filter(|pair| pair[0] < mean_n && pair[1] >= mean_n).count() as f64;
        (sd_n > 0.0).then_some(Self { mean_n, sd_n, up_hz: ups / seconds })
    }
}
