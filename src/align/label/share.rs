//! The tie's share of a label's error, and the row's own stamp's.
//!
//! In: a joint's [`Curve`], the [`Tie`], and a label. Out: the expected square of what the tie's error changes the
//! label by, that error being normal with standard deviation s. With rate r and second derivative a it is
//! r^2 s^2 + 3/4 a^2 s^4: the second share is all that there is where the joint turns round.
//!
//! The second derivative is taken from the second difference over `REACH` s, to which the frames' noise adds no more
//! than half their variance, not from the polynomial between two frames, where noise is multiplied by the squared frame
//! rate; the rate from the first difference over 0.6 of it, about s, for the same reason. A motion that repeats itself
//! after just that time comes back to the same angle, so the larger of it and the one over 0.6 of the time counts: both
//! are whole periods from five and three on.

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
    /// How far a row's own stamp may be off, seconds.
    stamp_sd_s: f64,
    /// For each step the curve before and after the label: each is asked at times that ascend.
    around: [[Curve; 2]; 2],
    /// Mean square of the joint's second derivative.
    bend2: f64,
    /// From the joint's least angle to its greatest, which no error of a time exceeds.
    range_deg: f64,
}

impl<'a> TieShare<'a> {
    pub(super) fn new(tie: &'a Tie, curve: &Curve, stamp_sd_s: f64) -> Self {
        let around = STEPS.map(|_| [curve.clone(), curve.clone()]);
        Self { tie, stamp_sd_s, around, bend2: curve.bend2(), range_deg: curve.range_deg() }
    }

    /// The share's square at a label.
    pub(super) fn deg2(&mut self, video_s: f64, label: &Between) -> f64 {
        let sd_s = self.tie.timebase.sd_s(video_s).hypot(self.stamp_sd_s) / (1.0 + self.tie.timebase.drift);
        // A sure tie asks for no rate.
        if sd_s == 0.0 {
            return 0.0;
        }
        match [0, 1].map(|k| self.around(k, video_s, REACH * STEPS[k] * sd_s)) {
            [Some(whole), Some(part)] => {
                let [whole_bend, part_bend] = [whole, part].map(|[before, after]| before + after - 2.0 * label.deg);
                let slope = (part[1] - part[0]) / (2.0 * REACH * STEPS[1]);
                slope * slope + whole_bend.abs().max(part_bend.abs()).powi(2) / 12.0
            }
            // A gap or an end of the video is near.
            _ => {
                let share = (sd_s * label.rate_deg_s).powi(2) + 0.75 * self.bend2 * sd_s.powi(4);
                // Where no rate is known, none is made up.
                if share > self.range_deg.powi(2) { self.range_deg.powi(2) } else { share }
            }
        }
    }

    /// The angles a step before the label and after it, where both are known.
    fn around(&mut self, k: usize, video_s: f64, step_s: f64) -> Option<[f64; 2]> {
        let [before, after] = &mut self.around[k];
        Some([before.at(video_s - step_s).ok()?.deg, after.at(video_s + step_s).ok()?.deg])
    }
}
