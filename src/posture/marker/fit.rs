//! What a frame shows of a marker.

use super::blot::Outline;
use super::sight::Centre;

/// What a frame shows of a marker.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fit {
    pub(crate) centre: Centre,
    /// The covariance as it would be if the noise were independent from sample to sample.
    pub(crate) white_px2: [f64; 3],
    /// Y', Cb, Cr of the disc.
    pub(crate) marker: [f64; 3],
    /// Y', Cb, Cr around it.
    pub(crate) background: [f64; 3],
    /// Standard deviation of the Gaussian that luma's edge is seen through.
    pub(crate) blur_px: f64,
    /// What is left unexplained within the marker, over its contrast, both squared.
    pub(crate) misfit: f64,
    /// Standard deviation of what is left unexplained in each plane.
    pub(crate) noise: [f64; 3],
    /// Chroma's centre less luma's, and the standard error of both coordinates (independent noise).
    pub(crate) chroma_shift_px: Option<([f64; 2], f64)>,
    /// What a blot's centre is the centroid of; none for a disc.
    pub(crate) outline: Option<Outline>,
    /// Its centre is held near where its colour lies, beside that of the fitted disc.
    pub(crate) is_held: bool,
}

impl Fit {
    /// Its centre may be off by so much either way for as long as the marker looks so.
    pub(crate) fn doubt(&mut self, sd_px: f64) {
        for axis in [0, 2] {
            self.centre.covariance_px2[axis] += sd_px * sd_px;
            self.centre.lasting_px2[axis] += sd_px * sd_px;
        }
    }
}
