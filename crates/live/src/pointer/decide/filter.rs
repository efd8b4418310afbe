//! The one-euro low-pass of the shear (Casiez, Roussel and Vogel 2012, DOI 10.1145/2207676.2208639): slow while the
//! force is steady, where noise shows, fast while it changes, where lag shows.
//!
//! f_c = f_c,min + beta |dX^/dt|, alpha = 1 / (1 + tau / T_e), tau = 1 / (2 pi f_c). Departure: the source filters each
//! axis by itself; here both have the cut-off of the rate's magnitude, so that no direction lags behind another.

use std::f64::consts::TAU;

/// The cut-off of the rate, Hz (the source's).
const RATE_CUTOFF_HZ: f64 = 1.0;

/// The filter of a pair of forces, newtons.
#[derive(Debug, Clone, Copy)]
pub(super) struct OneEuro {
    min_cutoff_hz: f64,
    beta: f64,
    /// The filtered force and its filtered rate, N/s; none before the first force.
    state: Option<([f64; 2], [f64; 2])>,
}

impl OneEuro {
    pub(super) fn new(min_cutoff_hz: f64, beta: f64) -> Self {
        Self { min_cutoff_hz, beta, state: None }
    }

    /// Forgets what came before.
    pub(super) fn reset(&mut self) {
        self.state = None;
    }

    /// The force filtered; it came `dt_s` after the one before, seconds, above 0 but for the first.
    pub(super) fn step(&mut self, force_n: [f64; 2], dt_s: f64) -> [f64; 2] {
        let Some((before_n, rate_before)) = self.state else {
            self.state = Some((force_n, [0.0; 2]));
            return force_n;
        };
        let of_rate = alpha(RATE_CUTOFF_HZ, dt_s);
        let rate: [f64; 2] = std::array::from_fn(|axis| {
            rate_before[axis] + of_rate * ((force_n[axis] - before_n[axis]) / dt_s - rate_before[axis])
        });
        let of_force = alpha(self.min_cutoff_hz + self.beta * rate[0].hypot(rate[1]), dt_s);
        let filtered: [f64; 2] =
            std::array::from_fn(|axis| before_n[axis] + of_force * (force_n[axis] - before_n[axis]));
        self.state = Some((filtered, rate));
        filtered
    }
}

/// The share of the newest value.
fn alpha(cutoff_hz: f64, dt_s: f64) -> f64 {
    1.0 / (1.0 + 1.0 / (TAU * cutoff_hz * dt_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of some hundred steps; measured 3e-16.
    const NEAR: f64 = 1e-12;

    #[test]
    fn without_beta_it_is_the_first_order_low_pass() {
        let mut filter = OneEuro::new(1.5, 0.0);
        filter.step([0.0, 1.0], 0.01);
        let (mut naive, to) = ([0.0, 1.0], [1.0, -1.0]);
        for _ in 0..200 {
            let got = filter.step(to, 0.01);
            let tau = 1.0 / (2.0 * std::f64::consts::PI * 1.5);
            let a = 1.0 / (1.0 + tau / 0.01);
            naive = [a * to[0] + (1.0 - a) * naive[0], a * to[1] + (1.0 - a) * naive[1]];
            assert!((0..2).all(|k| (got[k] - naive[k]).abs() <= NEAR), "{got:?} {naive:?}");
        }
    }

    #[test]
    fn fast_changes_lag_less_and_all_directions_alike() {
        let after = |beta: f64, to: [f64; 2]| {
            let mut filter = OneEuro::new(1.0, beta);
            filter.step([0.0; 2], 0.01);
            (0..5).map(|_| filter.step(to, 0.01)).last().unwrap()
        };
        let (slow, fast) = (after(0.0, [1.0, 0.0])[0], after(2.0, [1.0, 0.0])[0]);
        assert!(fast > 1.5 * slow, "{fast} {slow}");
        let slant = after(2.0, [0.6, 0.8]);
        assert!((slant[0].hypot(slant[1]) - fast).abs() <= NEAR, "{slant:?} {fast}");
    }
}
