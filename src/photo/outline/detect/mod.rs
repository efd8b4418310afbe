//! shim
#![allow(missing_docs)]
use super::{Axis, Outline};
#[derive(Debug, Clone)]
pub struct DetectOptions {
    pub working_size_px: u32,
    pub min_confidence: f64,
}
impl Default for DetectOptions {
    fn default() -> Self {
        Self { working_size_px: 320, min_confidence: 0.5 }
    }
}
#[derive(Debug, Clone)]
pub struct Detected {
    pub outline: Outline,
    pub axis: Axis,
    pub confidence: f64,
}
pub struct Detections {
    pub nails: Vec<Detected>,
    pub doubtful: Vec<Detected>,
    pub note: String,
}
pub fn detect(_: &image::DynamicImage, _: &DetectOptions) -> Detections {
    Detections { nails: vec![], doubtful: vec![], note: "shim".into() }
}
