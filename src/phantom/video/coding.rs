//! How the video of a phantom is encoded, in words.

use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::phantom::scene::place::is_default;
use crate::video::{Codec, Matrix};

/// How R'G'B' are encoded, as the command line has it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, ValueEnum)]
pub enum ColourMatrix {
    /// ITU-R BT.601
    #[value(name = "601")]
    #[serde(rename = "601")]
    Bt601,
    /// ITU-R BT.709
    #[default]
    #[value(name = "709")]
    #[serde(rename = "709")]
    Bt709,
    /// ITU-R BT.2020
    #[value(name = "2020")]
    #[serde(rename = "2020")]
    Bt2020,
    /// BT.2020 in hybrid log-gamma, the HDR of most phones
    #[serde(rename = "hlg")]
    Hlg,
    /// BT.2020 with the perceptual quantizer, HDR as well
    #[serde(rename = "pq")]
    Pq,
}

/// Codec, preset and colours: options of every phantom with a video.
#[derive(Debug, Clone, PartialEq, Eq, Args, Serialize)]
pub struct Coding {
    /// Codec of the video
    #[arg(long, value_enum, default_value = "h264")]
    #[serde(skip_serializing_if = "is_default")]
    pub codec: Codec,
    /// x264's preset, or x265's of the same name
    #[arg(long = "x264", value_name = "PRESET", default_value = "medium", value_parser = Coding::PRESETS)]
    #[serde(rename = "x264")]
    pub preset: String,
    /// The video's colour matrix
    #[arg(long, value_enum, default_value = "709")]
    #[serde(skip_serializing_if = "is_default")]
    pub matrix: ColourMatrix,
}

impl Default for Coding {
    fn default() -> Self {
        Self { codec: Codec::default(), preset: "medium".to_owned(), matrix: ColourMatrix::default() }
    }
}

impl Coding {
    /// Presets that can be asked for, fastest first.
    pub const PRESETS: [&str; 9] =
        ["ultrafast", "superfast", "veryfast", "faster", "fast", "medium", "slow", "slower", "veryslow"];

    /// The preset as encoders take it; none where there is no such preset.
    #[must_use]
    pub fn known_preset(&self) -> Option<&'static str> {
        Self::PRESETS.into_iter().find(|name| *name == self.preset)
    }

    /// The matrix, of limited range.
    #[must_use]
    pub fn matrix(&self) -> Matrix {
        match self.matrix {
            ColourMatrix::Bt601 => Matrix::BT601,
            ColourMatrix::Bt709 => Matrix::BT709,
            ColourMatrix::Bt2020 => Matrix::BT2020,
            ColourMatrix::Hlg => Matrix::HLG,
            ColourMatrix::Pq => Matrix::PQ,
        }
    }
}
