//! FFmpeg and OpenCV as they are linked. Only the program that reads video has them; it tells the other.

use ffmpeg_next as ffmpeg;
use serde::{Deserialize, Serialize};

/// Decoders that cameras and telephones make use of, by FFmpeg's names.
const DECODERS: [&str; 8] = ["h264", "hevc", "mjpeg", "mpeg4", "prores", "vp9", "ffv1", "rawvideo"];
/// Writes all of lunula's videos.
const ENCODER: &str = "libx264";

/// Versions of the libraries that read and write video and of OpenCV, and which of FFmpeg's codecs are not there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Libraries {
    /// lunula's own version: both programs have to be of the same.
    pub lunula: String,
    /// Each of FFmpeg's libraries with its version.
    pub ffmpeg: Vec<String>,
    /// Its version.
    pub opencv: String,
    /// Decoders that are not there.
    pub no_decoder: Vec<String>,
    /// The encoder of H.264, if it is not there.
    pub no_encoder: Option<String>,
}

/// What the program that reads video says of itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Linked {
    /// It runs, with these libraries.
    Runs(Libraries),
    /// It does not, in the system's words.
    Fails(String),
}

/// The libraries of the program that asks.
#[must_use]
pub fn libraries() -> Libraries {
    let _ = ffmpeg::init();
    let version = |name: &str, packed: u32| format!("{name} {}.{}.{}", packed >> 16, (packed >> 8) & 255, packed & 255);
    Libraries {
        lunula: env!("CARGO_PKG_VERSION").to_owned(),
        ffmpeg: vec![
            version("libavformat", ffmpeg::format::version()),
            version("libavcodec", ffmpeg::codec::version()),
            version("libswscale", ffmpeg::software::scaling::version()),
            version("libavutil", ffmpeg::util::version()),
        ],
        opencv: opencv::core::get_version_string().unwrap_or_else(|why| format!("unknown ({why})")),
        no_decoder: DECODERS
            .iter()
            .filter(|name| ffmpeg::decoder::find_by_name(name).is_none())
            .map(|&name| name.to_owned())
            .collect(),
        no_encoder: ffmpeg::encoder::find_by_name(ENCODER).is_none().then(|| ENCODER.to_owned()),
    }
}
