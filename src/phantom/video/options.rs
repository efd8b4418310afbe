//! What video is wanted.

use serde::{Serialize, Serializer};

use super::{Lens, Oblique, Siting};
use crate::flexion::Flexion;
use crate::phantom::motion::finger::{Finger, JOINTS, MarkerLayout};
use crate::phantom::motion::trajectory::Trajectory;
use crate::phantom::scene::lens::Mapping;
use crate::phantom::scene::place::is_default;
use crate::phantom::screen::Clock;
use crate::video::{Codec, Format, Matrix, Turn};

/// A scene to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// Noise 2, crf 16, 1280x720, 30 frames a second, 10 s.
    Clean,
    /// Noise 6, blur over half a frame, flicker 12 %, gradient, distractors of three marker colours, a marker hidden
    /// for 12 frames, crf 30.
    Hard,
    /// 480x270, markers of 4 px, noise 2 (assumed), crf 23.
    Small,
    /// 60 frames a second, bending at 1 Hz, blur over half a frame, noise 2 (assumed), crf 16.
    Fast,
    /// 3840x2160, noise 2 (assumed), crf 16.
    Uhd,
}

/// The markers' colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Colours {
    /// One per segment: blue, pink, green, yellow; with one mark on each joint, one per mark.
    Pairs,
    /// One per marker.
    Distinct,
    /// All red.
    Red,
    /// All of one dark green paint; each mark is as dark as it is thick.
    Dark,
    /// All of one pale paint.
    Pale,
}

const PAIRS: [u32; 4] = [0x1e6fd9, 0xe91e63, 0x2e9e4f, 0xecc25a];
const DISTINCT: [u32; 8] = [0x1e6fd9, 0xe91e63, 0x2e9e4f, 0xecc25a, 0x7b1fa2, 0x00acc1, 0xf57c00, 0xaeea00];
const RED: u32 = 0xd32f2f;
/// Luma 30-67 and Cr 111-123 at the tones of blots, as in a real recording; and one that is as far above the skin in
/// luma.
const DARK: u32 = 0x1c4a10;
const PALE: u32 = 0xcdd6b2;

impl Colours {
    /// The colour of each marker, sRGB as 0xrrggbb.
    #[must_use]
    pub fn of(self, layout: MarkerLayout) -> Vec<u32> {
        let count = layout.names().len();
        match (self, layout) {
            (Self::Pairs, MarkerLayout::Pairs) => (0..count).map(|k| PAIRS[k / 2]).collect(),
            (Self::Red, _) => vec![RED; count],
            (Self::Dark, _) => vec![DARK; count],
            (Self::Pale, _) => vec![PALE; count],
            _ => DISTINCT[..count].to_vec(),
        }
    }
}

/// A marker to be covered by a stick that comes and goes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hide {
    /// As the layout calls it.
    pub marker: String,
    /// The first frame in which nothing of it is seen.
    pub frame: usize,
    /// How many frames long.
    pub frames: usize,
}

/// The finger moves so far right that its fingertip leaves the picture, and comes back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Leave {
    /// The first frame in which the last marker is outside.
    pub frame: usize,
    /// How many frames long.
    pub frames: usize,
}

/// What happens to the clock's screen, in frames; the clock itself counts on.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ScreenEvents {
    /// A plain sheet covers it: the first frame and how many frames long.
    pub hide: Vec<[usize; 2]>,
    /// From this frame on it stands still.
    pub stop: Option<usize>,
    /// From this frame on it shows so many seconds more.
    pub jump: Option<(usize, f64)>,
}

/// Colour planes of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
pub enum Chroma {
    /// One chroma sample for 2 x 2 pixels.
    #[serde(rename = "420")]
    #[value(name = "420")]
    Quarter,
    /// One for 2 pixels of a row.
    #[serde(rename = "422")]
    #[value(name = "422")]
    Half,
    /// One a pixel.
    #[serde(rename = "444")]
    #[value(name = "444")]
    Full,
    /// No chroma.
    #[serde(rename = "grey")]
    #[value(name = "grey")]
    None,
}

