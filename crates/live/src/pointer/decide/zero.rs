//! The zero of the shear: what is predicted of a finger that touches nothing.
//!
//! A finger in the air has no shear, whatever is predicted (|F_r| <= mu N, and N is 0); while it touches, shear is
//! intended motion and must not be taken for a zero. So the zero is set only while the finger does not touch: each
//! `zero_window_s` of that makes a mean, and the zero follows the means with the time constant `zero_time_s`. A finger
//! that bends to scroll is left out, and so is a window in which it pressed, on average, half of what ends a touch: it
//! may rest too lightly to count as touching, and have shear.

use super::super::config::Config;

/// The zero, and the mean that is being made.
#[derive(Debug, Clone, Copy)]
pub(super) struct Zero {
    /// N; none before the first mean.
    at_n: Option<[f64; 2]>,
    lifted_s: Option<f64>,
    began_s: Option<f64>,
    sum_n: [f64; 2],
    pressing_sum_n: f64,
    count: f64,
}

impl Zero {
    pub(super) fn new() -> Self {
        Self { at_n: None, lifted_s: None, began_s: None, sum_n: [0.0; 2], pressing_sum_n: 0.0, count: 0.0 }
    }

    /// What counts as no shear, N.
    pub(super) fn at_n(&self) -> [f64; 2] {
        self.at_n.unwrap_or_default()
    }

    /// The finger touches, bends, or nothing is known of it: the mean that was being made is dropped.
    pub(super) fn stop(&mut self) {
        *self = Self { at_n: self.at_n, ..Self::new() };
    }

    /// A sample at `t_s` of a finger that does not touch: the zero, where it was set.
    pub(super) fn step(&mut self, config: &Config, t_s: f64, shear_n: [f64; 2], pressing_n: f64) -> Option<[f64; 2]> {
        let lifted_s = *self.lifted_s.get_or_insert(t_s);
        if !config.zero || t_s - lifted_s < config.zero_after_s {
            return None;
        }
        let began_s = *self.began_s.get_or_insert(t_s);
        if t_s - began_s >= config.zero_window_s {
            let set_n = self.mean_n(0.5 * config.touch_release_n).map(|mean_n| self.follow(config, mean_n));
            (self.began_s, self.sum_n, self.pressing_sum_n, self.count) = (Some(t_s), [0.0; 2], 0.0, 0.0);
            self.add(shear_n, pressing_n);
            return set_n;
        }
        self.add(shear_n, pressing_n);
        None
    }

    fn add(&mut self, shear_n: [f64; 2], pressing_n: f64) {
        self.sum_n = [self.sum_n[0] + shear_n[0], self.sum_n[1] + shear_n[1]];
        self.pressing_sum_n += pressing_n;
        self.count += 1.0;
    }

    /// The mean shear of the window; none where the finger pressed by `most_n` or more.
    fn mean_n(&self, most_n: f64) -> Option<[f64; 2]> {
        (self.pressing_sum_n / self.count < most_n).then(|| self.sum_n.map(|sum| sum / self.count))
    }

    fn follow(&mut self, config: &Config, mean_n: [f64; 2]) -> [f64; 2] {
        let share = -(-config.zero_window_s / config.zero_time_s).exp_m1();
        let before_n = self.at_n.unwrap_or(mean_n);
        let at_n = std::array::from_fn(|axis| before_n[axis] + share * (mean_n[axis] - before_n[axis]));
        self.at_n = Some(at_n);
        at_n
    }
}
