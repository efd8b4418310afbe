//! Which video of a nail to make: the options of `lunula phantom nailvideo`, and a pipeline's keys.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::job;
use crate::nail::Positions;
use crate::phantom::force::{Cycles, ForceTrajectory, Spiral};
use crate::phantom::log::{LogOptions, SensorModel};
use crate::phantom::presses::Presses;
use crate::phantom::request::{parse_size, parse_span_of_frames, positions};
use crate::phantom::trajectory::Trajectory;
use crate::phantom::video::Coding;
use crate::video::{Curve, Format, Transfer};

/// What the finger does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum NailProtocol {
    /// Presses and releases at exact times, without shear (12 s)
    Press,
    /// The calibration's spiral, equations 21 to 23, over the whole video (60 s)
    Touch,
    /// Random forces all over the cone of friction (60 s)
    TouchRandom,
    /// Fz from 0 to -4 N and back, ten seconds a cycle (20 s)
    Normal,
    /// Fx to 2 N, to -2 N and back at 3 N of pressing, ten seconds a cycle (20 s)
    Lateral,
    /// Fy to 2 N, to -2 N and back at 3 N of pressing, ten seconds a cycle (20 s)
    Longitudinal,
    /// Equation 27: J2 from -5 to 75 degrees and back, ten seconds a cycle (20 s)
    Bending,
    /// Nothing (10 s)
    Rest,
}

/// Rates of random forces and of cycles, hertz.
const RANDOM_HZ: f64 = 0.25;
const CYCLES_HZ: f64 = 0.1;
/// Samples a second of the log.
const LOG_HZ: f64 = 50.0;

/// What `lunula phantom nailvideo` takes.
#[derive(Debug, Clone, Args)]
pub struct NailVideoRequest {
    /// Where the photodiodes are on the nail: a positions.toml or layout.json of up to 8 [default: the thesis' eight,
    /// read off its words]
    #[arg(long = "positions", value_name = "FILE")]
    positions_file: Option<PathBuf>,
    #[command(flatten)]
    options: NailVideoOptions,
}

/// A video of a nail to be made.
#[derive(Debug, Clone, PartialEq, Args, Serialize)]
pub struct NailVideoOptions {
    /// Seed of everything random but the person and the session
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Whose finger it is, as in `lunula phantom log`
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub subject: u32,
    /// Which day: the gains of the sensor that the person wears change by a few per cent
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub session: u32,
    /// Where the photodiodes are; none: the thesis' places
    #[arg(skip)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub positions: Option<Positions>,

    /// What the finger does
    #[arg(long, value_enum, default_value = "press")]
    pub protocol: NailProtocol,
    /// Pressing of --protocol press
    #[arg(long = "press", value_name = "N", default_value_t = 3.0)]
    pub press_n: f64,
    /// From a press' onset to its release
    #[arg(long = "held", value_name = "SECONDS", default_value_t = 2.5)]
    pub held_s: f64,
    /// From a release to the next onset
    #[arg(long = "pause", value_name = "SECONDS", default_value_t = 3.5)]
    pub pause_s: f64,
    /// The video's length [default: as the protocol]
    #[arg(long)]
    pub seconds: Option<f64>,

    /// Frames a second
    #[arg(long, value_name = "HZ", default_value_t = 30.0)]
    pub fps: f64,
    /// Width and height of the frames, even
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "640x480", value_parser = parse_size)]
    pub size: (u32, u32),
    /// The nail's width in the first frame
    #[arg(long, value_name = "PX", default_value_t = 190.0)]
    pub nail_px: f64,

    /// How far the hand drifts at most, slowly, along each axis
    #[arg(long = "drift", value_name = "PX", default_value_t = 8.0)]
    pub drift_px: f64,
    /// How far it turns either way
    #[arg(long = "turn", value_name = "DEGREES", default_value_t = 1.5)]
    pub turn_deg: f64,
    /// How much larger and smaller it gets as it comes nearer and goes away
    #[arg(long = "scale", value_name = "PERCENT", default_value_t = 1.0)]
    pub scale_percent: f64,
    /// How much the nail is foreshortened and sheared as it tilts
    #[arg(long = "tilt", value_name = "PERCENT", default_value_t = 1.0)]
    pub tilt_percent: f64,
    /// It jerks away and back, about every second, by up to so much from a frame to the next
    #[arg(long = "jerk", value_name = "PX", default_value_t = 0.0)]
    pub jerk_px: f64,

    /// The light over the thesis' chamber's: 1.4 is as light as a camera takes without bending its curve
    #[arg(long, value_name = "FACTOR", default_value_t = 1.3)]
    pub level: f64,
    /// The light over the picture: so much more at one border, less at the opposite one, in a direction that turns
    #[arg(long = "gradient", value_name = "PERCENT", default_value_t = 0.0)]
    pub gradient_percent: f64,
    /// The light's level goes up and down slowly by so much
    #[arg(long = "light-drift", value_name = "PERCENT", default_value_t = 0.0)]
    pub light_drift_percent: f64,
    /// It flickers by so much
    #[arg(long = "flicker", value_name = "PERCENT", default_value_t = 0.0)]
    pub flicker_percent: f64,
    /// How often it flickers; frames sample it
    #[arg(long, value_name = "HZ", default_value_t = 99.0)]
    pub flicker_hz: f64,
    /// Red goes up by so much while blue goes down, and back, slowly
    #[arg(long = "colour-drift", value_name = "PERCENT", default_value_t = 0.0)]
    pub colour_drift_percent: f64,

    /// Glare moves over the nail, as light as so much of full white's light; what is below it does not count as hidden
    #[arg(long = "glare", value_name = "PERCENT", default_value_t = 0.0)]
    pub glare_percent: f64,
    /// A rod covers part of the nail from this frame on, so many frames long; again for more
    #[arg(long, value_name = "FRAME+N", value_parser = parse_span_of_frames)]
    pub rod: Vec<[usize; 2]>,
    /// Another finger of the same hand lies over part of the nail from this frame on, so many frames long; again for
    /// more
    #[arg(long, value_name = "FRAME+N", value_parser = parse_span_of_frames)]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub finger: Vec<[usize; 2]>,
    /// A cut: another person's nail is in the picture from this frame on, so many frames long; again for more
    #[arg(long, value_name = "FRAME+N", value_parser = parse_span_of_frames)]
    pub cut: Vec<[usize; 2]>,
    /// The hand is out of the picture from this frame on, so many frames long; it takes half a second to leave and to
    /// come back
    #[arg(long, value_name = "FRAME+N", value_parser = parse_span_of_frames)]
    pub leave: Option<[usize; 2]>,

    /// Exposure as a share of the frame interval
    #[arg(long, value_name = "SHARE", default_value_t = 0.0)]
    pub blur: f64,
    /// Standard deviation of the camera's noise in R'G'B', in 255ths of full scale
    #[arg(long, value_name = "SD", default_value_t = 1.0)]
    pub noise: f64,
    /// Write the exact normalized green of every so many frames [default: none; 0.6 MB each]
    #[arg(long = "normalized", value_name = "FRAMES")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normalized_every: Option<usize>,
    /// The encoder's constant rate factor: 0 lossless, 51 worst; x264 and x265 have different scales
    #[arg(long, default_value_t = 18)]
    pub crf: u32,
    /// Codec, preset and colours
    #[command(flatten)]
    #[serde(flatten)]
    pub coding: Coding,
}