/// A video to be made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VideoOptions {
    /// Everything random follows from it.
    pub seed: u64,
    /// Columns of the shown picture.
    pub width: usize,
    /// Rows of the shown picture.
    pub height: usize,
    /// Frames a second.
    pub fps: f64,
    /// How long; the nearest number of frames is made.
    pub seconds: f64,
    /// How far a frame's interval may differ from the mean one, as a share of it; above 0, a frame in 25 is dropped as
    /// well.
    pub jitter: f64,
    /// How the joints move.
    pub trajectory: Trajectory,
    /// The finger's shape and place.
    pub finger: Finger,
    /// The markers' colours.
    pub colours: Colours,
    /// How far the whole finger sways.
    pub sway_px: f64,
    /// The finger leaves the picture.
    pub leave: Option<Leave>,
    /// Markers that are covered for a while.
    pub hide: Vec<Hide>,
    /// Blobs of three marker colours elsewhere.
    pub distractors: usize,
    /// Colour of the desk, sRGB as 0xrrggbb.
    pub desk: u32,
    /// Exposure as a share of the mean frame interval.
    pub blur: f64,
    /// A rolling shutter: how long after the stored picture's first row its last is taken, seconds.
    #[serde(skip_serializing_if = "is_default")]
    pub readout_s: f64,
    /// Half the range of the light's brightness, as a share.
    pub flicker: f64,
    /// How often the light flickers a second; frames sample it, so 100 Hz is seen as 10 Hz at 30 frames a second.
    pub flicker_hz: f64,
    /// Half the range of the light's brightness over the picture, from its top left to its bottom right, as a share.
    pub gradient: f64,
    /// Standard deviation of the sharpness' Gaussian.
    pub focus_px: f64,
    /// Standard deviation of the sensor's noise in R'G'B', in 255ths.
    pub noise_sd: f64,
    /// The lens; none: no distortion.
    pub lens: Option<Lens>,
    /// The plane in which the finger moves, where the camera does not look at it straight.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane: Option<Oblique>,
    /// A clock on a screen.
    pub clock: Option<Clock>,
    /// What happens to its screen.
    pub screen: ScreenEvents,
    /// The marker file says `roi = "auto"`, not where the clock is.
    pub clock_roi_auto: bool,
    /// Colour matrix and range.
    #[serde(serialize_with = "matrix_in_words")]
    pub matrix: Matrix,
    /// Where chroma samples lie.
    pub siting: Siting,
    /// What the file's header says of that; none: nothing.
    pub stated_siting: Option<Siting>,
    /// How the stored picture is to be turned to be shown.
    #[serde(serialize_with = "turn_in_words")]
    pub turn: Turn,
    /// Colour planes.
    pub chroma: Chroma,
    /// Bits a sample: 8 or 10.
    pub depth: u32,
    /// What it is encoded in.
    #[serde(skip_serializing_if = "is_default")]
    pub codec: Codec,
    /// The encoder's constant rate factor.
    pub crf: u32,
    /// The encoder's preset, of [`Coding::PRESETS`](super::Coding::PRESETS).
    pub preset: &'static str,
    /// Joints that the marker file asks for.
    pub joints: Vec<String>,
    /// Write `[start]` into the marker file.
    pub start: bool,
}

fn matrix_in_words<S: Serializer>(matrix: &Matrix, serializer: S) -> Result<S::Ok, S::Error> {
    let name = match matrix.k_red {
        k if k == Matrix::BT709.k_red => "BT.709",
        k if k == Matrix::BT601.k_red => "BT.601",
        _ => "BT.2020",
    };
    let range = if matrix.full_range { "full" } else { "limited" };
    match matrix.transfer.hdr() {
        None => serializer.serialize_str(&format!("{name}, {range} range")),
        Some(hdr) => serializer.serialize_str(&format!("{name}, {hdr}, {range} range")),
    }
}

fn turn_in_words<S: Serializer>(turn: &Turn, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_u32(90 * turn.quarters() as u32)
}

