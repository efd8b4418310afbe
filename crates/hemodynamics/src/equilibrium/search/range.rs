//! Ranges of numbers by their ends, products and sums of them with a margin for rounding.

/// The part of the magnitudes in a sum by which rounding may move it: 18 roundings.
pub(super) const ROUNDING: f64 = 4e-15;

#[derive(Clone, Copy, Default)]
pub(super) struct Sum {
    least: f64,
    most: f64,
    magnitude: f64,
}

impl Sum {
    pub(super) fn add(&mut self, factor: f64, range: [f64; 2]) {
        let [least, most] = product([factor; 2], range);
        self.least += least;
        self.most += most;
        let size = least.abs().max(most.abs());
        self.magnitude += if size.is_finite() { size } else { 0.0 };
    }

    /// Wider by its rounding.
    pub(super) fn range(&self) -> [f64; 2] {
        [self.least - ROUNDING * self.magnitude, self.most + ROUNDING * self.magnitude]
    }

    pub(super) fn keeps_its_sign(&self) -> bool {
        let [least, most] = self.range();
        least > 0.0 || most < 0.0
    }
}

/// The least and the greatest product of numbers out of two ranges; 0 times an infinite end has no part in it, as the
/// range's other products bound what it goes to.
pub(super) fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    let all = [a * c, a * d, b * c, b * d];
    [all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}
