//! The pointer's way: shear to steps, what a click takes back, what a drag counts from.

use super::super::config::{Config, Mode};
use super::counts::Counts;
use super::gain;

/// Where the pointer is, and what may still be taken back of its way.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    counts: Counts,
    /// The way before the onset of what may become a click, px.
    onset_px: Option<[f64; 2]>,
    /// The shear from which a drag counts, N on the screen's axes.
    drag_n: [f64; 2],
    /// Position: the last place of the curve, px, and the way to it that the cap has left.
    place_px: Option<[f64; 2]>,
    behind_px: [f64; 2],
}

impl Motion {
    pub(super) fn new(take_back_s: f64) -> Self {
        Self { counts: Counts::new(take_back_s), onset_px: None, drag_n: [0.0; 2], place_px: None, behind_px: [0.0; 2] }
    }

    /// Where the pointer is, px from where it began.
    pub(super) fn place_px(&self) -> [f64; 2] {
        self.counts.place_px()
    }

    /// Whole counts to report; none where there are none.
    pub(super) fn whole(&mut self) -> Option<[i32; 2]> {
        self.counts.whole()
    }

    /// A finger that touches, with this shear on the screen's axes, `dt_s` after the last that moved or stayed.
    pub(super) fn go(&mut self, config: &Config, t_s: f64, dt_s: f64, shear_n: [f64; 2]) {
        let shear_n = minus(shear_n, self.drag_n);
        let step_px = match config.mode {
            Mode::Velocity => gain::velocity_px_per_s(config, shear_n).map(|speed| speed * dt_s),
            Mode::Position => {
                let place_px = gain::place_px(config, shear_n);
                let before_px = self.place_px.replace(place_px).filter(|_| dt_s > 0.0).unwrap_or(place_px);
                let step_px = minus(place_px, before_px);
                let behind_px = [self.behind_px[0] + step_px[0], self.behind_px[1] + step_px[1]];
                let step_px = gain::capped_px(config, behind_px, dt_s);
                self.behind_px = minus(behind_px, step_px);
                step_px
            }
        };
        self.counts.push(t_s, step_px);
    }

    /// The pointer is frozen, or the finger in the air: where it goes on, it goes on from where it is.
    pub(super) fn stay(&mut self) {
        (self.place_px, self.behind_px) = (None, [0.0; 2]);
    }

    /// What may become a click begins at `t_s`, or did not.
    pub(super) fn onset(&mut self, t_s: Option<f64>) {
        self.onset_px = t_s.map(|t_s| self.counts.recent_px(t_s));
    }

    /// A button turns at `t_s`: takes back the way before the onset, or before the turn where there was none. A drag
    /// ends.
    pub(super) fn take_back(&mut self, t_s: f64) {
        let moved_px = self.onset_px.take().unwrap_or_else(|| self.counts.recent_px(t_s));
        self.counts.take_back(moved_px);
        self.drag_n = [0.0; 2];
    }

    /// A drag begins with this shear, N on the screen's axes.
    pub(super) fn drag(&mut self, shear_n: [f64; 2]) {
        self.drag_n = shear_n;
    }

    /// What came before is not known any more: nothing of it is taken back.
    pub(super) fn forget(&mut self) {
        self.counts.forget_recent();
        (self.onset_px, self.drag_n) = (None, [0.0; 2]);
        self.stay();
    }
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
