//! What the container and the first frame say of a video.

use ffmpeg::codec::packet::side_data;
use ffmpeg::format::stream::Stream;
use ffmpeg::util::chroma::Location;
use ffmpeg::{Rational, color, frame};
use ffmpeg_next as ffmpeg;

use super::{Curve, Format, Matrix, Plane, Transfer, Turn};
use crate::video::colour::pixel;
use crate::video::read::source::Source;

/// What the container and the first frame say of the video.
#[derive(Debug, Clone, PartialEq)]
pub struct Info {
    /// Size, chroma and depth of the stored picture.
    pub format: Format,
    /// How the stored picture is turned to be shown.
    pub turn: Turn,
    /// Width of a sample over its height.
    pub pixel_aspect: f64,
    /// The colour matrix and range of the frames as they are handed out.
    pub matrix: Matrix,
    /// How samples of the frames as they are handed out stand for light.
    pub curve: Curve,
    /// Which HDR the file is in, of which frames are made ordinary ones.
    pub hdr: Option<&'static str>,
    /// The file does not say which matrix; BT.709 is taken from 720 rows on, else BT.601.
    pub matrix_assumed: bool,
    /// Where the header says that chroma samples lie, in luma samples right of and below the block's first luma sample.
    /// FFmpeg takes H.264 that says nothing for the standard's default, on the left.
    pub chroma_site: Option<(f64, f64)>,
    /// The codec's name.
    pub codec: String,
    /// Seconds a tick of the times, as a fraction: every time is a whole number of them.
    pub tick_s: (i64, i64),
    /// Number of frames, where the container gives it.
    pub declared_frames: Option<u64>,
    /// Duration in seconds, where the container gives it.
    pub duration_s: Option<f64>,
    /// FFmpeg's name of the samples' layout in the file, where frames had to be converted from it.
    pub converted: Option<String>,
    /// All chroma of the first frames is neutral: the video is grey, however it is stored.
    pub grey: bool,
    /// Frames a second that times are counted with, where the file holds no times.
    pub rate_without_times_hz: Option<f64>,
    /// What may disturb a measurement, in words for the user.
    pub warnings: Vec<String>,
}

impl Info {
    /// Of a video in BT.709 of which nothing but its layout is known.
    #[must_use]
    pub fn plain(format: Format) -> Self {
        Self {
            format,
            turn: Turn::None,
            pixel_aspect: 1.0,
            matrix: Matrix::BT709,
            curve: Curve::default(),
            hdr: None,
            matrix_assumed: true,
            chroma_site: None,
            codec: "unknown".into(),
            tick_s: (1, 1000),
            declared_frames: None,
            duration_s: None,
            converted: None,
            grey: format.subsampling.is_none(),
            rate_without_times_hz: None,
            warnings: Vec::new(),
        }
    }

    /// What there is to decode, for people: frames, size, codec, depth, HDR.
    #[must_use]
    pub fn in_words(&self) -> String {
        let frames = self.declared_frames.map_or("all frames".to_owned(), |frames| format!("{frames} frames"));
        let Format { width, height, depth, .. } = self.format;
        let hdr = self.hdr.map_or(String::new(), |hdr| format!(", HDR ({hdr})"));
        format!("{frames}, {width} x {height}, {} of {depth} bits{hdr}", self.codec)
    }

    /// A report's note on HDR.
    #[must_use]
    pub fn hdr_note(&self) -> Option<String> {
        self.hdr.map(|hdr| format!("the video is HDR ({hdr}): it is read as an ordinary camera would have filmed it"))
    }
}

