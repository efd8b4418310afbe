//! One marker on its way: where it was, how it moves, how it looks.

use crate::posture::marker::fit::Fit;
use crate::posture::marker::looks::look::Look;
use crate::posture::marker::sight::Loss;

/// Motion is carried on for this many frames without a sight; then the marker is thought to stay.
const COASTING: u64 = 3;
/// ... and for this many that could not be decoded.
const COASTING_UNDECODED: u64 = 10;
/// How much of a new velocity is believed.
const VELOCITY_SHARE: f64 = 0.7;

/// A marker that is followed.
#[derive(Debug, Clone)]
pub(super) struct Target {
    /// How it looks; none if it has never been seen.
    pub(super) look: Option<Look>,
    /// Where it was when last seen, and the frame.
    pub(super) last: Option<([f64; 2], u64)>,
    pub(super) velocity_px: [f64; 2],
    /// Why it is not seen now.
    pub(super) loss: Loss,
    /// Seen in the frame at hand.
    pub(super) fit: Option<Fit>,
    /// Where it was expected in the frame at hand.
    pub(super) expected_px: [f64; 2],
    /// It was taken back in this frame: how it got here says nothing of its motion.
    pub(super) jumped: bool,
    /// Frames without a sight, but for those that could not be decoded.
    pub(super) absent: u64,
    /// Frames since the last sight that could not be decoded.
    undecoded: u64,
}

impl Target {
    pub(super) fn new(look: Option<Look>) -> Self {
        Self {
            look,
            last: None,
            velocity_px: [0.0; 2],
            loss: Loss::NotFound,
            fit: None,
            expected_px: [0.0; 2],
            jumped: false,
            absent: 0,
            undecoded: 0,
        }
    }

    /// Radius, for reaches.
    pub(super) fn radius_px(&self) -> f64 {
        self.look.as_ref().map_or(1.0, |look| look.radius_px)
    }

    pub(super) fn speed_px(&self) -> f64 {
        self.velocity_px[0].hypot(self.velocity_px[1])
    }

    /// Puts it where it is to be in frame `frame`, moving so.
    pub(super) fn place(&mut self, at_px: [f64; 2], velocity_px: [f64; 2], frame: u64) {
        self.last = Some((at_px, frame));
        self.velocity_px = velocity_px;
        self.absent = 0;
    }

    /// Where it should be in frame `frame`, if it was ever seen.
    pub(super) fn expect(&mut self, frame: u64) {
        self.fit = None;
        self.jumped = false;
        if let Some((at, seen)) = self.last {
            let gap = frame.saturating_sub(seen);
            self.undecoded = gap.saturating_sub(self.absent + 1).min(COASTING_UNDECODED);
            let ahead = ((self.absent + 1).min(COASTING).min(gap) + self.undecoded) as f64;
            self.expected_px = [0, 1].map(|axis| at[axis] + ahead * self.velocity_px[axis]);
        }
    }

    /// How far from where it is expected it can well be.
    pub(super) fn reach_px(&self) -> f64 {
        let absent = (self.absent + self.undecoded).min(20) as f64;
        1.5 * self.radius_px() + 4.0 + 0.7 * self.speed_px() + 0.5 * self.radius_px() * absent
    }

    /// Takes over the fit of this frame.
    pub(super) fn keep(&mut self, frame: u64) {
        let Some(fit) = &self.fit else {
            self.absent += 1;
            return;
        };
        let at = fit.centre.at_px;
        match self.last {
            Some((before, seen)) if !self.jumped && frame > seen && frame - seen <= 2 * COASTING => {
                let frames = (frame - seen) as f64;
                for axis in 0..2 {
                    let velocity = (at[axis] - before[axis]) / frames;
                    self.velocity_px[axis] += VELOCITY_SHARE * (velocity - self.velocity_px[axis]);
                }
            }
            Some((_, seen)) if !self.jumped && frame == seen => {}
            _ => self.velocity_px = [0.0; 2],
        }
        self.last = Some((at, frame));
        self.absent = 0;
        if let Some(look) = &mut self.look {
            look.update(fit);
        }
    }

    /// It is not what was thought.
    pub(super) fn drop(&mut self, loss: Loss) {
        self.fit = None;
        self.loss = loss;
    }
}
