//! The clock's screen in a frame: what it shows, averaged over the exposure, in its dark frame; or the sheet that
//! covers it.

use crate::phantom::video::draw::row::Row;
use crate::phantom::video::scene::Scene;
use crate::words::grouped;

/// A screen to be drawn.
pub(in crate::phantom::video) struct Screen {
    roi: [usize; 4],
    frame_px: usize,
    back: [f32; 3],
    front: [f32; 3],
    /// The lit shares; none: a sheet covers it.
    lit: Option<Vec<f32>>,
}

/// R'G'B' of the sheet: paper.
const SHEET: [f32; 3] = [0.80, 0.79, 0.76];

impl Screen {
    /// Moments of the exposure at which the screen is looked at.
    const LOOKS: usize = 16;

    /// The screen in an exposure of `exposure_s` about `time_s`.
    pub(in crate::phantom::video) fn new(scene: &Scene, frame: usize, time_s: f64, exposure_s: f64) -> Option<Self> {
        let clock = scene.options.clock.as_ref()?;
        let roi = scene.options.clock_roi_px(clock);
        let at = |look: usize| time_s + exposure_s * ((look as f64 + 0.5) / Self::LOOKS as f64 - 0.5);
        let texts = grouped((0..Self::LOOKS).map(|look| (clock.shown(at(look)).0, look)));
        let mut lit = vec![0.0; roi[2] * roi[3]];
        for (text, looks) in texts {
            let share = looks.len() as f32 / Self::LOOKS as f32;
            lit.iter_mut().zip(clock.panel(&text, roi[2], roi[3])).for_each(|(sum, one)| *sum += share * one);
        }
        let (back, front) = if clock.light_digits {
            ([0.05, 0.06, 0.07], [0.84, 0.95, 1.0])
        } else {
            ([0.78, 0.82, 0.76], [0.10, 0.12, 0.11])
        };
        let lit = (!scene.clock_hidden(frame)).then_some(lit);
        Some(Self { roi, frame_px: (scene.options.width / 100).max(2), back, front, lit })
    }

    pub(in crate::phantom::video) fn draw(&self, y: usize, row: &mut Row) {
        let [left, top, width, height] = self.roi;
        if y + self.frame_px < top || y >= top + height + self.frame_px {
            return;
        }
        let end = (left + width + self.frame_px).min(row.width());
        for x in left.saturating_sub(self.frame_px)..end {
            let Some(lit) = &self.lit else {
                row.mix(x, SHEET, 1.0);
                continue;
            };
            row.mix(x, [0.12, 0.12, 0.13], 1.0);
            if (left..left + width).contains(&x) && (top..top + height).contains(&y) {
                let lit = lit[(y - top) * width + x - left];
                for (c, channel) in row.rgb.iter_mut().enumerate() {
                    channel[x] = self.back[c] + lit * (self.front[c] - self.back[c]);
                }
            }
        }
    }
}
