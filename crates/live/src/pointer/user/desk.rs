//! A pointer whose finger a sensor feels, sample by sample.

use super::RATE_HZ;
use super::hand::Hand;
use crate::pointer::{Config, Pointer, What};

/// The finger is in the air for so long at the beginning, s: the zero is set.
pub(super) const LIFTED_S: f64 = 3.0;

/// A pointer with its sensor, and what it did.
pub(super) struct Desk<S> {
    pointer: Pointer,
    sensor: S,
    samples: u64,
    /// Where the pointer is: the sum of its moves, counts.
    pub(super) at: [i64; 2],
    /// Counts to the sides and up and down, all taken as positive.
    pub(super) counts: u64,
}

impl<S: FnMut(f64, [f64; 3]) -> [f64; 3]> Desk<S> {
    /// As it is after the time in the air.
    pub(super) fn new(config: &Config, sensor: S) -> Self {
        let mut desk = Self { pointer: Pointer::new(*config), sensor, samples: 0, at: [0; 2], counts: 0 };
        while desk.t_s() < LIFTED_S {
            desk.feel([0.0; 3]);
        }
        desk
    }

    pub(super) fn t_s(&self) -> f64 {
        self.samples as f64 / RATE_HZ
    }

    /// One sample; where it clicked, if it did.
    pub(super) fn feel(&mut self, force_n: [f64; 3]) -> Option<[i64; 2]> {
        let t_s = self.t_s();
        self.samples += 1;
        let [fx_n, fy_n, fz_n] = (self.sensor)(t_s, force_n);
        let (at, counts, mut click) = (&mut self.at, &mut self.counts, None);
        self.pointer.sample(t_s, fx_n, fy_n, fz_n, None, true, &mut |event| match event.what {
            What::Move { dx, dy } => {
                *at = [at[0] + i64::from(dx), at[1] + i64::from(dy)];
                *counts += u64::from(dx.unsigned_abs()) + u64::from(dy.unsigned_abs());
            }
            What::Button { down: true, .. } => click = Some(*at),
            _ => {}
        });
        click
    }

    /// A hand that does not move, until then; where it clicked.
    pub(super) fn hold(&mut self, hand: &mut Hand, until_s: f64) -> Vec<[i64; 2]> {
        let mut clicks = Vec::new();
        while self.t_s() < until_s {
            let force_n = hand.force_n(self.t_s(), [0.0; 2]);
            clicks.extend(self.feel(force_n));
        }
        clicks
    }
}