impl NailVideoRequest {
    /// The video to make.
    ///
    /// # Errors
    /// A file of places that can't be read.
    pub fn options(&self) -> anyhow::Result<NailVideoOptions> {
        let positions = self.positions_file.as_deref().map(positions).transpose()?;
        Ok(NailVideoOptions { positions, ..self.options.clone() })
    }
}

impl Default for NailVideoOptions {
    fn default() -> Self {
        job::defaults()
    }
}

impl NailVideoOptions {
    /// How long it is, seconds.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.seconds.unwrap_or(match self.protocol {
            NailProtocol::Press => 12.0,
            NailProtocol::Touch | NailProtocol::TouchRandom => 60.0,
            NailProtocol::Rest => 10.0,
            _ => 20.0,
        })
    }

    /// How many frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        ((self.seconds() * self.fps).round() as usize).max(1)
    }

    /// The presses of `--protocol press`.
    #[must_use]
    pub fn presses(&self) -> Option<Presses> {
        let presses =
            Presses { peak_n: self.press_n, held_s: self.held_s, pause_s: self.pause_s, ..Presses::default() };
        (self.protocol == NailProtocol::Press).then_some(presses)
    }

    /// The log of what the finger does and of the sensor that the person wears, on the video's clock.
    #[must_use]
    pub fn log(&self) -> LogOptions {
        let cycles = |which| ForceTrajectory::Cycles { which, hz: CYCLES_HZ };
        let force = match self.protocol {
            NailProtocol::Press => self.presses().map_or(ForceTrajectory::None, ForceTrajectory::Presses),
            NailProtocol::Touch => ForceTrajectory::Spiral(Spiral { duration_s: self.seconds(), ..Spiral::default() }),
            NailProtocol::TouchRandom => ForceTrajectory::Even { hz: RANDOM_HZ, seed: self.seed },
            NailProtocol::Normal => cycles(Cycles::Normal),
            NailProtocol::Lateral => cycles(Cycles::Lateral),
            NailProtocol::Longitudinal => cycles(Cycles::Longitudinal),
            NailProtocol::Bending | NailProtocol::Rest => ForceTrajectory::None,
        };
        let bends = self.protocol == NailProtocol::Bending;
        LogOptions {
            seed: self.seed,
            subject: self.subject,
            session: self.session,
            sensor: SensorModel::Nail,
            positions: self.positions.clone(),
            trajectory: if bends { Trajectory::Eq27 { hz: CYCLES_HZ } } else { Trajectory::Rest },
            force,
            seconds: self.frames() as f64 / self.fps,
            lead_s: 0.0,
            trail_s: 0.0,
            rate_hz: LOG_HZ,
            clock_offset_s: 0.0,
            led: false,
            ambient_v: 0.0,
            ..LogOptions::default()
        }
    }

    /// The curve that the film is read with.
    pub(super) fn curve(&self) -> Curve {
        Curve::of_read(self.coding.matrix().transfer)
    }

    /// How the file's samples are laid out: of 10 bits in HDR, as cameras have it.
    pub(super) fn format(&self) -> Format {
        let (width, height) = self.size;
        let depth = if self.coding.matrix().transfer == Transfer::Power { 8 } else { 10 };
        Format { width: width as usize, height: height as usize, subsampling: Some((2, 2)), depth }
    }
}
