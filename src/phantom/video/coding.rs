//! How the video of a phantom is encoded, in words.

use clap::Args;
use serde::Serialize;

use crate::video::Codec;

/// Codec and preset: options of every phantom with a video.
#[derive(Debug, Clone, PartialEq, Eq, Args, Serialize)]
pub struct Coding {
    /// Codec of the video
    #[arg(long, value_enum, default_value = "h264")]
    #[serde(skip_serializing_if = "Coding::is_default")]
    pub codec: Codec,
    /// x264's preset, or x265's of the same name
    #[arg(long = "x264", value_name = "PRESET", default_value = "medium", value_parser = Coding::PRESETS)]
    #[serde(rename = "x264")]
    pub preset: String,
}

impl Default for Coding {
    fn default() -> Self {
        Self { codec: Codec::default(), preset: "medium".to_owned() }
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

    /// Whether a record leaves the codec out, as before there was a choice.
    pub(in crate::phantom) fn is_default(codec: &Codec) -> bool {
        *codec == Codec::default()
    }
}
