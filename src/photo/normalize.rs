//! Photograph to nail frame: the normalized picture (section 4.2.2, Fig. 53).
//!
//! In: an upright photograph and a [`NailFrame`]. Out: `size` x `size` levels, 65535 being full scale, distal end at
//! the top, `margin` times the nail's box: row i, column j lies at ((j + 0.5 - size/2), (size/2 - i - 0.5)) /
//! (size / margin) in widths and lengths from the centre. What the photograph does not show is not seen, rather than 0.

use image::DynamicImage;

use super::frame::NailFrame;
use super::plane::Channel;
use super::resample;

/// How values between pixels come about; `tradeoff photos` shows what each costs and gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Resample {
    /// The nearest pixel, whatever the scale: what cropping by hand does; aliases.
    Nearest,
    /// Between the four pixels around; averages the footprint.
    Linear,
    /// Cubic convolution without overshoot; averages the footprint.
    #[default]
    Cubic,
}

/// What a normalized picture is made with. Checked by [`Normalization::check`].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Normalization {
    /// Width and height of the result, pixels.
    pub size: usize,
    /// Side of the result in nail boxes; 1.25 shows an eighth of the nail's size around it.
    pub margin: f64,
    /// Which channel of a colour photograph.
    pub channel: Channel,
    /// Undo the sRGB curve first.
    pub linear: bool,
    /// How values between pixels come about.
    pub resample: Resample,
    /// The sample of a 16-bit file that is full scale, as 4095 of 12 bits kept in 16; `None`: 65535. What was written before
    /// there was such a choice reads as `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub white: Option<u16>,
}

impl Default for Normalization {
    /// The thesis' 400 x 400 pixels of 125 % of the nail, green as encoded.
    fn default() -> Self {
        Self { size: 400, margin: 1.25, channel: Channel::Green, linear: false, resample: Resample::Cubic, white: None }
    }
}

impl Normalization {
    /// Sizes that make sense, pixels.
    pub const SIZES: std::ops::RangeInclusive<usize> = 8..=4096;
    /// White levels that make sense: of 8 bits kept in 16, and more.
    pub const WHITES: std::ops::RangeInclusive<u16> = 255..=u16::MAX;
    /// Margins that make sense, in nail boxes.
    pub const MARGINS: std::ops::RangeInclusive<f64> = 1.0..=5.0;

    /// Checks the numbers.
    ///
    /// # Errors
    /// A sentence that names what is out of range and the range.
    pub fn check(self) -> Result<Self, String> {
        if !Self::SIZES.contains(&self.size) {
            return Err(format!(
                "a size of {} px is outside of {}..={}",
                self.size,
                Self::SIZES.start(),
                Self::SIZES.end()
            ));
        }
        if !Self::MARGINS.contains(&self.margin) {
            return Err(format!(
                "a margin of {} nail boxes is outside of {}..={} (1.25 is 125 %)",
                self.margin,
                Self::MARGINS.start(),
                Self::MARGINS.end()
            ));
        }
        if let Some(white) = self.white.filter(|white| !Self::WHITES.contains(white)) {
            return Err(format!(
                "a white level of {white} is outside of {}..={} (4095 is that of 12 bits)",
                Self::WHITES.start(),
                Self::WHITES.end()
            ));
        }
        Ok(self)
    }
}

/// Full scale of a [`Normalized`] picture's levels.
pub const FULL_SCALE: u16 = u16::MAX;

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

impl Normalized {
    /// Fractions of full scale, row by row; NaN where the photograph does not show the place.
    pub fn values(&self) -> impl Iterator<Item = f32> + '_ {
        (0..self.levels.len()).map(|at| self.level(at).map_or(f32::NAN, |l| f32::from(l) / f32::from(FULL_SCALE)))
    }

    /// One pixel's level, where it is seen.
    pub(crate) fn level(&self, at: usize) -> Option<u16> {
        self.seen.as_ref().is_none_or(|seen| seen[at]).then(|| self.levels[at])
    }

    /// How many pixels the photograph shows.
    pub fn count_seen(&self) -> usize {
        self.seen.as_ref().map_or(self.levels.len(), |seen| seen.iter().filter(|&&s| s).count())
    }

    fn nowhere(size: usize) -> Self {
        Self { size, levels: vec![0; size * size], seen: Some(vec![false; size * size]) }
    }

    /// From fractions of full scale, 0 to 1; NaN is not seen.
    pub(crate) fn from_values(size: usize, values: &[f32]) -> Self {
        // Adding 2^23 leaves the rounded number in the sum's lowest bits: branch-free, unlike a saturating cast.
        let mut levels: Vec<u16> =
            values.iter().map(|v| (v * f32::from(FULL_SCALE) + 8_388_608.0).to_bits() as u16).collect();
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
    match resample::values(image, frame, with) {
        Some(values) => Normalized::from_values(with.size, &values),
        None => Normalized::nowhere(with.size),
    }
}
