//! Photographs of nails, in words.

use super::choices::parse_size;
use crate::phantom::nail::Pose;
use crate::phantom::photos::PhotoOptions;
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
    #[command(flatten)]
    photos: PhotoOptions,
}

impl PhotosRequest {
    /// The set that is wanted.
    #[must_use]
    pub fn options(&self) -> PhotoOptions {
        PhotoOptions {
            seed: self.seed,
            subjects: self.subjects,
            poses: if self.poses.is_empty() { Pose::ALL.to_vec() } else { self.poses.clone() },
            width: self.size.0,
            height: self.size.1,
            ..self.photos.clone()
        }
    }
}
