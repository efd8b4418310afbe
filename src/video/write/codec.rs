//! Codecs that videos are written in, each with its encoder's own settings.

use clap::ValueEnum;
use ffmpeg_next::Dictionary;
use serde::Serialize;

/// x264's threads: part of what decides its bytes.
const X264_THREADS: usize = 4;
/// x265 says nothing, leaves its version, its settings and the processor's name out of the file, and works in one
/// thread: how it cuts its work depends on the machine's threads otherwise.
const X265_PARAMS: &str = "log-level=none:info=0:pools=none:frame-threads=1";

/// What a video is encoded in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Codec {
    /// H.264, by x264
    #[default]
    H264,
    /// HEVC (H.265), by x265
    Hevc,
}

impl Codec {
    /// FFmpeg's name of the encoder.
    #[must_use]
    pub fn encoder(self) -> &'static str {
        match self {
            Self::H264 => "libx264",
            Self::Hevc => "libx265",
        }
    }

    /// As people call it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::H264 => "H.264",
            Self::Hevc => "HEVC",
        }
    }

    pub(super) fn threads(self) -> usize {
        match self {
            Self::H264 => X264_THREADS,
            Self::Hevc => 1,
        }
    }

    /// Sets what only this encoder knows; a constant rate factor of 0 is lossless in 8 bits. `rate`: pictures a second
    /// as a fraction, by which x265 spends bits; FFmpeg 5.1 gives it the ticks a second instead.
    pub(super) fn settle(self, options: &mut Dictionary<'_>, crf: u32, rate: (i32, i64)) {
        match self {
            Self::H264 => options.set("mbtree", "0"),
            Self::Hevc => {
                let lossless = if crf == 0 { ":lossless=1" } else { "" };
                options.set("x265-params", &format!("{X265_PARAMS}:fps={}/{}{lossless}", rate.0, rate.1));
            }
        }
    }
}
