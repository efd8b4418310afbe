//! Where chroma samples lie among the luma samples, measured from the video itself.
//!
//! Headers are often silent or wrong, and a centre is biased by up to half a pixel where they are. The chroma's centre
//! of a marker less the luma's is by how much the siting that was assumed is off.

use crate::video::Frame;

/// Where a chroma sample lies, right of and below its block's first luma sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Siting {
    /// To the right, in luma samples.
    pub(crate) dx_px: f64,
    /// Down, in luma samples.
    pub(crate) dy_px: f64,
}

impl Siting {
    /// What most cameras write: on the left, midway between rows.
    pub(crate) fn usual(frame: &Frame<'_>) -> Self {
        let (_, down) = frame.subsampling();
        Self { dx_px: 0.0, dy_px: if down == 2 { 0.5 } else { 0.0 } }
    }
}

impl Siting {
    /// What videos have: as most cameras write, and midway between columns too.
    pub(crate) fn likely(frame: &Frame<'_>) -> [Self; 2] {
        let (across, _) = frame.subsampling();
        let usual = Self::usual(frame);
        [usual, Self { dx_px: if across == 2 { 0.5 } else { 0.0 }, ..usual }]
    }
}

/// Fits that are needed to tell.
const LEAST_FITS: usize = 6;
/// How near the mean has to come to a siting, and how sure it has to be.
const NEAR_PX: f64 = 0.18;
const SURE_PX: f64 = 0.04;
/// A fit's shift is not surer than this, whatever its noise.
const LEAST_SD_PX: f64 = 0.05;

/// What fits made with one siting tell of the true one.
#[derive(Debug, Clone)]
pub(crate) struct SitingEvidence {
    /// The siting that fits are made with.
    pub(crate) assumed: Siting,
    subsampling: (usize, usize),
    fits: usize,
    weight: f64,
    sum: [f64; 2],
    squares: [f64; 2],
}

impl SitingEvidence {
    /// For fits that are made with `assumed`.
    pub(crate) fn new(assumed: Siting, subsampling: (usize, usize)) -> Self {
        Self { assumed, subsampling, fits: 0, weight: 0.0, sum: [0.0; 2], squares: [0.0; 2] }
    }

    /// Takes in a marker's chroma centre less its luma centre, and the standard error of both coordinates.
    pub(crate) fn push(&mut self, chroma_shift_px: Option<([f64; 2], f64)>) {
        let Some((shift, sd)) = chroma_shift_px else { return };
        let weight = 1.0 / (sd * sd + LEAST_SD_PX * LEAST_SD_PX);
        if !(weight.is_finite() && shift.iter().all(|v| v.is_finite())) {
            return;
        }
        self.fits += 1;
        self.weight += weight;
        for (axis, along) in shift.into_iter().enumerate() {
            self.sum[axis] += weight * along;
            self.squares[axis] += weight * along * along;
        }
    }

    /// The siting, where the fits agree on one.
    pub(crate) fn siting(&self) -> Option<Siting> {
        if self.fits < LEAST_FITS {
            return None;
        }
        let along = |axis: usize, assumed: f64, samples: usize| {
            if samples == 1 {
                return Some(0.0);
            }
            let mean = self.sum[axis] / self.weight;
            let variance = (self.squares[axis] / self.weight - mean * mean).max(0.0) / self.fits as f64;
            if variance.sqrt() > SURE_PX {
                return None;
            }
            [0.0, 0.5].into_iter().find(|site| (assumed - mean - site).abs() <= NEAR_PX)
        };
        Some(Siting {
            dx_px: along(0, self.assumed.dx_px, self.subsampling.0)?,
            dy_px: along(1, self.assumed.dy_px, self.subsampling.1)?,
        })
    }
}
