//! What normalized pictures are made with.

use super::plane::Channel;

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
    /// The sample of a 16-bit file that is full scale, as 4095 of 12 bits kept in 16; `None`: 65535. What was written
    /// before there was such a choice reads as `None`.
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
