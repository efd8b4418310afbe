//! A rod that is held over the nail: it comes from beside the picture, covers part of the nail and goes again.
//!
//! In: a span of frames and the seed. Out: how much of a pixel is covered at a time, and whether a point is. The rod is
//! a straight bar with a round end, a fifth of the nail wide; it has its own slight sway and does not follow the nail.

use std::f64::consts::TAU;

use rand::RngExt;

use super::NailVideoOptions;
use crate::phantom::motion::wave::{Wave, random_wave};
use crate::phantom::nail::{NailScene, numbers};

const KIND_ROD: u32 = 44;
/// How long it takes to come and to go, seconds.
const COMES_S: f64 = 0.3;
/// Half its width in nail widths, its colour in the first light, its sway in pixels.
const HALF_WIDTHS: f64 = 0.10;
const COLOUR: [f64; 3] = [0.30, 0.28, 0.24];
const SWAY_PX: f64 = 2.0;
/// Half the softness of its border, pixels.
const SOFT_PX: f64 = 1.2;

/// A rod.
#[derive(Debug, Clone)]
pub(super) struct Rod {
    span_s: [f64; 2],
    /// Where its end lies over the nail, and from where it comes (a unit vector).
    end_px: [f64; 2],
    from: [f64; 2],
    half_px: f64,
    away_px: f64,
    sway: [Wave; 2],
}

/// A rod at a time: its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct HeldRod {
    end_px: [f64; 2],
    from: [f64; 2],
    half_px: f64,
}

impl Rod {
    /// Rod number `index` of the options.
    pub(super) fn new(options: &NailVideoOptions, scene: &NailScene, index: usize) -> Self {
        let [frame, count] = options.rod[index];
        let mut rng = numbers(options.seed, KIND_ROD, index as u32);
        let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let turn = rng.random_range(-0.06..0.06) * TAU;
        let end_px = scene.picture_from_nail(-side * rng.random_range(0.1..0.7), rng.random_range(-0.3..0.5));
        let wave = |k: u32| random_wave(0.3, 0.4..4.0, options.seed, KIND_ROD, 100 + 2 * index as u32 + k);
        Self {
            span_s: [frame as f64 / options.fps, (frame + count) as f64 / options.fps],
            end_px,
            from: [side * turn.cos(), turn.sin()],
            half_px: HALF_WIDTHS * scene.width_px(),
            away_px: f64::from(options.size.0) + f64::from(options.size.1),
            sway: [wave(0), wave(1)],
        }
    }

    /// The rod at `t_s`, where it is near.
    pub(super) fn at(&self, t_s: f64) -> Option<HeldRod> {
        let [from_s, to_s] = self.span_s;
        let late_s = (from_s - t_s).max(t_s - to_s).max(0.0);
        if late_s >= COMES_S {
            return None;
        }
        let away = self.away_px * (late_s / COMES_S).powi(2);
        let end_px = std::array::from_fn(|k| self.end_px[k] + away * self.from[k] + SWAY_PX * self.sway[k].at(t_s));
        Some(HeldRod { end_px, from: self.from, half_px: self.half_px })
    }
}

impl HeldRod {
    /// Distance to its border, pixels, negative within, and where across it lies, -1..1.
    fn distance(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        let d = [x - self.end_px[0], y - self.end_px[1]];
        let along = (d[0] * self.from[0] + d[1] * self.from[1]).max(0.0);
        let off = [d[0] - along * self.from[0], d[1] - along * self.from[1]];
        let across = self.from[0] * d[1] - self.from[1] * d[0];
        (off[0].hypot(off[1]) - self.half_px, across / self.half_px)
    }

    /// Whether a point is below it.
    pub(super) fn covers(&self, at: [f64; 2]) -> bool {
        self.distance(at).0 <= 0.0
    }

    /// How much of a pixel it covers, and its colour there in the first light.
    pub(super) fn over(&self, at: [f64; 2]) -> (f64, [f64; 3]) {
        let (distance, across) = self.distance(at);
        let share = (0.5 - 0.5 * distance / SOFT_PX).clamp(0.0, 1.0);
        let round = 1.0 - 0.55 * across * across;
        (share, COLOUR.map(|colour| colour * round.max(0.2)))
    }
}
