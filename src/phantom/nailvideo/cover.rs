//! What is held over the nail: it comes from beside the picture, covers part of the nail and goes again.
//!
//! In: a span of frames and the seed. Out: how much of a pixel is covered at a time, its colour, and whether a point
//! is. A rod is a straight bar with a round end, a fifth of the nail wide. A finger is the same person's other one:
//! of the same skin, with a nail of its own. Both sway slightly and do not follow the nail.

use std::f64::consts::TAU;

use rand::RngExt;

use super::NailVideoOptions;
use crate::nail::Axis;
use crate::phantom::motion::wave::{Wave, random_wave};
use crate::phantom::nail::{Background, Camera, ColourWeights, Field, NailScene, Subject, numbers};
use crate::phantom::sensor::person;

/// The person of a cut is this many further, and the one whose finger lies over the nail.
pub(super) const OTHER: u32 = 1000;
const KIND_ROD: u32 = 44;
const KIND_FINGER: u32 = 47;
/// How long it takes to come and to go, seconds.
const COMES_S: f64 = 0.3;
/// Its sway, pixels.
const SWAY_PX: f64 = 2.0;
/// Half a rod's width in nail widths, its colour in the first light, half the softness of its border in pixels.
const HALF_WIDTHS: f64 = 0.10;
const COLOUR: [f64; 3] = [0.30, 0.28, 0.24];
const SOFT_PX: f64 = 1.2;

/// A rod or a finger.
#[derive(Debug, Clone)]
pub(super) struct Cover {
    span_s: [f64; 2],
    /// Where its end lies over the nail, and from where it comes (a unit vector).
    end_px: [f64; 2],
    from: [f64; 2],
    away_px: f64,
    sway: [Wave; 2],
    form: Form,
}

#[derive(Debug, Clone)]
enum Form {
    Rod { half_px: f64 },
    Finger(Box<NailScene>),
}

/// A cover at a time.
pub(super) enum Held<'a> {
    Rod { end_px: [f64; 2], from: [f64; 2], half_px: f64 },
    Finger { shift_px: [f64; 2], field: Box<Field<'a>> },
}

impl Cover {
    pub(super) fn rod(options: &NailVideoOptions, scene: &NailScene, index: usize) -> Self {
        let form = |_, _| Form::Rod { half_px: HALF_WIDTHS * scene.width_px() };
        Self::new(options, scene, (KIND_ROD, index), options.rod[index], [0.1..0.7, -0.3..0.5], form)
    }

    pub(super) fn finger(options: &NailVideoOptions, scene: &NailScene, index: usize) -> Self {
        let form = |end_px: [f64; 2], from: [f64; 2]| {
            let mut subject = person(options.subject.wrapping_add(OTHER).wrapping_add(index as u32));
            let Subject { tone, redness, bed, .. } = scene.subject;
            (subject.tone, subject.redness, subject.bed) = (tone, redness, bed);
            // Its border is mixed with its own skin; the scene that it covers is put in later.
            let background = Background { colour: subject.tone.skin(), grain: 0.0, shadow: 0.0 };
            let to_end_px = 0.5 * scene.width_px() * (subject.nail.aspect + subject.finger.tip);
            let centre_px = std::array::from_fn(|k| end_px[k] + to_end_px * from[k]);
            let axis = Axis::through(from, [0.0; 2]).unwrap_or(scene.axis());
            let camera = Camera { centre_px, axis, background, ..scene.camera };
            Form::Finger(Box::new(NailScene { subject, camera, ..scene.clone() }))
        };
        Self::new(options, scene, (KIND_FINGER, index), options.finger[index], [-0.7..0.7, -0.7..0.7], form)
    }

    /// `over`: where its end lies on the nail, to the side that it comes from and along.
    fn new(
        options: &NailVideoOptions,
        scene: &NailScene,
        (kind, index): (u32, usize),
        [frame, count]: [usize; 2],
        [across, along]: [std::ops::Range<f64>; 2],
        form: impl FnOnce([f64; 2], [f64; 2]) -> Form,
    ) -> Self {
        let mut rng = numbers(options.seed, kind, index as u32);
        let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let turn = rng.random_range(-0.06..0.06) * TAU;
        let end_px = scene.picture_from_nail(-side * rng.random_range(across), rng.random_range(along));
        let wave = |k: u32| random_wave(0.3, 0.4..4.0, options.seed, kind, 100 + 2 * index as u32 + k);
        let from = [side * turn.cos(), turn.sin()];
        Self {
            span_s: [frame as f64 / options.fps, (frame + count) as f64 / options.fps],
            end_px,
            from,
            away_px: f64::from(options.size.0) + f64::from(options.size.1),
            sway: [wave(0), wave(1)],
            form: form(end_px, from),
        }
    }

    /// The cover at `t_s`, where it is near.
    pub(super) fn at(&self, t_s: f64) -> Option<Held<'_>> {
        let [from_s, to_s] = self.span_s;
        let late_s = (from_s - t_s).max(t_s - to_s).max(0.0);
        if late_s >= COMES_S {
            return None;
        }
        let away = self.away_px * (late_s / COMES_S).powi(2);
        let place =
            |start: [f64; 2]| std::array::from_fn(|k| start[k] + away * self.from[k] + SWAY_PX * self.sway[k].at(t_s));
        Some(match &self.form {
            Form::Rod { half_px } => Held::Rod { end_px: place(self.end_px), from: self.from, half_px: *half_px },
            Form::Finger(scene) => {
                let resting = ColourWeights::resting(&scene.subject, [0.0; 3], [0.0; 3]);
                Held::Finger { shift_px: place([0.0; 2]), field: Box::new(scene.field().at_moment(&resting)) }
            }
        })
    }
}

impl Held<'_> {
    /// Whether a point is below it.
    pub(super) fn covers(&self, at: [f64; 2]) -> bool {
        match self {
            Self::Rod { end_px, from, half_px } => to_rod(at, *end_px, *from, *half_px).0 <= 0.0,
            Self::Finger { shift_px: [x, y], field } => field.on_finger(at[0] - x, at[1] - y) >= 0.5,
        }
    }

    /// How much of a pixel it covers, and its colour there in the first light.
    pub(super) fn over(&self, at: [f64; 2]) -> (f64, [f64; 3]) {
        match self {
            Self::Rod { end_px, from, half_px } => {
                let (distance, across) = to_rod(at, *end_px, *from, *half_px);
                let share = (0.5 - 0.5 * distance / SOFT_PX).clamp(0.0, 1.0);
                let round = 1.0 - 0.55 * across * across;
                (share, COLOUR.map(|colour| colour * round.max(0.2)))
            }
            Self::Finger { shift_px: [x, y], field } => {
                let [x, y] = [at[0] - x, at[1] - y];
                let share = field.on_finger(x, y);
                (share, if share > 0.0 { field.colour(x, y) } else { [0.0; 3] })
            }
        }
    }
}

/// Distance of a point to a rod's border, pixels, negative within, and where across it lies, -1..1.
fn to_rod([x, y]: [f64; 2], end_px: [f64; 2], from: [f64; 2], half_px: f64) -> (f64, f64) {
    let d = [x - end_px[0], y - end_px[1]];
    let along = (d[0] * from[0] + d[1] * from[1]).max(0.0);
    let off = [d[0] - along * from[0], d[1] - along * from[1]];
    let across = from[0] * d[1] - from[1] * d[0];
    (off[0].hypot(off[1]) - half_px, across / half_px)
}
