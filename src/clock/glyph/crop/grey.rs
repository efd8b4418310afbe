//! A picture of ink alone: the ground taken away, and with it slow changes of light and what lies along the border.

use crate::video::Plane;

/// Pictures are reduced to about this many samples a side.
const WORKING: usize = 96;
/// Smallest side of a picture that is looked at.
const LEAST: usize = 16;
/// No stroke is broader than this share of the picture's shorter side.
const STROKE: f32 = 0.3;
/// What is narrower than this is ink rather than background, as a share of the same.
const FINE: f32 = 0.2;
/// Ink differs from the background by at least this much, on the scale of 8 bits.
const LEAST_CONTRAST: f32 = 10.0;
/// Grounds that differ by more than this share of the contrast are two.
const EDGE: f32 = 0.3;
/// What full ink is worth on the flattened picture.
pub(super) const FULL: f32 = 200.0;

/// A picture of values.
pub(super) struct Grey {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) values: Vec<f32>,
}

impl Grey {
    /// Means of blocks of samples; none where the picture is too small.
    pub(super) fn reduced(plane: &Plane<'_>) -> Option<Self> {
        let least = plane.width.min(plane.height);
        if least < LEAST {
            return None;
        }
        let step = (least / WORKING).max(1);
        let (width, height) = (plane.width / step, plane.height / step);
        let mean = |k: usize| {
            let (x, y) = (k % width * step, k / width * step);
            let sum: f32 = (0..step * step).map(|i| plane.sample(x + i % step, y + i / step)).sum();
            sum / (step * step) as f32
        };
        Some(Self { width, height, values: (0..width * height).map(mean).collect() })
    }

    /// The largest value (smallest, if not `largest`) so far along rows and columns. Windows that are `whole` are moved
    /// inwards at the border instead of cut off, so that a stroke at the border is filled too.
    fn extreme(&self, reach: [usize; 2], largest: bool, whole: bool) -> Self {
        let pick = |values: &mut dyn Iterator<Item = f32>| {
            if largest { values.fold(f32::NEG_INFINITY, f32::max) } else { values.fold(f32::INFINITY, f32::min) }
        };
        let (width, height) = (self.width, self.height);
        let window = |at: usize, reach: usize, count: usize| {
            let last = count - 1;
            let (before, after) =
                if whole { (reach.saturating_sub(last - at), reach.saturating_sub(at)) } else { (0, 0) };
            (at.saturating_sub(reach + before), (at + reach + after).min(last))
        };
        let rows: Vec<f32> = (0..width * height)
            .map(|k| {
                let (x, row) = (k % width, k - k % width);
                let (from, to) = window(x, reach[0], width);
                pick(&mut self.values[row + from..=row + to].iter().copied())
            })
            .collect();
        let values = (0..width * height)
            .map(|k| {
                let (x, y) = (k % width, k / width);
                let (from, to) = window(y, reach[1], height);
                pick(&mut (from..=to).map(|y| rows[y * width + x]))
            })
            .collect();
        Self { width, height, values }
    }

    /// The picture without what is darker (lighter, if not `dark`) than its surroundings and narrower than a share of
    /// the picture.
    fn filled(&self, narrower: f32, dark: bool) -> Self {
        let reach = (narrower * self.width.min(self.height) as f32 / 2.0).round().max(1.0) as usize;
        self.extreme([reach; 2], dark, true).extreme([reach; 2], !dark, false)
    }

    /// Whether ink is darker than the background: of dark and light, ink is what is narrow.
    pub(super) fn is_dark_on_light(&self) -> bool {
        let (aside, below) = (self.width / 10, self.height / 10);
        let narrow = |dark: bool| {
            let ground = self.filled(FINE, dark);
            let inner = (below..self.height - below).flat_map(|y| (aside..self.width - aside).map(move |x| (x, y)));
            let apart =
                |(x, y): (usize, usize)| (self.values[y * self.width + x] - ground.values[y * self.width + x]).abs();
            inner.map(apart).sum::<f32>()
        };
        narrow(true) >= narrow(false)
    }

    /// Ink alone: 0 on the background, [`FULL`] where ink is full; none where there is hardly a difference.
    pub(super) fn flattened(&self, dark: bool) -> Option<Self> {
        let mut ground = self.filled(STROKE, dark);
        // What is dark along a whole row is ground, too: a shadow across the picture.
        let rows = self.extreme([self.width, 0], dark, false);
        for (value, other) in ground.values.iter_mut().zip(&rows.values) {
            *value = if dark { value.min(*other) } else { value.max(*other) };
        }
        let sign = if dark { 1.0 } else { -1.0 };
        let differences: Vec<f32> =
            self.values.iter().zip(&ground.values).map(|(value, ground)| sign * (ground - value)).collect();
        let mut sorted = differences.clone();
        sorted.sort_by(f32::total_cmp);
        // At the least a fiftieth is ink, and its darkest half tells how dark it is.
        let full = sorted[sorted.len() - 1 - sorted.len() / 40];
        let scale = FULL / full;
        (full >= LEAST_CONTRAST).then(|| Self {
            width: self.width,
            height: self.height,
            values: differences.iter().map(|d| d * scale).collect(),
        })
    }

    /// Whether a narrow box is an edge between two grounds, as a display's frame is, and no `1`: the picture left of it
    /// differs from the picture right of it.
    pub(super) fn is_edge(&self, &[x0, y0, x1, y1]: &[usize; 4]) -> bool {
        let (wide, tall) = (x1 - x0 + 1, y1 - y0 + 1);
        let aside = (wide / 4).max(2);
        if 2 * wide > tall || x0 < 2 || x1 + 2 >= self.width {
            return false;
        }
        let middle = |x: usize| {
            let mut column: Vec<f32> = (y0..=y1).map(|y| self.values[y * self.width + x]).collect();
            column.sort_by(f32::total_cmp);
            column[column.len() / 2]
        };
        let inside = (x0..=x1).map(middle).collect::<Vec<_>>();
        let (left, right) = (middle(x0.saturating_sub(aside)), middle((x1 + aside).min(self.width - 1)));
        let contrast = inside.iter().map(|m| (m - left).abs().max((m - right).abs())).fold(0.0, f32::max);
        (left - right).abs() > EDGE * contrast
    }
}