impl VideoOptions {
    /// A scene of the table.
    #[must_use]
    pub fn new(preset: Preset) -> Self {
        let clean = Self::sized(1280, 720);
        match preset {
            Preset::Clean => clean,
            Preset::Hard => Self {
                noise_sd: 6.0,
                blur: 0.5,
                flicker: 0.12,
                gradient: 0.2,
                distractors: 6,
                hide: vec![Hide { marker: "middle_dist".to_owned(), frame: 120, frames: 12 }],
                crf: 30,
                ..clean
            },
            Preset::Small => Self { crf: 23, ..Self::sized(480, 270) },
            Preset::Fast => Self { fps: 60.0, trajectory: Trajectory::Eq27 { hz: 1.0 }, blur: 0.5, ..clean },
            Preset::Uhd => Self::sized(3840, 2160),
        }
    }

    /// The clean scene in another size.
    #[must_use]
    pub fn sized(width: usize, height: usize) -> Self {
        Self {
            seed: 1,
            width,
            height,
            fps: 30.0,
            seconds: 10.0,
            jitter: 0.0,
            trajectory: Trajectory::Eq27 { hz: 0.1 },
            finger: Finger::new(width, height, Flexion::Clockwise, MarkerLayout::Pairs),
            colours: Colours::Pairs,
            sway_px: 3.0 * width as f64 / 1280.0,
            leave: None,
            hide: Vec::new(),
            distractors: 0,
            desk: 0x8a9299,
            blur: 0.0,
            readout_s: 0.0,
            flicker: 0.0,
            flicker_hz: 100.0,
            gradient: 0.0,
            focus_px: 0.55,
            noise_sd: 2.0,
            lens: None,
            plane: None,
            clock: None,
            screen: ScreenEvents::default(),
            clock_roi_auto: false,
            matrix: Matrix::BT709,
            siting: Siting::Left,
            stated_siting: None,
            turn: Turn::None,
            chroma: Chroma::Quarter,
            depth: 8,
            codec: Codec::H264,
            crf: 16,
            preset: "medium",
            joints: JOINTS.map(str::to_owned).to_vec(),
            start: false,
        }
    }

    /// This video with marks of paint in this layout, as filmed in a real recording: 24 frames a second, dark paint on
    /// skin of dim light, another hand with three dark spots, light from one side, some blur; the marker file has
    /// `[start]`, as all marks are of one colour.
    #[must_use]
    pub fn painted(self, layout: MarkerLayout) -> Self {
        Self {
            finger: Finger::new(self.width, self.height, self.finger.flexion, layout),
            colours: Colours::Dark,
            joints: layout.joints().into_iter().map(|(joint, _)| joint.to_owned()).collect(),
            fps: 24.0,
            blur: 0.25,
            gradient: 0.2,
            distractors: 3,
            desk: 0x565c61,
            crf: 20,
            start: true,
            ..self
        }
    }

    /// How many frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        (self.fps * self.seconds).round() as usize
    }

    /// The camera before the scene; none where it only looks at it straight.
    pub(super) fn mapping(&self) -> Option<Mapping> {
        let needed = self.lens.is_some() || self.plane.is_some();
        let lens = self.lens.clone().unwrap_or_default();
        needed.then(|| Mapping::new(&lens, self.width, self.height).before(self.plane))
    }

    /// How the stored pictures' samples are laid out.
    #[must_use]
    pub fn format(&self) -> Format {
        let subsampling = match self.chroma {
            Chroma::Quarter => Some((2, 2)),
            Chroma::Half => Some((2, 1)),
            Chroma::Full => Some((1, 1)),
            Chroma::None => None,
        };
        // A quarter turn back exchanges the sides as one forth does.
        let (width, height) = self.turn.shown_size((self.width, self.height));
        Format { width, height, subsampling, depth: self.depth }
    }

    /// The clock's panel: left, top, width, height.
    #[must_use]
    pub fn clock_roi_px(&self, clock: &Clock) -> [usize; 4] {
        let part = |share: f64, side: usize| (share * side as f64).round() as usize;
        clock.roi_px.unwrap_or([
            part(900.0 / 1280.0, self.width),
            part(40.0 / 720.0, self.height),
            part(300.0 / 1280.0, self.width),
            part(70.0 / 720.0, self.height),
        ])
    }
}
