//! Whole frames as blue, green and red bytes, as OpenCV's VideoCapture gives them: by libswscale with its bicubic flag
//! and its default matrix, BT.601, whatever the video's own. For comparison; nothing here measures on it.

use ffmpeg::format::Pixel;
use ffmpeg::frame;
use ffmpeg::software::scaling;
use ffmpeg_next as ffmpeg;

use crate::video::{Video, VideoError};

/// Converts frames of one video.
#[derive(Default)]
pub struct Bgr {
    context: Option<scaling::Context>,
    picture: Option<frame::Video>,
    /// Rows without gaps, where FFmpeg's have some.
    tight: Vec<u8>,
}

impl Bgr {
    /// The bytes of the video's last frame, three a pixel, rows without gaps.
    ///
    /// # Errors
    /// Where libswscale does not know the layout of the samples.
    pub fn of_last<'a>(&'a mut self, video: &Video) -> Result<&'a [u8], VideoError> {
        let failed = |error: ffmpeg::Error| VideoError::Changed {
            path: video.path.clone(),
            what: format!("its samples can't be converted: {error}"),
        };
        let source = &video.picture;
        let (width, height) = (source.width(), source.height());
        let context = match &mut self.context {
            Some(context) => context,
            none => none.insert(
                scaling::Context::get(
                    source.format(),
                    width,
                    height,
                    Pixel::BGR24,
                    width,
                    height,
                    scaling::Flags::BICUBIC,
                )
                .map_err(failed)?,
            ),
        };
        let picture = self.picture.get_or_insert_with(frame::Video::empty);
        context.run(source, picture).map_err(failed)?;
        let (row, stride) = (3 * width as usize, picture.stride(0));
        if row == stride {
            return Ok(picture.data(0));
        }
        self.tight.clear();
        picture.data(0).chunks_exact(stride).for_each(|bytes| self.tight.extend_from_slice(&bytes[..row]));
        Ok(&self.tight)
    }
}
