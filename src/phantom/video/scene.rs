//! A scene: everything that [`VideoOptions`] leave open is settled (`settle`), and each frame has its picture
//! (`picture`) and its truth (`truth`).

use std::f64::consts::TAU;

use serde::Serialize;

use super::VideoOptions;
use crate::phantom::motion::finger::Skin;
use crate::phantom::scene::lens::Mapping;
use crate::phantom::scene::reel::TICKS_PER_S;
use crate::phantom::screen::Clock;
use crate::phantom::video::draw::blot::Blot;
use crate::phantom::video::draw::limb::Limb;
use crate::phantom::video::draw::objects::{Distractor, Stick};

/// The sway's rates, hertz.
const SWAY_HZ: [f64; 2] = [0.13, 0.19];
/// How long the finger takes to leave.
const APPROACH_S: f64 = 0.5;
/// A marker of the scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SceneMarker {
    /// Its name in the marker file.
    pub name: String,
    /// Its colour, sRGB as 0xrrggbb.
    pub colour: u32,
}

/// How much of a marker is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkerStatus {
    /// All of it.
    Ok,
    /// Some of it: covered in part or over the picture's border.
    Partial,
    /// Nothing: covered.
    Hidden,
    /// Nothing: out of the picture.
    Outside,
}

/// What is true of a marker in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MarkerTruth {
    /// Its centre in the picture as it is shown, at mid-exposure; of a mark of paint, the material point that was the
    /// blot's centroid on the straight finger.
    pub at_px: [f64; 2],
    /// The centroid of what is seen of a blot of paint at mid-exposure; none of a disc, and where nothing is seen.
    pub seen_px: Option<[f64; 2]>,
    /// The share of its disc or blot that is in the picture and not covered.
    pub in_view: f64,
    /// In words.
    pub status: MarkerStatus,
}

/// What is true of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTruth {
    /// Its presentation time, which is its mid-exposure; of a rolling shutter, that of the first row.
    pub time_s: f64,
    /// What the clock counts then.
    pub clock_s: Option<f64>,
    /// Of the layout's joints, radians.
    pub angles_rad: Vec<f64>,
    /// In the order of [`Scene::markers`].
    pub markers: Vec<MarkerTruth>,
}

/// Where everything is at one moment, as a lens without distortion would show it.
#[derive(Debug, Clone)]
pub(super) struct Moment {
    pub(super) bones_px: Vec<[f64; 2]>,
    pub(super) markers_px: Vec<[f64; 2]>,
    pub(super) skins: Vec<Skin>,
    pub(super) distractors_px: Vec<[f64; 2]>,
    pub(super) sticks_px: Vec<[f64; 2]>,
}

/// A video's scene.
#[derive(Debug)]
pub struct Scene {
    pub(super) options: VideoOptions,
    pub(super) ticks: Vec<i64>,
    pub(super) markers: Vec<SceneMarker>,
    /// The markers' shapes, where they are marks of paint.
    pub(super) blots: Vec<Blot>,
    /// With paint, another hand that lies there.
    pub(super) other_hand: Option<Limb>,
    pub(super) distractors: Vec<Distractor>,
    pub(super) sticks: Vec<Stick>,
    pub(super) mapping: Option<Mapping>,
    /// With a lens: what to add to each pixel's place to undo it.
    pub(super) straighten: Option<Vec<[f32; 2]>>,
    /// Its least and greatest steps in each row: to the right, down.
    pub(super) row_moves: Option<Vec<[[f64; 2]; 2]>>,
    pub(super) leave: Option<(f64, f64, f64)>,
}

impl Scene {
    /// What was asked for; of the clock, its stop and its jump are times now.
    #[must_use]
    pub fn options(&self) -> &VideoOptions {
        &self.options
    }

    /// The markers, proximal first.
    #[must_use]
    pub fn markers(&self) -> &[SceneMarker] {
        &self.markers
    }

    /// How many frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.ticks.len()
    }

    /// A frame's presentation time, seconds.
    #[must_use]
    pub fn time_s(&self, frame: usize) -> f64 {
        self.ticks[frame] as f64 / f64::from(TICKS_PER_S)
    }

    /// How long after the frame's time the middle of the clock is taken, seconds.
    pub(super) fn clock_late_s(&self, clock: &Clock) -> f64 {
        let options = &self.options;
        let format = options.format();
        let [x, y, width, height] = options.clock_roi_px(clock).map(|side| side as f64);
        let middle = [x + 0.5 * (width - 1.0), y + 0.5 * (height - 1.0)];
        let [_, row] = options.turn.stored_from_shown(middle, (format.width, format.height));
        options.readout_s * row / (format.height - 1) as f64
    }

    /// Whether the clock's screen is covered in a frame.
    pub(super) fn clock_hidden(&self, frame: usize) -> bool {
        self.options.screen.hide.iter().any(|&[first, frames]| (first..first + frames).contains(&frame))
    }

    /// Where the lens shows a point.
    pub(super) fn shown(&self, point: [f64; 2]) -> [f64; 2] {
        self.mapping.as_ref().map_or(point, |mapping| mapping.shown(point))
    }

    /// Whether a point of the shown picture is in it.
    pub(super) fn in_picture(&self, [x, y]: [f64; 2]) -> bool {
        (-0.5..self.options.width as f64 - 0.5).contains(&x) && (-0.5..self.options.height as f64 - 0.5).contains(&y)
    }

    pub(super) fn moment(&self, t_s: f64) -> Moment {
        let posture = self.options.finger.posture(self.options.trajectory.angles_rad(t_s), self.shift_px(t_s));
        Moment {
            distractors_px: self.distractors.iter().map(|one| one.at(t_s)).collect(),
            sticks_px: self.sticks.iter().map(|stick| stick.tip(t_s, posture.markers_px[stick.marker])).collect(),
            bones_px: posture.bones_px,
            markers_px: posture.markers_px,
            skins: posture.skins,
        }
    }

    fn shift_px(&self, t_s: f64) -> [f64; 2] {
        let [x, y] = SWAY_HZ.map(|hz| self.options.sway_px * (TAU * hz * t_s).sin());
        let away = self.leave.map_or(0.0, |(from_s, to_s, px)| {
            let late = ((from_s - t_s).max(t_s - to_s).max(0.0) / APPROACH_S).min(1.0);
            px * (1.0 - late * late * (3.0 - 2.0 * late))
        });
        [x + away, y]
    }
}
