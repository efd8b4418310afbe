//! Photograph to nail frame: the normalized picture (section 4.2.2, Fig. 53).
//!
//! In: an upright photograph and a [`NailFrame`]. Out: `size` x `size` levels, 65535 being full scale, distal end at
//! the top, `margin` times the nail's box: row i, column j lies at ((j + 0.5 - size/2), (size/2 - i - 0.5)) /
//! (size / margin) in widths and lengths from the centre. What the photograph does not show is not seen, rather than 0.

mod detail;
mod frame;
mod options;
mod plane;
mod resample;

use image::DynamicImage;

use crate::photo::outline::Outline;

pub(crate) use detail::{SHARP, detail};
pub use frame::{FrameFault, NailFrame, SMALLEST_EXTENT_PX};
pub use options::{Normalization, Resample};
pub use plane::Channel;
pub(super) use plane::linear_from_srgb;

/// Full scale of a [`Normalized`] picture's levels.
pub const FULL_SCALE: u16 = u16::MAX;

/// The level from which on a place counts as being at full scale: most of its pixels are, and it may be brighter.
pub(crate) const AT_FULL_SCALE: u16 = (0.99 * FULL_SCALE as f64) as u16;
/// The share of a nail at full scale from which on its values are doubted. Of 239 outlines on 26 real hands, detected
/// and drawn, 0.0001 at most are; with 1.8 times the exposure it is more on 188 of 221, a third to all of the nail.
pub(crate) const MOST_AT_FULL_SCALE: f64 = 0.01;

/// A normalized picture, quantized to 16 bits whatever the source's depth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Normalized {
    /// Width and height, pixels.
    pub size: usize,
    /// Row by row from the top (distal), 0 to [`FULL_SCALE`]; 0 where not seen.
    pub levels: Vec<u16>,
    /// Which pixels the photograph shows; `None` where it shows them all.
    pub seen: Option<Vec<bool>>,
}

/// Of the levels of a normalized picture that are seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Survey {
    pub(crate) seen: u64,
    pub(crate) sum: u64,
    pub(crate) squares: u64,
    pub(crate) greatest: u16,
    /// How many are there, to a tenth of a step of 8 bits.
    pub(crate) at_greatest: u64,
}

impl Survey {
    fn of(levels: impl Iterator<Item = u16> + Clone) -> Self {
        let greatest = levels.clone().max().unwrap_or(0);
        let mut survey = Self { seen: 0, sum: 0, squares: 0, greatest, at_greatest: 0 };
        for level in levels {
            survey.seen += 1;
            survey.sum += u64::from(level);
            survey.squares += u64::from(level).pow(2);
            survey.at_greatest += u64::from(greatest - level <= SAME_LEVEL);
        }
        survey
    }

    /// The mean, a fraction of full scale.
    pub(crate) fn mean(&self) -> f64 {
        self.sum as f64 / self.seen.max(1) as f64 / f64::from(FULL_SCALE)
    }
}

/// A tenth of a step of 8 bits.
const SAME_LEVEL: u16 = FULL_SCALE / 2550;

