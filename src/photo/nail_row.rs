//! One nail of a run's result.

use super::frame::NailFrame;
use super::outline::{Axis, Source};

/// One nail of the result: a row of `nails.csv`.
#[derive(Debug, Clone)]
pub struct NailRow {
    /// Index of its photograph in the set.
    pub photo: usize,
    /// Counted from 1 within the photograph.
    pub number: usize,
    /// Where its outline came from.
    pub source: Source,
    /// 0 to 1, missing where nothing is known.
    pub confidence: Option<f64>,
    /// Its box, where there is one.
    pub frame: Option<NailFrame>,
    /// Its axis may be known where its box is not.
    pub axis: Option<Axis>,
    /// Name of its normalized picture among the results, if those are written; `None` where it was left out.
    pub normalized: Option<String>,
    /// Why it was left out, or what of it the photograph does not show; else empty.
    pub reason: String,
    /// A small normalized picture for the report's sheet.
    pub(crate) thumbnail: Option<image::GrayAlphaImage>,
}