/// Reads it off the stream and the first frame; `planes` is the same frame in a layout that is read. The matrix is the
/// file's own, also in HDR. The error is words for
/// the user.
pub(super) fn info(
    source: &Source,
    first: &frame::Video,
    planes: &frame::Video,
    rate_without_times_hz: Option<f64>,
    tick_s: (i64, i64),
) -> Result<Info, String> {
    let stream = source.stream().ok_or("its video stream is gone")?;
    let (subsampling, depth) = pixel::planar(planes.format()).ok_or("its samples are laid out in no way known here")?;
    let format = Format { width: planes.width() as usize, height: planes.height() as usize, subsampling, depth };
    let name = |pixel: ffmpeg::format::Pixel| pixel.descriptor().map_or("?", |known| known.name()).to_owned();
    let converted = Some(name(first.format())).filter(|_| first.format() != planes.format());
    let mut warnings = Vec::new();
    let turn = turn(&stream, &mut warnings);
    let (matrix, matrix_assumed) = matrix(source, first, &mut warnings)?;
    if first.is_interlaced() {
        warnings.push(
            "the video is interlaced: odd and even rows are of different moments, which moves whatever is in motion; \
             record progressively or deinterlace it first"
                .into(),
        );
    }
    if let Some(rate) = rate_without_times_hz {
        warnings.push(format!("the file holds no times; frames are taken to be 1/{rate} s apart"));
    }
    warnings.extend(slow_motion(source, &stream));
    if let Some(from) = &converted {
        warnings.push(format!("its samples ({from}) were converted to {} by FFmpeg", name(planes.format())));
    }
    Ok(Info {
        format,
        turn,
        pixel_aspect: aspect(first.aspect_ratio()).or_else(|| aspect(source.decoder.aspect_ratio())).unwrap_or(1.0),
        matrix,
        curve: curve(stated_transfer(source, first), matrix.transfer),
        hdr: matrix.transfer.hdr(),
        matrix_assumed,
        chroma_site: chroma_site(first.chroma_location()).filter(|_| subsampling.is_some() && converted.is_none()),
        codec: source.codec.name().to_owned(),
        tick_s,
        declared_frames: source.declared_frames(),
        duration_s: source.duration_s(),
        converted,
        grey: is_grey(planes, &format),
        rate_without_times_hz,
        warnings,
    })
}

/// Whether all chroma of a frame is neutral.
pub(super) fn is_grey(planes: &frame::Video, format: &Format) -> bool {
    (1..planes.planes().min(3)).all(|plane| is_neutral(planes, plane, format))
}

/// Chroma within a level of none, on the scale of 8 bits.
fn is_neutral(planes: &frame::Video, number: usize, format: &Format) -> bool {
    let Some((width, height)) = format.chroma_size() else { return true };
    let (stride, depth) = (planes.stride(number), format.depth);
    let plane = Plane { width, height, stride, depth, data: planes.data(number) };
    let mut row = vec![0.0; width];
    (0..height).all(|y| {
        plane.copy_row(y, 0, &mut row);
        row.iter().all(|value| (value - 128.0).abs() <= 1.0)
    })
}

fn aspect(ratio: Rational) -> Option<f64> {
    (ratio.0 > 0 && ratio.1 > 0).then(|| f64::from(ratio.0) / f64::from(ratio.1))
}

/// What to say of frames that were taken at another rate than the file plays them at, as Android writes it down
/// (`com.android.capture.fps`). In the dark a camera slows down by itself, by less than this factor as a rule.
fn slow_motion(source: &Source, stream: &Stream<'_>) -> Option<String> {
    const OTHER_RATE: f64 = 1.8;
    let taken_hz = source.taken_hz()?;
    let played_hz = Some(f64::from(stream.avg_frame_rate())).filter(|hz| hz.is_finite() && *hz > 0.0)?;
    let times = taken_hz / played_hz;
    let kind = match times {
        OTHER_RATE.. => "slow motion",
        times if times <= 1.0 / OTHER_RATE => "a time lapse",
        _ => return None,
    };
    let short = |value: f64| (value * 1e4).round() / 1e4;
    Some(format!(
        "the camera wrote down that it took {} frames a second, and the file plays {} a second: is it {kind}? Then all \
         times here are {} times what they were; `ffmpeg -itsscale {:.6} -i FILE -c copy FILMED.mp4` writes the video \
         with the times at which it was filmed",
        short(taken_hz),
        short(played_hz),
        short(times),
        1.0 / times
    ))
}

/// The display matrix: rows (a, b, u), (c, d, v), (x, y, w) of 16.16 numbers; shown = (a x + c y, b x + d y).
fn turn(stream: &Stream<'_>, warnings: &mut Vec<String>) -> Turn {
    let Some(data) = stream.side_data().find(|data| data.kind() == side_data::Type::DisplayMatrix) else {
        return Turn::None;
    };
    let number = |k: usize| -> f64 {
        let bytes = data.data().get(4 * k..4 * k + 4).and_then(|bytes| bytes.try_into().ok());
        f64::from(i32::from_ne_bytes(bytes.unwrap_or_default()))
    };
    let (a, b, c, d) = (number(0), number(1), number(3), number(4));
    let largest = [a, b, c, d].iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let signs = [a, b, c, d].map(|value| if value.abs() < 1e-3 * largest { 0 } else { value.signum() as i32 });
    match signs {
        [1, 0, 0, 1] => Turn::None,
        [0, 1, -1, 0] => Turn::Quarter,
        [-1, 0, 0, -1] => Turn::Half,
        [0, -1, 1, 0] => Turn::ThreeQuarters,
        [-1, 0, 0, 1] | [1, 0, 0, -1] | [0, 1, 1, 0] | [0, -1, -1, 0] => {
            warnings.push("the file asks for a mirrored picture, which is not done: directions are as recorded".into());
            Turn::None
        }
        _ => {
            warnings.push("the file asks for a rotation by no multiple of 90 degrees, which is not done".into());
            Turn::None
        }
    }
}

