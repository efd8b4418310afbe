//! Frames whose planes can't be read as they are, to the nearest that can be.

use ffmpeg::format::Pixel;
use ffmpeg::frame;
use ffmpeg::software::scaling;
use ffmpeg_next as ffmpeg;

use crate::video::colour::pixel;

/// The frame in a layout whose planes can be read; none where its own can. The error is words for the user.
///
/// A new converter is made for each frame: FFmpeg's can't move between threads, a video can. That takes some tens of
/// microseconds.
pub(in crate::video) fn planes(picture: &frame::Video) -> Result<Option<frame::Video>, String> {
    let pixel = picture.format();
    let planar = pixel::planar(pixel).is_some();
    // Some decoders give pictures upside down, by negative strides.
    let upright = (0..picture.planes().min(3)).all(|plane| picture.stride(plane) <= i32::MAX as usize);
    if planar && upright {
        return Ok(None);
    }
    let into = Some(pixel).filter(|_| planar).or_else(|| pixel::nearest_planar(pixel));
    let into = into.ok_or("its samples are laid out in no way known here; convert it to H.264")?;
    convert(picture, into).map(Some).map_err(|error| format!("its samples can't be converted: {error}"))
}

fn convert(picture: &frame::Video, into: Pixel) -> Result<frame::Video, ffmpeg::Error> {
    let (width, height) = (picture.width(), picture.height());
    let flags = scaling::Flags::BICUBIC | scaling::Flags::ACCURATE_RND;
    let flags = flags | scaling::Flags::FULL_CHR_H_INT | scaling::Flags::FULL_CHR_H_INP;
    let mut context = scaling::Context::get(picture.format(), width, height, into, width, height, flags)?;
    let mut planar = frame::Video::empty();
    context.run(picture, &mut planar)?;
    Ok(planar)
}
