//! A scene: everything that [`VideoOptions`] leave open is settled, and each frame has its picture and its truth.

use std::f64::consts::TAU;

use rayon::prelude::*;
use serde::Serialize;

use super::blot::Blot;
use super::lens::{Mapping, row_moves};
use super::limb::Limb;
use super::objects::{Distractor, Stick};
use super::paint::{Exposure, Row};
use super::sensor::{Converter, add_noise};
use super::settle::{other_hand, ticks};
use super::share::shares;
use super::{Faults, VideoOptions};
use crate::phantom::finger::Skin;
use crate::video::{Picture, Turn};

/// Ticks a second of the frames' times.
pub(super) const TICKS_PER_S: i32 = 90_000;

/// The sway's rates, hertz.
const SWAY_HZ: [f64; 2] = [0.13, 0.19];
/// How long the finger takes to leave.
const APPROACH_S: f64 = 0.5;
/// A marker's visible shares under and over which it counts as hidden and as seen.
const HIDDEN_UNDER: f64 = 0.005;
const SEEN_OVER: f64 = 0.995;

/// A marker of the scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SceneMarker {
    /// Its name in the marker file.
    pub name: String,
    /// Its colour, sRGB as 0xrrggbb.
    pub colour: u32,
}

/// How much of a marker is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
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
    /// Its presentation time, which is its mid-exposure.
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
    leave: Option<(f64, f64, f64)>,
}

impl Scene {
    /// Settles a scene.
    ///
    /// # Errors
    /// [`Faults`]: all that is wrong with the options.
    pub fn new(options: VideoOptions) -> Result<Self, Faults> {
        options.check()?;
        let colours = options.colours.of(options.finger.layout);
        let names = options.finger.layout.names();
        let markers = names.into_iter().zip(colours).map(|(name, colour)| SceneMarker { name, colour }).collect();
        let mapping = options.lens.as_ref().map(|lens| Mapping::new(lens, options.width, options.height));
        let mut scene = Self {
            ticks: ticks(&options),
            markers,
            blots: if options.finger.layout.painted() { Blot::all(&options) } else { Vec::new() },
            other_hand: other_hand(&options),
            distractors: Vec::new(),
            sticks: Vec::new(),
            straighten: None,
            row_moves: None,
            mapping,
            leave: None,
            options,
        };
        scene.straighten =
            scene.mapping.as_ref().map(|mapping| mapping.straighten(scene.options.width, scene.options.height));
        scene.row_moves = scene.straighten.as_ref().map(|moves| row_moves(moves, scene.options.width));
        scene.options.clock = scene.settle_clock();
        scene.leave = scene.settle_leave();
        scene.sticks = scene.settle_sticks();
        scene.distractors = scene.settle_distractors();
        Ok(scene)
    }

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

    /// What is true of a frame.
    #[must_use]
    pub fn truth(&self, frame: usize) -> FrameTruth {
        let time_s = self.time_s(frame);
        let moment = self.moment(time_s);
        let markers = (0..self.markers.len())
            .map(|marker| {
                let shares = shares(self, &moment, marker);
                let status = match (shares.in_picture, shares.in_view) {
                    (in_picture, _) if in_picture < HIDDEN_UNDER => MarkerStatus::Outside,
                    (_, in_view) if in_view < HIDDEN_UNDER => MarkerStatus::Hidden,
                    (_, in_view) if in_view < SEEN_OVER => MarkerStatus::Partial,
                    _ => MarkerStatus::Ok,
                };
                let at_px = self.shown(moment.markers_px[marker]);
                MarkerTruth { at_px, seen_px: shares.seen_px, in_view: shares.in_view, status }
            })
            .collect();
        FrameTruth {
            time_s,
            clock_s: self.options.clock.as_ref().map(|clock| clock.counts_s(time_s)),
            angles_rad: self.options.finger.joints_rad(self.options.trajectory.angles_rad(time_s)),
            markers,
        }
    }

