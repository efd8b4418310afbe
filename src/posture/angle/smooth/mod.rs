//! Smoothing of a joint's angle over a whole video, for those who ask for it.
//!
//! In: frame times and one joint's angles with their standard errors; out: the same rows, smoothed, with standard
//! errors that hold. A missing angle stays missing. Fewer than eight known angles stay as they are.
//!
//! The angle's third derivative is taken as white noise (the integrated Wiener process of Wecker and Ansley 1983,
//! doi:10.1080/01621459.1983.10477935), over the true times. The errors of neighbouring frames are
//! alike, since a codec hands on what it did to the last frame; a smoother that does not know that promises too much.
//! So an error is in part a first-order autoregression, in part white, and its size the given standard error times a
//! common scale. The process' strength, the correlation, its share and the scale are those of the greatest likelihood,
//! with weak priors; the scale is never below 1. Smoothing is the fixed interval one of Rauch, Tung and Striebel (1965,
//! doi:10.2514/3.3166) in Bierman's form (1973, doi:10.1080/00207177308932487), which inverts no matrix. An angle that
//! no motion explains is left out of it, and missing where its neighbours don't say it either.

mod filter;
mod fit;

use super::joints::Angle;
use crate::median::median_of;
use filter::{Observation, Parameters};

/// Where more angles are left out than these, or than this share, the motion is none that is known, and the series
/// stays as it is: joints that turn within few frames are taken for joints at rest (measured on phantoms that bend at 1
/// to 3 Hz, filmed at 10 to 30 frames a second: 3 to 15 of 13 to 108 angles are left out then, and what takes their
/// place is up to 900 degrees off; in 29 videos of slower ones none is).
const MOST_LEFT_OUT: usize = 2;
const SHARE_LEFT_OUT: f64 = 0.01;
/// An angle that is left out is known by its neighbours where their standard error is at most so many times its own
/// (measured: 0.4 to 1.6 times for wild angles, one or two at a time, in a motion that is followed; 7 to 1000 where it
/// is not).
const KNOWN: f64 = 3.0;
/// Fewer known angles than this are left as they are.
const FEWEST: usize = 8;

/// A smoothed series and what was found of it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Smoothed {
    /// Missing where the given one is, and where neither a motion nor its neighbours say it.
    pub angles: Vec<Option<Angle>>,
    /// What the smoother took the series for; none where it was left as it is.
    pub model: Option<SmoothModel>,
    /// What of it is not smoothed, or not known, and what to do.
    pub doubt: Option<String>,
}

/// What the smoother took a series for.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct SmoothModel {
    /// Spectral density of the angle's third derivative.
    pub jerk_rad2_per_s5: f64,
    /// Correlation of the errors of frames a median frame's time apart, of their correlated part.
    pub error_correlation: f64,
    /// The share of the errors' variance that is correlated.
    pub correlated_share: f64,
    /// The errors over the given standard errors.
    pub error_scale: f64,
    /// Angles that no motion explains, in whose place their neighbours speak.
    pub left_out: usize,
}

/// Smooths one joint's angles at `times_s` (not decreasing).
#[must_use]
pub(crate) fn smooth(times_s: &[f64], angles: &[Option<Angle>]) -> Smoothed {
    let known: Vec<(usize, f64, Angle)> = times_s
        .iter()
        .zip(angles)
        .enumerate()
        .filter_map(|(row, (&time, angle))| angle.map(|a| (row, time, a)))
        .filter(|(_, time, a)| time.is_finite() && a.rad.is_finite() && a.sd_rad.is_finite())
        .collect();
    if known.len() < FEWEST {
        return Smoothed { angles: angles.to_vec(), model: None, doubt: None };
    }
    // In medians of the errors and of the time from row to row, all numbers are near 1.
    let unit_rad = median_of(known.iter().map(|(.., a)| passing_sd_rad(a))).unwrap_or(f64::NAN).max(SMALLEST_SD_RAD);
    let step_s = median_of(known.windows(2).map(|w| w[1].1 - w[0].1)).filter(|&step_s| step_s > 0.0).unwrap_or(1.0);
    let origin = known[0].1;
    let series: Vec<Observation> = known
        .iter()
        .map(|(_, time, a)| Observation {
            time: (time - origin) / step_s,
            value: a.rad / unit_rad,
            // Weights within a million of each other.
            sd: (passing_sd_rad(a) / unit_rad).clamp(1e-3, 1e3),
        })
        .collect();
    let half_turn = std::f64::consts::PI / unit_rad;
    let parameters = fit::fit(&series, half_turn);
    let smoothed = filter::smooth(&series, &parameters, half_turn);
    let left_out = smoothed.iter().filter(|row| row.left_out).count();
    if left_out > MOST_LEFT_OUT.max((SHARE_LEFT_OUT * known.len() as f64) as usize) {
        let doubt = format!(
            "its angles are not smoothed: {left_out} of {} are no part of a motion that smoothing knows; film more \
             frames a second for it, or leave --smooth out",
            known.len()
        );
        return Smoothed { angles: angles.to_vec(), model: None, doubt: Some(doubt) };
    }
    let (mut result, mut missing) = (vec![None; angles.len()], 0);
    for ((row, _, a), s) in known.iter().zip(&smoothed) {
        if s.left_out && s.sd * unit_rad > KNOWN * passing_sd_rad(a).max(SMALLEST_SD_RAD) {
            missing += 1;
            continue;
        }
        let lasting_sd_rad = a.lasting_sd_rad;
        let sd_rad = (s.sd * unit_rad).hypot(lasting_sd_rad);
        result[*row] = Some(Angle { rad: s.value * unit_rad, sd_rad, lasting_sd_rad });
    }
    let Parameters { jerk, correlation, share, scale } = parameters;
    let model = SmoothModel {
        jerk_rad2_per_s5: jerk * unit_rad.powi(2) / step_s.powi(5),
        error_correlation: correlation,
        correlated_share: share,
        error_scale: scale,
        left_out,
    };
    let doubt = (missing > 0).then(|| {
        format!(
            "{missing} angle(s) are missing: no motion that smoothing knows explains them, and their neighbours don't \
             say them; leave --smooth out to have them as they were measured"
        )
    });
    Smoothed { angles: result, model: Some(model), doubt }
}

/// An error of nothing (a drawn series, say) would make every other number infinite.
const SMALLEST_SD_RAD: f64 = 1e-9;

/// The part of a standard error that is another's in another frame: what smoothing makes smaller.
fn passing_sd_rad(angle: &Angle) -> f64 {
    (angle.sd_rad * angle.sd_rad - angle.lasting_sd_rad * angle.lasting_sd_rad).max(0.0).sqrt()
}

#[cfg(test)]
mod tests;