fn matrix(source: &Source, first: &frame::Video, warnings: &mut Vec<String>) -> Result<(Matrix, bool), String> {
    if pixel::is_rgb(first.format()) {
        // What libswscale converts red, green and blue to.
        return Ok((Matrix::BT601, false));
    }
    let known = |space: color::Space| space != color::Space::Unspecified && space != color::Space::Reserved;
    let space = Some(first.color_space()).filter(|&space| known(space)).unwrap_or(source.decoder.color_space());
    let range = Some(first.color_range())
        .filter(|&range| range != color::Range::Unspecified)
        .unwrap_or(source.decoder.color_range());
    let grey = pixel::planar(first.format()).is_some_and(|(chroma, _)| chroma.is_none());
    let mut assumed = false;
    let matrix = match space {
        color::Space::BT709 => Matrix::BT709,
        color::Space::BT470BG | color::Space::SMPTE170M => Matrix::BT601,
        color::Space::BT2020NCL => Matrix::BT2020,
        color::Space::FCC => Matrix::ordinary(0.30, 0.11),
        color::Space::SMPTE240M => Matrix::ordinary(0.212, 0.087),
        space if !known(space) || grey => {
            assumed = !grey;
            if first.height() >= 720 { Matrix::BT709 } else { Matrix::BT601 }
        }
        space => {
            let name = space.name().unwrap_or("?");
            warnings.push(format!("colours of the matrix {name} are taken for BT.2020's; convert the video to BT.709"));
            Matrix::BT2020
        }
    };
    let full_range = range == color::Range::JPEG || pixel::is_full_range(first.format());
    Ok((Matrix { full_range, transfer: transfer(source, first, warnings), ..matrix }, assumed))
}

fn stated_transfer(source: &Source, first: &frame::Video) -> color::TransferCharacteristic {
    Some(first.color_transfer_characteristic())
        .filter(|&stated| stated != color::TransferCharacteristic::Unspecified)
        .unwrap_or(source.decoder.color_transfer_characteristic())
}

/// What says nothing, and what is not known here, is BT.709's.
fn curve(stated: color::TransferCharacteristic, transfer: Transfer) -> Curve {
    use color::TransferCharacteristic as Known;
    match stated {
        Known::IEC61966_2_1 => Curve::Srgb,
        Known::GAMMA22 => Curve::Power,
        _ => Curve::of_read(transfer),
    }
}

fn transfer(source: &Source, first: &frame::Video, warnings: &mut Vec<String>) -> Transfer {
    use color::TransferCharacteristic as Known;
    let stated = stated_transfer(source, first);
    match stated {
        Known::ARIB_STD_B67 => Transfer::HybridLogGamma,
        Known::SMPTE2084 => Transfer::PerceptualQuantizer,
        Known::Linear | Known::Log | Known::LogSqrt | Known::SMPTE428 => {
            let name = stated.name().unwrap_or("?");
            warnings
                .push(format!("its samples stand for light as {name} says, taken for BT.709; convert it to BT.709"));
            Transfer::Power
        }
        _ => Transfer::Power,
    }
}

fn chroma_site(location: Location) -> Option<(f64, f64)> {
    pixel::CHROMA_SITES.iter().find(|(known, ..)| *known == location).map(|(.., site)| *site)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_the_files_own_where_it_says_one() {
        use color::TransferCharacteristic as Known;
        let cases = [
            (Known::Unspecified, Transfer::Power, Curve::Bt709),
            (Known::BT709, Transfer::Power, Curve::Bt709),
            (Known::SMPTE170M, Transfer::Power, Curve::Bt709),
            (Known::IEC61966_2_1, Transfer::Power, Curve::Srgb),
            (Known::GAMMA22, Transfer::Power, Curve::Power),
            (Known::ARIB_STD_B67, Transfer::HybridLogGamma, Curve::Power),
        ];
        for (stated, transfer, expected) in cases {
            assert_eq!(curve(stated, transfer), expected, "{stated:?}");
        }
    }
}
