//! What set of photographs is wanted, and the scene of each.

use clap::{ArgAction, Args};
use rand::RngExt;
use serde::{Deserialize, Serialize};

use crate::job;
use crate::phantom::nail::{Background, Camera, Depth, Light, NailScene, Pose, RenderOptions, Subject, numbers};
use crate::phantom::scene::faults::Faults;

/// The photographs' file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum FileFormat {
    /// PNG, 8 or 16 bit.
    Png,
    /// JPEG of quality 95, 8 bit.
    Jpg,
    /// TIFF, 8 or 16 bit.
    Tif,
    /// BMP, 8 bit.
    Bmp,
}

impl FileFormat {
    /// The files' extension.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Jpg => "jpg",
            Self::Tif => "tif",
            Self::Bmp => "bmp",
        }
    }
}

/// Under which lights the set is photographed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum LightKind {
    /// The thesis' chamber: even, dark behind the finger, no glare, the nail filling most of the picture within 6
    /// degrees of upright.
    Chamber,
    /// Dim to bright, any tint, any background, half of them with glare, nails of many sizes within 30 degrees of
    /// upright.
    Varied,
}

/// A set of photographs to be made: what the command line gives as it is, and what
/// [`PhotosRequest`](crate::phantom::request::PhotosRequest) makes of the rest.
#[derive(Debug, Clone, PartialEq, Args, Serialize, Deserialize)]
pub struct PhotoOptions {
    /// Everything random follows from it.
    #[arg(skip = 1_u64)]
    pub seed: u64,
    /// How many subjects.
    #[arg(skip = 16_u32)]
    pub subjects: u32,
    /// Which poses.
    #[arg(skip = Pose::ALL.to_vec())]
    pub poses: Vec<Pose>,
    /// Width of the photographs in pixels.
    #[arg(skip = 640_u32)]
    pub width: u32,
    /// Height of the photographs in pixels.
    #[arg(skip = 480_u32)]
    pub height: u32,
    /// Bits per channel
    #[arg(long, default_value_t = 8)]
    pub depth: u32,
    /// One channel, as through the thesis' green filter
    #[arg(long)]
    pub grey: bool,
    /// Standard deviation of the sensor's noise, in 255ths of full scale
    #[arg(long = "noise", value_name = "NOISE", default_value_t = 0.5)]
    pub noise_sd: f64,
    /// File format of the photographs
    #[arg(long, value_enum, default_value = "png")]
    pub format: FileFormat,
    /// The thesis' chamber, or dim to bright, tinted, with glare, nails of many sizes up to 30 degrees off upright
    #[arg(long, value_enum, default_value = "varied")]
    pub light: LightKind,
    /// Draw no outlines beside the photographs
    // True unless the option is given.
    #[arg(long = "no-annotations", action = ArgAction::SetFalse)]
    pub annotate: bool,
    /// Side of the truth's normalized pictures in pixels.
    #[arg(skip = 400_usize)]
    pub size: usize,
    /// Side of the normalized picture over the nail's.
    #[arg(skip = 1.25)]
    pub margin: f64,
    /// Leave out truth/normalized (0.6 MB a photograph)
    // True unless the option is given.
    #[arg(long = "no-normalized", action = ArgAction::SetFalse)]
    pub truth_normalized: bool,
}

impl Default for PhotoOptions {
    fn default() -> Self {
        job::defaults()
    }
}

const KIND_SCENE: u32 = 3;

impl PhotoOptions {
    /// Can this set be made?
    ///
    /// # Errors
    /// [`Faults`], the first thing that is wrong.
    pub fn check(&self) -> Result<(), Faults> {
        let refused = |what: String| Err(Faults(vec![what]));
        if self.subjects == 0 {
            return refused("a set needs at least one subject".to_owned());
        }
        if self.poses.is_empty() {
            return refused("a set needs at least one pose".to_owned());
        }
        if let Some((_, pose)) = self.poses.iter().enumerate().find(|&(k, pose)| self.poses[..k].contains(pose)) {
            return refused(format!("the pose {pose} is wanted twice"));
        }
        if self.depth != 8 && self.depth != 16 {
            return refused(format!("{} bits a channel can't be written; choose 8 or 16", self.depth));
        }
        if self.depth == 16 && matches!(self.format, FileFormat::Jpg | FileFormat::Bmp) {
            let format = self.format.extension();
            return refused(format!("{format} files hold 8 bits a channel, not 16; choose png or tif"));
        }
        if !(self.noise_sd.is_finite() && self.noise_sd >= 0.0) {
            let noise_sd = self.noise_sd;
            return refused(format!("a noise of standard deviation {noise_sd} can't be drawn; choose 0 or more"));
        }
        if self.size == 0 {
            return refused("a normalized picture needs at least one pixel a side".to_owned());
        }
        if !(self.margin.is_finite() && self.margin >= 1.0) {
            return refused(format!(
                "a margin of {} can't be used; choose 1 or more (1.25 leaves an eighth of the nail around it)",
                self.margin
            ));
        }
        let fault = (0..self.subjects).find_map(|subject| self.scene(subject, self.poses[0]).check().err());
        fault.map_or(Ok(()), |fault| refused(fault.to_string()))
    }

    /// The name of subject `index`: `s01`, `s02`, ...
    pub fn subject_name(&self, index: u32) -> String {
        let digits = self.subjects.to_string().len().max(2);
        format!("s{:0digits$}", index + 1)
    }

    fn photograph(subject: u32, pose: Pose) -> u32 {
        subject.wrapping_mul(Pose::ALL.len() as u32).wrapping_add(pose as u32)
    }

    /// The scene of one photograph; it does not depend on which others are in the set.
    pub fn scene(&self, subject_index: u32, pose: Pose) -> NailScene {
        let mut rng = numbers(self.seed, KIND_SCENE, Self::photograph(subject_index, pose));
        let subject = Subject::random(self.seed, subject_index);
        let size = [self.width, self.height];
        let (filling, turn_deg) = match self.light {
            LightKind::Chamber => (rng.random_range(0.66..0.74), 6.0),
            LightKind::Varied => (rng.random_range(0.34..0.70), 30.0),
        };
        let mut camera = Camera::close_up(&mut rng, size, subject.nail.aspect, filling, turn_deg);
        let light = match self.light {
            LightKind::Chamber => Light::random_chamber(&mut rng),
            LightKind::Varied => {
                camera.background = Background::random(&mut rng);
                Light::random(&mut rng)
            }
        };
        NailScene { subject, pose, light, camera }
    }

    /// How that scene is photographed.
    pub fn render_options(&self, subject: u32, pose: Pose) -> RenderOptions {
        // One noise a photograph, apart from all others of this seed.
        let noise_seed = self.seed.rotate_left(32) ^ u64::from(Self::photograph(subject, pose));
        let depth = if self.depth == 16 { Depth::Sixteen } else { Depth::Eight };
        RenderOptions { depth, grey: self.grey, noise_sd: self.noise_sd, noise_seed }
    }
}
