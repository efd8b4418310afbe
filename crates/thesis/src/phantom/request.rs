//! A study, in words.

use clap::Args;

use super::StudyOptions;
use lunula::phantom::request::parse_size;

/// What `lunula phantom study` takes.
#[derive(Debug, Clone, Args)]
pub struct StudyRequest {
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How many people are photographed; 16 cover all skin tones
    #[arg(long, value_name = "N", default_value_t = 16)]
    subjects: u32,
    /// How many of them wear the sensor [default: 7 as in 5.3.1, or all where there are fewer]
    #[arg(long, value_name = "N")]
    sensors: Option<u32>,
    /// How many of them press slowly and quickly [default: 8 as in 4.3.4, or all where there are fewer]
    #[arg(long, value_name = "N")]
    presses: Option<u32>,
    /// Width and height of the videos, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "640x360", value_parser = parse_size)]
    video_size: (u32, u32),
    /// Frames per second
    #[arg(long, default_value_t = 30.0)]
    fps: f64,
    /// How long the finger bends before the camera
    #[arg(long, default_value_t = 60.0)]
    seconds: f64,
}

impl StudyRequest {
    /// The study that is wanted.
    #[must_use]
    pub fn options(&self) -> StudyOptions {
        let usual = StudyOptions::default();
        StudyOptions {
            seed: self.seed,
            subjects: self.subjects,
            sensors: self.sensors.unwrap_or(usual.sensors.min(self.subjects)),
            presses: self.presses.unwrap_or(usual.presses.min(self.subjects)),
            width: self.video_size.0 as usize,
            height: self.video_size.1 as usize,
            fps: self.fps,
            seconds: self.seconds,
        }
    }
}
