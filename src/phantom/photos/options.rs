//! What set of photographs is wanted, and the scene of each.

use rand::RngExt;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::phantom::nail::{
    Background, Camera, Depth, Light, NailScene, Pose, RenderOptions, SceneFault, Subject, numbers,
};

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

/// A set of photographs to be made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PhotoOptions {
    /// Everything random follows from it.
    pub seed: u64,
    /// How many subjects.
    pub subjects: u32,
    /// Which poses.
    #[serde(with = "pose_names")]
    pub poses: Vec<Pose>,
    /// Width of the photographs in pixels.
    pub width: u32,
    /// Height of the photographs in pixels.
    pub height: u32,
    /// Bits a channel: 8 or 16.
    pub depth: u32,
    /// One channel, as through a green filter.
    pub grey: bool,
    /// Standard deviation of the sensor's noise, in 255ths of full scale whatever the depth.
    pub noise_sd: f64,
    /// The photographs' file format.
    pub format: FileFormat,
    /// Under which lights.
    pub light: LightKind,
    /// Write the outline beside each photograph.
    pub annotate: bool,
    /// Side of the truth's normalized pictures in pixels.
    pub size: usize,
    /// Side of the normalized picture over the nail's.
    pub margin: f64,
    /// Write each photograph's exact normalized picture (0.64 MB each at size 400).
    pub truth_normalized: bool,
}

impl Default for PhotoOptions {
    fn default() -> Self {
        Self {
            seed: 1,
            subjects: 16,
            poses: Pose::ALL.to_vec(),
            width: 640,
            height: 480,
            depth: 8,
            grey: false,
            noise_sd: 0.5,
            format: FileFormat::Png,
            light: LightKind::Varied,
            annotate: true,
            size: 400,
            margin: 1.25,
            truth_normalized: true,
        }
    }
}

/// Why no set can be made as wanted.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OptionFault {
    /// No subject.
    #[error("a set needs at least one subject")]
    NoSubject,
    /// No pose.
    #[error("a set needs at least one pose")]
    NoPose,
    /// A pose twice.
    #[error("the pose {0} is wanted twice")]
    PoseTwice(Pose),
    /// A depth that no camera has here.
    #[error("{0} bits a channel can't be written; choose 8 or 16")]
    Depth(u32),
    /// 16 bit in a format that holds 8.
    #[error("{} files hold 8 bits a channel, not 16; choose png or tif", .0.extension())]
    DeepFormat(FileFormat),
    /// Noise that is none.
    #[error("a noise of standard deviation {0} can't be drawn; choose 0 or more")]
    Noise(f64),
    /// A normalized picture without pixels.
    #[error("a normalized picture needs at least one pixel a side")]
    Size,
    /// A normalized picture without a nail.
    #[error("a margin of {0} can't be used; choose 1 or more (1.25 leaves an eighth of the nail around it)")]
    Margin(f64),
    /// The photographs can't be drawn.
    #[error(transparent)]
    Scene(#[from] SceneFault),
}

const KIND_SCENE: u32 = 3;

impl PhotoOptions {
    /// Can this set be made?
    ///
    /// # Errors
    /// [`OptionFault`], the first thing that is wrong.
    pub fn check(&self) -> Result<(), OptionFault> {
        if self.subjects == 0 {
            return Err(OptionFault::NoSubject);
        }
        if self.poses.is_empty() {
            return Err(OptionFault::NoPose);
        }
        if let Some((_, &pose)) = self.poses.iter().enumerate().find(|&(k, pose)| self.poses[..k].contains(pose)) {
            return Err(OptionFault::PoseTwice(pose));
        }
        if self.depth != 8 && self.depth != 16 {
            return Err(OptionFault::Depth(self.depth));
        }
        if self.depth == 16 && matches!(self.format, FileFormat::Jpg | FileFormat::Bmp) {
            return Err(OptionFault::DeepFormat(self.format));
        }
        if !(self.noise_sd.is_finite() && self.noise_sd >= 0.0) {
            return Err(OptionFault::Noise(self.noise_sd));
        }
        if self.size == 0 {
            return Err(OptionFault::Size);
        }
        if !(self.margin.is_finite() && self.margin >= 1.0) {
            return Err(OptionFault::Margin(self.margin));
        }
        for subject in 0..self.subjects {
            self.scene(subject, self.poses[0]).check()?;
        }
        Ok(())
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

/// Poses by their names.
mod pose_names {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    use super::Pose;

    pub(super) fn serialize<S: Serializer>(poses: &[Pose], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(poses.iter().map(|pose| pose.name()))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Pose>, D::Error> {
        let names = Vec::<String>::deserialize(deserializer)?;
        names.iter().map(|name| name.parse().map_err(D::Error::custom)).collect()
    }
}
