//! A picture of ink alone: the ground taken away, and with it slow changes of light and what lies along the border.

use crate::median::median_of;
use crate::video::Plane;
use crate::vision::{Extreme, Samples, extreme};

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
        let &Plane { width, height, stride, depth, data } = plane;
        let samples = Samples { width, height, stride, depth, data, quarters: 0 };
        let (width, height) = (width / step, height / step);
        Some(Self { width, height, values: samples.means([0, 0], [width, height], step) })
    }

    /// The picture without what is darker (lighter, if not `dark`) than its surroundings and narrower than a share of
    /// the picture. Windows are moved inwards at the border at first, so that a stroke there is filled too.
    fn filled(&self, narrower: f32, dark: bool) -> Vec<f32> {
        let size = [self.width, self.height];
        let reach = (narrower * self.width.min(self.height) as f32 / 2.0).round().max(1.0) as usize;
        let wide = extreme(&self.values, size, Extreme { reach, largest: dark, whole: true });
        extreme(&wide, size, Extreme { reach, largest: !dark, whole: false })
    }

    /// Whether ink is darker than the background: of dark and light, ink is what is narrow.
    pub(super) fn is_dark_on_light(&self) -> bool {
        let (aside, below) = (self.width / 10, self.height / 10);
        let narrow = |dark: bool| {
            let ground = self.filled(FINE, dark);
            let inner = (below..self.height - below).flat_map(|y| (aside..self.width - aside).map(move |x| (x, y)));
            let apart = |(x, y): (usize, usize)| (self.values[y * self.width + x] - ground[y * self.width + x]).abs();
            inner.map(apart).sum::<f32>()
        };
        narrow(true) >= narrow(false)
    }

    /// Ink alone: 0 on the background, [`FULL`] where ink is full; none where there is hardly a difference.
    pub(super) fn flattened(&self, dark: bool) -> Option<Self> {
        let mut ground = self.filled(STROKE, dark);
        // What is dark along a whole row is ground, too: a shadow across the picture.
        for (ground, row) in ground.chunks_exact_mut(self.width).zip(self.values.chunks_exact(self.width)) {
            let most = row.iter().copied().reduce(if dark { f32::max } else { f32::min }).unwrap_or_default();
            ground.iter_mut().for_each(|value| *value = if dark { value.min(most) } else { value.max(most) });
        }
        let sign = if dark { 1.0 } else { -1.0 };
        let differences: Vec<f32> =
            self.values.iter().zip(&ground).map(|(value, ground)| sign * (ground - value)).collect();
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
        let middle = |x: usize| median_of((y0..=y1).map(|y| self.values[y * self.width + x])).unwrap_or(f32::NAN);
        let inside = (x0..=x1).map(middle).collect::<Vec<_>>();
        let (left, right) = (middle(x0.saturating_sub(aside)), middle((x1 + aside).min(self.width - 1)));
        let contrast = inside.iter().map(|m| (m - left).abs().max((m - right).abs())).fold(0.0, f32::max);
        (left - right).abs() > EDGE * contrast
    }
}