    /// Whether the clock's screen is covered in a frame.
    pub(super) fn clock_hidden(&self, frame: usize) -> bool {
        self.options.screen.hide.iter().any(|&[first, frames]| (first..first + frames).contains(&frame))
    }

    /// A frame's picture, as the encoder gets it: stored, not shown.
    #[must_use]
    pub fn picture(&self, frame: usize) -> Picture {
        let options = &self.options;
        let format = options.format();
        let exposure = Exposure::new(self, frame);
        let turned = (options.turn != Turn::None).then(|| self.draw_turned(&exposure, format.width));
        let converter = Converter::new(format, &options.matrix, options.siting);
        let noise_sd = (options.noise_sd / 255.0) as f32;
        let mut picture = Picture::new(format);
        let bytes = if format.depth > 8 { 2 } else { 1 };
        let down = format.subsampling.map_or(1, |(_, down)| down);
        let draw = |group: usize, rows: &mut [Row], luma: &mut [u8]| {
            for (k, (row, luma)) in rows.iter_mut().zip(luma.chunks_exact_mut(format.width * bytes)).enumerate() {
                let y = group * down + k;
                match &turned {
                    None => exposure.draw(y, row),
                    Some(turned) => row.rgb.clone_from(&turned[y]),
                }
                add_noise(&mut row.rgb, noise_sd, options.seed, frame, y);
                converter.luma(&row.rgb, luma);
            }
        };
        let fresh = || vec![Row::new(format.width); down];
        let (luma, chroma) = picture.planes.split_at_mut(1);
        let groups = luma[0].par_chunks_mut(format.width * bytes * down).enumerate();
        if let ([cb, cr], Some((width, _))) = (chroma, format.chroma_size()) {
            let chroma = cb.par_chunks_mut(width * bytes).zip(cr.par_chunks_mut(width * bytes));
            groups.zip(chroma).for_each_init(fresh, |rows, ((group, luma), (cb, cr))| {
                draw(group, rows, luma);
                let rows: Vec<_> = rows.iter().map(|row| &row.rgb).collect();
                converter.chroma(1, &rows, cb);
                converter.chroma(2, &rows, cr);
            });
        } else {
            groups.for_each_init(fresh, |rows, (group, luma)| draw(group, rows, luma));
        }
        picture
    }

    /// The rows of the stored picture, drawn as it is shown and turned back.
    fn draw_turned(&self, exposure: &Exposure<'_>, stored_width: usize) -> Vec<[Vec<f32>; 3]> {
        let (width, height) = (self.options.width, self.options.height);
        let draw = |y| {
            let mut row = Row::new(width);
            exposure.draw(y, &mut row);
            row.rgb
        };
        let shown: Vec<[Vec<f32>; 3]> = (0..height).into_par_iter().map(draw).collect();
        let stored = (stored_width, width * height / stored_width);
        let at = |x: usize, y: usize| {
            let [x, y] = self.options.turn.shown_from_stored([x as f64, y as f64], stored);
            (x as usize, y as usize)
        };
        let row = |y| {
            std::array::from_fn(|channel| (0..stored.0).map(|x| at(x, y)).map(|(x, y)| shown[y][channel][x]).collect())
        };
        (0..stored.1).into_par_iter().map(row).collect()
    }

    /// Where the lens shows a point.
    pub(super) fn shown(&self, point: [f64; 2]) -> [f64; 2] {
        self.mapping.as_ref().map_or(point, |mapping| mapping.shown(point))
    }

    /// Whether a point of the shown picture is in it.
    pub(super) fn in_picture(&self, [x, y]: [f64; 2]) -> bool {
        (-0.5..self.options.width as f64 - 0.5).contains(&x) && (-0.5..self.options.height as f64 - 0.5).contains(&y)
    }

    /// Where everything is at `t_s`.
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
