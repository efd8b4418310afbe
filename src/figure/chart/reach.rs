//! How far the axes of a chart reach.

/// What is beyond is drawn here: no arithmetic overflows.
const FARTHEST: f64 = 1e200;

/// The least width of an axis.
const NARROWEST: f64 = 1e-200;

/// A place on the axes, not too far away to be drawn.
pub(super) fn near(x: f64, y: f64) -> (f64, f64) {
    (x.clamp(-FARTHEST, FARTHEST), y.clamp(-FARTHEST, FARTHEST))
}

/// Lowest and highest x and y.
#[derive(Debug, Default)]
pub(super) struct Reach {
    pub(super) x: Extent,
    pub(super) y: Extent,
}

impl Reach {
    pub(super) fn take(&mut self, [x, y]: [f64; 2]) {
        self.x.take(x);
        self.y.take(y);
    }

    /// Makes both axes reach as far as each of them.
    pub(super) fn square(&mut self) {
        let (x, y) = (self.x.0, self.y.0);
        x.into_iter().chain(y).for_each(|(low, high)| {
            self.take([low; 2]);
            self.take([high; 2]);
        });
    }
}

/// Lowest and highest value, if there is one.
#[derive(Debug, Default)]
pub(super) struct Extent(Option<(f64, f64)>);

impl Extent {
    pub(super) fn take(&mut self, value: f64) {
        if value.is_finite() {
            let value = value.clamp(-FARTHEST, FARTHEST);
            let (low, high) = self.0.unwrap_or((value, value));
            self.0 = Some((low.min(value), high.max(value)));
        }
    }

    /// The axis' ends: some room on both sides, and a width even for a single value; 0 to 1 for none.
    pub(super) fn padded(&self, below: f64, above: f64) -> (f64, f64) {
        let Some((low, high)) = self.0 else { return (0.0, 1.0) };
        let size = high.abs().max(low.abs());
        let width = if high - low > (1e-9 * size).max(NARROWEST) {
            high - low
        } else if size > NARROWEST {
            size.min(1.0_f64.max(1e-9 * size))
        } else {
            1.0
        };
        // What has no width stands in the middle.
        let aside = 0.5 * (width - (high - low));
        (low - aside - below * width, high + aside + above * width)
    }
}
