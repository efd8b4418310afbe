//! Photographs of nails, in words.

use super::choices::parse_size;
use crate::phantom::nail::Pose;
use crate::phantom::photos::{FileFormat, LightKind, PhotoOptions};
use clap::Args;

/// What `lunula phantom photos` takes.
#[derive(Debug, Clone, Args)]
pub struct PhotosRequest {
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How many subjects; 16 cover all skin tones
    #[arg(long, default_value_t = 16)]
    subjects: u32,
    /// Which poses, separated by commas [default: all eight]
    #[arg(long, value_delimiter = ',')]
    poses: Vec<Pose>,
    /// Width and height of the photographs, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "640x480", value_parser = parse_size)]
    size: (u32, u32),
    /// Bits per channel
    #[arg(long, default_value_t = 8)]
    depth: u32,
    /// One channel, as through the thesis' green filter
    #[arg(long)]
    grey: bool,
    /// Standard deviation of the sensor's noise, in 255ths of full scale
    #[arg(long, default_value_t = 0.5)]
    noise: f64,
    /// File format of the photographs
    #[arg(long, value_enum, default_value = "png")]
    format: FileFormat,
    /// The thesis' chamber, or dim to bright, tinted, with glare, nails of many sizes up to 30 degrees off upright
    #[arg(long, value_enum, default_value = "varied")]
    light: LightKind,
    /// Draw no outlines beside the photographs
    #[arg(long)]
    no_annotations: bool,
    /// Leave out truth/normalized (0.6 MB a photograph)
    #[arg(long)]
    no_normalized: bool,
}

impl PhotosRequest {
    /// The set that is wanted.
    #[must_use]
    pub fn options(&self) -> PhotoOptions {
        let defaults = PhotoOptions::default();
        PhotoOptions {
            seed: self.seed,
            subjects: self.subjects,
            poses: if self.poses.is_empty() { defaults.poses } else { self.poses.clone() },
            width: self.size.0,
            height: self.size.1,
            depth: self.depth,
            grey: self.grey,
            noise_sd: self.noise,
            format: self.format,
            light: self.light,
            annotate: !self.no_annotations,
            truth_normalized: !self.no_normalized,
            ..defaults
        }
    }
}
