//! The tie's share of a label's error.
//!
//! In: a joint's [`Curve`], the [`Tie`], and a label. Out: the expected square of what the tie's error changes the
//! label by, that error being normal with standard deviation s. With rate r and second derivative a it is
//! r^2 s^2 + 3/4 a^2 s^4: the second share is all that there is where the joint turns round.
//!
//! The second derivative is taken from the second difference over `REACH` s, to which the frames' noise adds no more
//! than half their variance, not from the polynomial between two frames, where noise is multiplied by the squared frame
//! rate. A motion that repeats itself after just that time comes back to the same angle, so the larger of it and the
//! one over 0.6 of the time counts: both are whole periods from five and three on.

use super::curve::{Between, Curve};
use crate::align::Tie;

/// The second difference's step, in standard errors of the tie: its square over 12 is then 3/4 a^2 s^4.
const REACH: f64 = 1.732_050_807_568_877_2;
/// Steps of the second differences, as shares of `REACH`.
const STEPS: [f64; 2] = [1.0, 0.6];

/// The tie's share of the errors of a joint's labels.
#[derive(Debug)]
pub(super) struct TieShare<'a> {
    tie: &'a Tie,
    /// For each step the curve before and after the label: each is asked at times that ascend.
    around: [[Curve; 2]; 2],
    /// Mean square of the joint's second derivative.
    bend2: f64,
}

impl<'a> TieShare<'a> {
    pub(super) fn new(tie: &'a Tie, curve: &Curve) -> Self {
        let around = STEPS.map(|_| [curve.clone(), curve.clone()]);
        Self { tie, around, bend2: curve.bend2() }
    }

    /// The share's square at a label.
    pub(super) fn deg2(&mut self, video_s: f64, label: &Between) -> f64 {
        let sd_s = self.tie.timebase.sd_s(video_s) / (1.0 + self.tie.timebase.drift);
        // A sure tie asks for no rate.
        if sd_s == 0.0 {
            return 0.0;
        }
        let [whole, part] = [0, 1].map(|k| self.second_difference(k, video_s, REACH * STEPS[k] * sd_s, label.deg));
        let bend = match whole.zip(part) {
            Some((whole, part)) => whole.abs().max(part.abs()).powi(2) / 12.0,
            // A gap or an end of the video is near.
            None => 0.75 * self.bend2 * sd_s.powi(4),
        };
        (sd_s * label.rate_deg_s).powi(2) + bend
    }

    /// None where there is no angle a step before or after the label.
    fn second_difference(&mut self, k: usize, video_s: f64, step_s: f64, deg: f64) -> Option<f64> {
        let [before, after] = &mut self.around[k];
        let [before, after] = [before.at(video_s - step_s).ok()?, after.at(video_s + step_s).ok()?];
        Some(before.deg + after.deg - 2.0 * deg)
    }
}
