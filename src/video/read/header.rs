//! What the container alone says of a video: no frame is decoded for it.

use std::path::Path;

use crate::video::VideoError;
use crate::video::read::source::{Care, Source};

/// A video's size and length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Header {
    /// Columns of the stored picture.
    pub width: usize,
    /// Rows of the stored picture.
    pub height: usize,
    /// Number of frames, where the container gives it.
    pub declared_frames: Option<u64>,
}

impl Header {
    /// Reads the header of a video file.
    ///
    /// # Errors
    /// [`VideoError`] where it is no video that can be read.
    pub fn read(path: &Path) -> Result<Self, VideoError> {
        let source = Source::open(path, 1, Care::Fast)?;
        Ok(Self {
            width: source.decoder.width() as usize,
            height: source.decoder.height() as usize,
            declared_frames: source.declared_frames(),
        })
    }
}
