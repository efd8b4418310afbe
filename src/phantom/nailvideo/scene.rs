//! A video's scene: the nail, how it moves and how it is coloured in each frame, and what is true of each frame.

use rand::RngExt;

use super::canvas::{Canvas, MOST_SAMPLES, samples};
use super::cover::{Cover, OTHER};
use super::light::DriftingLight;
use super::track::Track;
use super::{Affine, Faults, NailVideoOptions};
use crate::nail::{Axis, Positions};
use crate::phantom::log::{BEFORE_S, Doing, LogScene};
use crate::phantom::nail::{Background, Blood, Camera, ColourWeights, Light, NailScene, Pose, Subject, numbers};
use crate::phantom::scene::reel::TICKS_PER_S;
use crate::phantom::sensor::{Discs, Response, Touch, person};

const KIND_SCENE: u32 = 45;

/// A video of a nail, settled.
#[derive(Debug)]
pub struct Scene {
    pub(super) options: NailVideoOptions,
    pub(super) log: LogScene,
    pub(super) positions: Positions,
    pub(super) nail: NailScene,
    pub(super) moments: Vec<Moment>,
    pub(super) track: Track,
    pub(super) light: DriftingLight,
    pub(super) covers: Vec<Cover>,
    pub(super) discs: Discs,
    pub(super) canvas: Canvas,
    /// Another person's nail, where there is a cut.
    pub(super) other: Option<(Canvas, ColourWeights)>,
}

/// What the finger does in a frame, and the nail's colour.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    pub(super) touch: Touch,
    pub(super) weights: ColourWeights,
}

/// What is true of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTruth {
    /// Its presentation time, which is its mid-exposure, seconds.
    pub time_s: f64,
    /// Frame 0's pixels to this one's; none of another nail.
    pub motion: Option<Affine>,
    /// What the finger does.
    pub touch: Touch,
    /// Red, green and blue light of the normalized nail over each photodiode's disc, in the first light: of the disc's
    /// mean as encoded, by the curve that the film is read with.
    pub photodiodes: Vec<[f64; 3]>,
    /// Which share of each disc is covered or out of the picture.
    pub hidden: Vec<f64>,
    /// Whether nothing of the nail is in the picture.
    pub gone: bool,
    /// What red, green and blue light is multiplied by at the nail's middle.
    pub light: [f64; 3],
}

impl Scene {
    /// Settles what the frames will be.
    ///
    /// # Errors
    /// [`Faults`]: all that is wrong with the options.
    pub fn new(options: NailVideoOptions) -> Result<Self, Faults> {
        options.check()?;
        let log = LogScene::new(options.log())?;
        let nail = nail_scene(&options, person(options.subject), 0);
        nail.check().map_err(|fault| Faults(vec![fault.to_string()]))?;
        let away_px = f64::from(options.size.0).hypot(f64::from(options.size.1)) + 2.0 * nail.length_px();
        let track = Track::new(&options, nail.camera.centre_px, away_px);
        let region_px = region(&options, &track);
        if samples(region_px) > MOST_SAMPLES {
            let what = "--drift, --scale, --leave: the frames show more of the scene than can be drawn; choose less";
            return Err(Faults(vec![what.to_owned()]));
        }
        let positions = options.positions.clone().unwrap_or_else(Positions::thesis);
        let canvas = Canvas::new(&nail, region_px);
        let other = (!options.cut.is_empty()).then(|| {
            let scene = nail_scene(&options, person(options.subject.wrapping_add(OTHER)), 1);
            (Canvas::new(&scene, region_px), ColourWeights::resting(&scene.subject, [0.0; 3], [0.0; 3]))
        });
        let discs = Discs::new(&nail, &positions);
        let rods = (0..options.rod.len()).map(|index| Cover::rod(&options, &nail, index));
        let fingers = (0..options.finger.len()).map(|index| Cover::finger(&options, &nail, index));
        let covers = rods.chain(fingers).collect();
        let light = DriftingLight::new(&options, &nail);
        let moments = moments(&options, &log, &nail.subject);
        Ok(Self { options, log, positions, nail, moments, track, light, covers, discs, canvas, other })
    }

