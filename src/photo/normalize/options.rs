//! What normalized pictures are made with.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use super::plane::Channel;
use crate::job;

/// How values between pixels come about; `tradeoff photos` shows what each costs and gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Resample {
    /// The nearest pixel, whatever the scale: what cropping by hand does; aliases
    Nearest,
    /// Between the four pixels around; averages the footprint
    Linear,
    /// Cubic convolution without overshoot; averages the footprint
    #[default]
    Cubic,
}

/// What a normalized picture is made with. Checked by [`Normalization::check`].
#[derive(Debug, Clone, Copy, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
pub struct Normalization {
    /// Width and height of the normalized pictures, pixels
    #[arg(long, default_value_t = 400, value_parser = |text: &str| within(text, Self::SIZES, "px"))]
    pub size: usize,
    /// Side of the normalized pictures, as a multiple of the nail's box
    #[arg(
        long,
        default_value_t = 1.25,
        value_parser = |text: &str| within(text, Self::MARGINS, "nail boxes (1.25 is 125 %)")
    )]
    pub margin: f64,
    /// Channel of colour photographs to use
    #[arg(long, value_enum, default_value = "green")]
    pub channel: Channel,
    /// Undo the sRGB curve, so that values are proportional to light
    #[arg(long)]
    pub linear: bool,
    /// How to interpolate between pixels
    #[arg(long, value_enum, default_value = "cubic")]
    pub resample: Resample,
    /// Sample value of 16-bit files that is full scale: 4095 where 12 bits are kept in 16 [default: 65535]
    // Files written before there was such a choice read as `None`.
    #[arg(
        long,
        value_name = "SAMPLE",
        value_parser = |text: &str| within(text, Self::WHITES, "(4095 is that of 12 bits)")
    )]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub white: Option<u16>,
}

impl Default for Normalization {
    /// The thesis' 400 x 400 pixels of 125 % of the nail, green as encoded.
    fn default() -> Self {
        job::defaults()
    }
}

/// A number of a range, `of` something.
fn within<T: FromStr + PartialOrd + Display>(text: &str, range: RangeInclusive<T>, of: &str) -> Result<T, String> {
    let number = text.trim().parse().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| format!("write a number of {} to {} {of}", range.start(), range.end()))
}

impl Normalization {
    /// Sizes that make sense, pixels.
    pub const SIZES: RangeInclusive<usize> = 8..=4096;
    /// White levels that make sense: of 8 bits kept in 16, and more.
    pub const WHITES: RangeInclusive<u16> = 255..=u16::MAX;
    /// Margins that make sense, in nail boxes.
    pub const MARGINS: RangeInclusive<f64> = 1.0..=5.0;

    /// Checks numbers that a file gives.
    ///
    /// # Errors
    /// Which is out of range.
    pub fn check(self) -> Result<Self, String> {
        let wrong = |what: &str, value: &dyn Display| Err(format!("its {what} is {value}"));
        match self {
            Self { size, .. } if !Self::SIZES.contains(&size) => wrong("size in pixels", &size),
            Self { margin, .. } if !Self::MARGINS.contains(&margin) => wrong("margin in nail boxes", &margin),
            Self { white: Some(white), .. } if !Self::WHITES.contains(&white) => wrong("white level", &white),
            _ => Ok(self),
        }
    }
}
