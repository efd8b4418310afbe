//! Videos of a finger with coloured markers, in words.

use clap::Args;

use super::choices::{parse_colour, parse_hide, parse_leave, parse_plane, parse_size, trajectory};
use super::clock::ClockArgs;
use crate::flexion::Flexion;
use crate::job::one_of;
use crate::phantom::motion::finger::{Finger, MarkerLayout};
use crate::phantom::motion::trajectory::Trajectory;
use crate::phantom::video::{Chroma, Coding, Colours, Hide, Leave, Lens, Oblique, Preset, Siting, VideoOptions};
use crate::video::Turn;

/// What `lunula phantom video` takes.
#[derive(Debug, Clone, Args)]
pub struct VideoRequest {
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The scene to start from
    #[arg(long, value_enum, default_value = "clean")]
    scene: Preset,
    /// Width and height of the picture, pixels; the finger grows with the width
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Frames per second
    #[arg(long)]
    fps: Option<f64>,
    /// How long [default: 10, or as long as a given trajectory]
    #[arg(long)]
    seconds: Option<f64>,
    /// Variable frame rate: intervals differ by up to this share of the mean one, and some frames are dropped
    #[arg(long, value_name = "SHARE", num_args = 0..=1, default_missing_value = "0.4")]
    vfr: Option<f64>,

    /// Joint angles over time: eq27, free (fully flexed to fully extended and back), random, even (random, all over
    /// equation 27's range), rest (straight and still), sway (straight, as people rest), or a table (CSV or Parquet)
    /// with time_s, J1_deg, J2_deg, J3_deg
    #[arg(long, value_name = "eq27|free|random|even|rest|sway|FILE")]
    trajectory: Option<String>,
    /// Bending rate f of equation 27; random movement has rates of 0.4 to 4 times it
    #[arg(long, value_name = "HZ")]
    bend_hz: Option<f64>,
    /// How well the finger follows, as of a log of the same seed: the standard deviation of its error as a share, about
    /// 0.3 s late
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, allow_negative_numbers = true)]
    follow: f64,
    /// How flexion turns a segment on the picture
    #[arg(long, value_enum, default_value = "clockwise")]
    flexion: Flexion,
    /// Where the markers are; blots of paint (paint, thumb, row, mark) come as in a real recording: 24 frames a second,
    /// a second hand
    #[arg(long, value_enum, default_value = "pairs")]
    layout: MarkerLayout,
    /// The markers' colours [default: pairs; with paint: dark]
    #[arg(long, value_enum)]
    colours: Option<Colours>,
    /// Joints that the marker file asks for, separated by commas [default: all, which are J1,J2,J3, and with paint the
    /// thumb's T1,T2]
    #[arg(long, value_delimiter = ',')]
    joints: Vec<String>,
    /// Write the markers' places in the first frame into the marker file [default: with marks of paint of one colour]
    #[arg(long)]
    start: bool,
    /// Do not write them
    #[arg(long, conflicts_with = "start")]
    no_start: bool,
    /// How far the whole finger sways, pixels
    #[arg(long, value_name = "PX")]
    sway: Option<f64>,
    /// A stick covers this marker from this frame on, so many frames long; again for more
    #[arg(long, value_name = "NAME@FRAME+N", value_parser = parse_hide)]
    hide: Vec<Hide>,
    /// Hide no marker, whatever the scene
    #[arg(long, conflicts_with = "hide")]
    no_hide: bool,
    /// The fingertip is out of the picture from this frame on, so many frames long
    #[arg(long, value_name = "FRAME+N", value_parser = parse_leave)]
    leave: Option<Leave>,
    /// Blobs of three marker colours elsewhere in the picture, still and moving; with paint, dark spots on the other
    /// hand
    #[arg(long, value_name = "N")]
    distractors: Option<usize>,
    /// Colour of the desk
    #[arg(long, value_name = "#RRGGBB", value_parser = parse_colour)]
    desk: Option<u32>,

    /// Exposure as a share of the frame interval
    #[arg(long, value_name = "SHARE")]
    blur: Option<f64>,
    /// A rolling shutter takes the stored picture's last row so long after its first; the marker file says it. The
    /// truth is of the first row's moment
    #[arg(long, value_name = "MS")]
    readout: Option<f64>,
    /// The light's brightness goes up and down by so many per cent
    #[arg(long, value_name = "PERCENT")]
    flicker: Option<f64>,
    /// How often the light flickers; frames sample it [default: 100]
    #[arg(long, value_name = "HZ")]
    flicker_hz: Option<f64>,
    /// The light's brightness over the picture: so many per cent more at the top left, less at the bottom right
    #[arg(long, value_name = "PERCENT")]
    gradient: Option<f64>,
    /// Standard deviation of the sensor's noise in R'G'B', in 255ths of full scale
    #[arg(long, value_name = "SD")]
    noise: Option<f64>,
    /// Standard deviation of the Gaussian that every edge is seen through [default: 0.55]
    #[arg(long, value_name = "PX")]
    focus: Option<f64>,
    /// The lens, OpenCV's model; the marker file gets its [camera]
    #[arg(long, value_name = "k1,k2,p1,p2,k3,..", value_delimiter = ',', allow_hyphen_values = true)]
    distortion: Vec<f64>,
    /// The lens' focal length [default: 1200 where the picture is 1280 wide]
    #[arg(long, value_name = "PX", requires = "distortion")]
    fx: Option<f64>,
    /// The camera looks obliquely at the plane in which the finger moves: so many degrees off straight, and the
    /// direction on the picture in which that plane recedes, clockwise from the right, as 30 or 30,90; the marker file
    /// gets its [camera.plane]
    #[arg(long, value_name = "TILT[,TOWARDS]", value_parser = parse_plane, allow_hyphen_values = true)]
    plane: Option<Oblique>,

    #[command(flatten)]
    clock: ClockArgs,

    /// Samples use all values, not the limited range
    #[arg(long)]
    full_range: bool,
    /// Where chroma samples lie: left as in most camera files, or centre as in files that swscale converted from RGB
    #[arg(long, value_enum, default_value = "left")]
    siting: Siting,
    /// What the file's header says of that [default: nothing]
    #[arg(long, value_enum)]
    stated_siting: Option<Siting>,
    /// The stored picture is turned back by so many degrees, and the file says to turn it clockwise to show it
    #[arg(long, value_parser = one_of::<Turn>(), default_value = "0")]
    rotate: Turn,
    /// Chroma of the video: 4:2:0, 4:2:2, 4:4:4, none
    #[arg(long, value_enum, default_value = "420")]
    format: Chroma,
    /// Bits a sample: 8 or 10
    #[arg(long, default_value_t = 8)]
    depth: u32,
    /// The encoder's constant rate factor: 0 lossless, 51 worst; x264 and x265 have different scales
    #[arg(long)]
    crf: Option<u32>,
    #[command(flatten)]
    coding: Coding,
}