    /// What was asked for.
    #[must_use]
    pub fn options(&self) -> &NailVideoOptions {
        &self.options
    }

    /// The nail as it is in the first frame.
    #[must_use]
    pub fn nail(&self) -> &NailScene {
        &self.nail
    }

    /// Where the photodiodes are.
    #[must_use]
    pub fn positions(&self) -> &Positions {
        &self.positions
    }

    /// How many frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.moments.len()
    }

    /// The zones' weights in a frame.
    #[must_use]
    pub fn weights(&self, frame: usize) -> &ColourWeights {
        &self.moments[frame].weights
    }

    /// A frame's presentation time, seconds.
    #[must_use]
    pub fn time_s(&self, frame: usize) -> f64 {
        self.options.time_s(frame)
    }

    /// Whether another nail is in a frame.
    pub(super) fn is_cut(&self, frame: usize) -> bool {
        self.options.cut.iter().any(|&[first, frames]| (first..first + frames).contains(&frame))
    }
}

impl NailVideoOptions {
    /// A frame's presentation time, ticks.
    pub(super) fn ticks(&self, frame: usize) -> i64 {
        (frame as f64 / self.fps * f64::from(TICKS_PER_S)).round() as i64
    }

    fn time_s(&self, frame: usize) -> f64 {
        self.ticks(frame) as f64 / f64::from(TICKS_PER_S)
    }
}

/// A person's nail before the camera, near the picture's middle and nearly upright.
fn nail_scene(options: &NailVideoOptions, subject: Subject, which: u32) -> NailScene {
    let mut rng = numbers(options.seed, KIND_SCENE, which);
    let sides = [options.size.0, options.size.1].map(f64::from);
    let centre_px = sides.map(|side| 0.5 * (side - 1.0) + 0.03 * side * rng.random_range(-1.0..1.0));
    let axis = Axis::from_clockwise_rad((6.0 * rng.random_range(-1.0..1.0f64)).to_radians());
    let side = rng.random_range(-0.2..0.2);
    let background = Background::random(&mut rng);
    let nail_px = options.nail_px * if which == 0 { 1.0 } else { 0.9 };
    let camera = Camera { axis, background, ..Camera::upright(options.size.into(), centre_px, nail_px) };
    let light = Light { brightness: options.level, gradient: [0.0; 2], side, ..Light::chamber() };
    NailScene { subject, pose: Pose::Nominal, light, camera }
}

/// What part of frame 0's plane the frames show: `[left, top, right, bottom]`, pixels.
fn region(options: &NailVideoOptions, track: &Track) -> [f64; 4] {
    let [right, bottom] = [options.size.0, options.size.1].map(f64::from);
    let mut region = [0.0, 0.0, right, bottom];
    let half_s = 0.5 * options.blur / options.fps;
    for time_s in (0..options.frames()).flat_map(|frame| [-1.0, 0.0, 1.0].map(|k| options.time_s(frame) + k * half_s)) {
        let back = track.at(time_s).inverse();
        for corner in [[0.0, 0.0], [right, 0.0], [0.0, bottom], [right, bottom]] {
            let [x, y] = back.apply(corner);
            region = [region[0].min(x), region[1].min(y), region[2].max(x), region[3].max(y)];
        }
    }
    region
}

/// Each frame's touch and colour.
fn moments(options: &NailVideoOptions, log: &LogScene, subject: &Subject) -> Vec<Moment> {
    let mut doing = Doing::new(log.options());
    let mut followed = doing.clone();
    let movement = move |t_s: f64| followed.touch(t_s);
    let mut colour = Response::new(&Blood::of(subject), log.options().dynamics, movement, -BEFORE_S);
    let at = |frame: usize| {
        let time_s = options.time_s(frame);
        Moment { touch: doing.touch(time_s), weights: colour.at(time_s) }
    };
    (0..options.frames()).map(at).collect()
}