impl Normalized {
    /// Fractions of full scale, row by row; NaN where the photograph does not show the place.
    pub fn values(&self) -> impl Iterator<Item = f32> + '_ {
        (0..self.levels.len()).map(|at| self.level(at).map_or(f32::NAN, |l| f32::from(l) / f32::from(FULL_SCALE)))
    }

    /// One pixel's level, where it is seen.
    pub(crate) fn level(&self, at: usize) -> Option<u16> {
        self.seen.as_ref().is_none_or(|seen| seen[at]).then(|| self.levels[at])
    }

    /// The share of the nail that is at full scale: of the ellipse within its box.
    pub(crate) fn at_full_scale(&self, margin: f64) -> f64 {
        // Of most pictures nothing is, which a look at the levels alone shows.
        if self.levels.iter().all(|level| *level < AT_FULL_SCALE) {
            return 0.0;
        }
        let in_nails = |k: usize| ((k as f64 + 0.5) / self.size as f64 - 0.5) * margin;
        let is_nail = |at: &usize| in_nails(at % self.size).hypot(in_nails(at / self.size)) <= 0.5;
        let (mut all, mut bright) = (0_usize, 0_usize);
        for level in (0..self.levels.len()).filter(is_nail).filter_map(|at| self.level(at)) {
            all += 1;
            bright += usize::from(level >= AT_FULL_SCALE);
        }
        bright as f64 / all.max(1) as f64
    }

    /// What distinguishes it from other pictures, and shows a camera's end of range.
    pub(crate) fn survey(&self) -> Survey {
        match self.seen {
            // Most are seen whole, and a plain run of levels takes an eighth of the time.
            None => Survey::of(self.levels.iter().copied()),
            Some(_) => Survey::of((0..self.levels.len()).filter_map(|at| self.level(at))),
        }
    }

    fn nowhere(size: usize) -> Self {
        Self { size, levels: vec![0; size * size], seen: Some(vec![false; size * size]) }
    }

    /// From fractions of full scale, 0 to 1; NaN is not seen.
    #[cfg(test)]
    pub(crate) fn from_values(size: usize, values: &[f32]) -> Self {
        Self::from_values_in(Vec::new(), size, values)
    }

    fn from_values_in(mut levels: Vec<u16>, size: usize, values: &[f32]) -> Self {
        levels.clear();
        // Adding 2^23 leaves the rounded number in the sum's lowest bits: branch-free, unlike a saturating cast.
        levels.extend(values.iter().map(|v| (v * f32::from(FULL_SCALE) + 8_388_608.0).to_bits() as u16));
        let some_unseen = values.iter().fold(false, |some, v| some | v.is_nan());
        let seen = some_unseen.then(|| {
            for (level, value) in levels.iter_mut().zip(values) {
                if value.is_nan() {
                    *level = 0;
                }
            }
            values.iter().map(|v| !v.is_nan()).collect()
        });
        Self { size, levels, seen }
    }
}

/// Brings a nail into its frame.
pub fn normalize(image: &DynamicImage, frame: &NailFrame, with: &Normalization) -> Normalized {
    Normalizer::default().normalize(image, frame, with)
}

/// Share of the nail's box outside of the photograph above which it is left out (assumed): of a nail of which less than
/// half is seen, length and width are guessed, and the outline is rather another picture's. Below, what is not seen is
/// missing.
const MOST_OUTSIDE: f64 = 0.5;

/// Brings a nail into its frame as a run does, or says why a run leaves it out.
pub(crate) fn normalized_or_why(
    image: &DynamicImage,
    (outline, frame): (&Outline, &NailFrame),
    with: &Normalization,
    normalizer: &mut Normalizer,
) -> Result<Normalized, String> {
    let size = [image.width(), image.height()];
    if let Some(doubt) = frame.doubt(outline, size) {
        return Err(doubt);
    }
    let outside = frame.share_outside(size);
    if outside > MOST_OUTSIDE {
        return Err(format!(
            "{:.0} % of its box lies outside of the photograph ({} x {} px), more than {:.0} %; is the outline \
             another picture's?",
            100.0 * outside,
            size[0],
            size[1],
            100.0 * MOST_OUTSIDE
        ));
    }
    let normalized = normalizer.normalize(image, frame, with);
    if normalized.seen.as_ref().is_some_and(|seen| !seen.contains(&true)) {
        return Err("the photograph shows nothing of it (transparent or outside)".into());
    }
    Ok(normalized)
}

/// Brings nails into their frames, one after the other, in the same memory.
#[derive(Default)]
pub(crate) struct Normalizer {
    buffers: resample::Buffers,
    levels: Vec<Vec<u16>>,
}

impl Normalizer {
    /// As [`normalize`].
    pub(super) fn normalize(&mut self, image: &DynamicImage, frame: &NailFrame, with: &Normalization) -> Normalized {
        if !resample::values(image, frame, with, &mut self.buffers) {
            return Normalized::nowhere(with.size);
        }
        Normalized::from_values_in(self.levels.pop().unwrap_or_default(), with.size, &self.buffers.values)
    }

    /// Takes back the memory of a picture that is done with.
    pub(super) fn take_back(&mut self, picture: Normalized) {
        self.levels.push(picture.levels);
    }
}