impl VideoRequest {
    /// The video that is wanted.
    ///
    /// # Errors
    /// A trajectory's table that can't be read.
    pub fn options(&self) -> anyhow::Result<VideoOptions> {
        let mut options = VideoOptions::new(self.scene);
        options.seed = self.seed;
        let given = |option: &mut f64, value: Option<f64>, scale: f64| {
            if let Some(value) = value {
                *option = scale * value;
            }
        };
        let before = options.width as f64;
        if let Some((width, height)) = self.size {
            (options.width, options.height) = (width as usize, height as usize);
        }
        options.sway_px *= options.width as f64 / before;
        self.settle_finger(&mut options)?;
        given(&mut options.fps, self.fps, 1.0);
        given(&mut options.seconds, self.seconds, 1.0);
        given(&mut options.jitter, self.vfr, 1.0);
        given(&mut options.sway_px, self.sway, 1.0);
        given(&mut options.blur, self.blur, 1.0);
        given(&mut options.readout_s, self.readout, 1e-3);
        given(&mut options.flicker, self.flicker, 0.01);
        given(&mut options.flicker_hz, self.flicker_hz, 1.0);
        given(&mut options.gradient, self.gradient, 0.01);
        given(&mut options.noise_sd, self.noise, 1.0);
        given(&mut options.focus_px, self.focus, 1.0);
        if self.no_hide || !self.hide.is_empty() {
            options.hide.clone_from(&self.hide);
        }
        options.leave = self.leave;
        options.distractors = self.distractors.unwrap_or(options.distractors);
        options.desk = self.desk.unwrap_or(options.desk);
        options.lens =
            (!self.distortion.is_empty()).then(|| Lens { fx_px: self.fx, distortion: self.distortion.clone() });
        options.plane = self.plane;
        self.clock.settle(&mut options);
        options.matrix = self.coding.matrix();
        options.matrix.full_range = self.full_range;
        options.siting = self.siting;
        options.stated_siting = self.stated_siting;
        options.turn = self.rotate;
        options.chroma = self.format;
        options.depth = self.depth;
        options.crf = self.crf.unwrap_or(options.crf);
        options.codec = self.coding.codec;
        options.preset = self.coding.known_preset().unwrap_or(options.preset);
        options.start = self.start || (options.start && !self.no_start);
        if !self.joints.is_empty() {
            options.joints.clone_from(&self.joints);
        }
        Ok(options)
    }

    /// The finger, its markers and how it moves.
    fn settle_finger(&self, options: &mut VideoOptions) -> anyhow::Result<()> {
        let layout = self.layout;
        options.finger = Finger::new(options.width, options.height, self.flexion, layout);
        if layout.painted() {
            *options = options.clone().painted(layout);
            // The scene's hidden marker is none of these.
            options.hide.clear();
        }
        options.colours = self.colours.unwrap_or(options.colours);
        options.start &= matches!(options.colours, Colours::Red | Colours::Dark | Colours::Pale);
        if layout == MarkerLayout::Joints {
            // The scene's hidden marker by its name in this layout.
            options.hide.iter_mut().for_each(|hide| hide.marker = "dip".to_owned());
        }
        let scenes_hz = match options.trajectory {
            Trajectory::Eq27 { hz } | Trajectory::Random { hz, .. } | Trajectory::Even { hz, .. } => hz,
            _ => 0.1,
        };
        let hz = self.bend_hz.unwrap_or(scenes_hz);
        let (movement, span_s) = trajectory(self.trajectory.as_deref().unwrap_or("eq27"), hz, self.seed)?;
        options.trajectory = if self.follow == 0.0 {
            movement
        } else {
            Trajectory::Followed { prompted: Box::new(movement), share: self.follow, seed: self.seed }
        };
        if let Some(span_s) = span_s {
            options.seconds = span_s.max(1.0 / options.fps);
        }
        Ok(())
    }
}
