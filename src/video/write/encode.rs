//! Pictures with given times to a file: H.264 or HEVC in MP4, MOV, Matroska, AVI or a transport stream, by the file's
//! extension.
//!
//! The bytes depend on the pictures and on [`Encoding`] alone: x264 cuts its work by the number of its threads, so this
//! number is fixed, and its macroblock tree is off. With it the AVX-512 code of x264 164 (Debian 12) uses memory that
//! nothing was written to, so the bytes followed what other encoders had left on the heap: measured with
//! `MALLOC_PERTURB_` 0, 1, 77 and 200, four different files, from FFmpeg's own program too; without it one file, and
//! the same with SSE4.2, AVX2 and AVX-512. An MP4's index comes first, so that a file cut off still plays as far as it
//! goes.

use std::path::{Path, PathBuf};

use ffmpeg::{Dictionary, Packet, Rational, codec, color, format as container, frame};
use ffmpeg_next as ffmpeg;

use crate::video::colour::pixel;
use crate::video::write::codec::Codec;
use crate::video::write::mp4;
use crate::video::{Format, Matrix, Picture, Transfer, Turn, VideoError};

/// How to encode.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoding {
    /// Size, chroma and depth.
    pub format: Format,
    /// The colour matrix and range that the file states; the transfer function and primaries of HDR.
    pub matrix: Matrix,
    /// Where the file states that chroma samples lie, in luma samples right of and below the block's first luma sample.
    pub chroma_site: Option<(f64, f64)>,
    /// Width of a sample over its height, as a fraction.
    pub pixel_aspect: (i32, i32),
    /// How the picture is to be turned to be shown (MP4 and MOV).
    pub turn: Turn,
    /// What it is encoded in.
    pub codec: Codec,
    /// The encoder's constant rate factor: 0 lossless, 51 worst.
    pub crf: u32,
    /// The encoder's preset; x264 and x265 have the same names.
    pub preset: &'static str,
    /// Frames that may lie between two that are predicted forward; the encoder's own number if none is given.
    pub b_frames: Option<u32>,
    /// A key frame at least every so many pictures; the encoder's own number if none is given.
    pub key_every: Option<u32>,
    /// Ticks a second of the times given.
    pub ticks_per_s: i32,
    /// Ticks that a picture is shown for, as far as the last one's end goes.
    pub ticks_a_picture: i64,
}

impl Encoding {
    /// H.264 of good quality, times in milliseconds, 30 pictures a second; BT.709, chroma on the left as of cameras.
    #[must_use]
    pub fn new(format: Format) -> Self {
        Self {
            format,
            matrix: Matrix::BT709,
            chroma_site: Some((0.0, 0.5)),
            pixel_aspect: (1, 1),
            turn: Turn::None,
            codec: Codec::H264,
            crf: 18,
            preset: "medium",
            b_frames: None,
            key_every: None,
            ticks_per_s: 1000,
            ticks_a_picture: 33,
        }
    }
}

/// A file being written.
pub struct Encoder {
    path: PathBuf,
    output: container::context::Output,
    encoder: ffmpeg::encoder::Video,
    format: Format,
    pixel: container::Pixel,
    stream_base: Rational,
    time_base: Rational,
    ticks_a_picture: i64,
    last_ticks: Option<i64>,
    turn: Turn,
    /// The file is an MP4 or MOV of HEVC.
    tagged: bool,
}

impl Encoder {
    /// Starts the file `path`; its extension names the container.
    ///
    /// # Errors
    /// When it can't be written or the codec is not there.
    pub fn create(path: &Path, encoding: &Encoding) -> Result<Self, VideoError> {
        let failed = |error: ffmpeg::Error| write_error(path, &error);
        let _ = ffmpeg::init();
        ffmpeg::log::set_level(ffmpeg::log::Level::Quiet);
        let kind = kind(path)?;
        let (format, codec) = (encoding.format, encoding.codec);
        let pixel = encodable(path, &format, codec)?;
        if kind == "h264" && codec != Codec::H264 {
            return Err(VideoError::write(path, format!("a file of bare H.264 can't hold {}", codec.name())));
        }
        if encoding.turn != Turn::None && !matches!(kind, "mp4" | "mov") {
            return Err(VideoError::write(path, "only .mp4 and .mov can say that a picture is turned"));
        }
        let mut output = container::output_as(&address(path)?, kind).map_err(failed)?;
        let encoder = ffmpeg::encoder::find_by_name(codec.encoder()).ok_or_else(|| {
            let name = codec.encoder();
            VideoError::write(path, format!("FFmpeg was built without {name}; install Debian's own libavcodec"))
        })?;
        let mut setup = codec::Context::new_with_codec(encoder).encoder().video().map_err(failed)?;
        let time_base = Rational(1, encoding.ticks_per_s);
        setup.set_width(format.width as u32);
        setup.set_height(format.height as u32);
        setup.set_format(pixel);
        setup.set_time_base(time_base);
        setup.set_aspect_ratio(Rational(encoding.pixel_aspect.0, encoding.pixel_aspect.1));
        setup.set_colorspace(space(&encoding.matrix));
        setup.set_color_range(if encoding.matrix.full_range { color::Range::JPEG } else { color::Range::MPEG });
        if let Some(stated) = stated_transfer(encoding.matrix.transfer) {
            setup.set_color_transfer_characteristic(stated);
            setup.set_color_primaries(color::Primaries::BT2020);
        }
        setup.set_threading(codec::threading::Config::count(codec.threads()));
        if output.format().flags().contains(container::Flags::GLOBAL_HEADER) {
            setup.set_flags(codec::Flags::GLOBAL_HEADER);
        }
        let opened = setup.open_with(options(encoding)).map_err(failed)?;
        let mut stream = output.add_stream(encoder).map_err(failed)?;
        stream.set_parameters(&opened);
        stream.set_time_base(time_base);
        let mut how = Dictionary::new();
        if matches!(kind, "mp4" | "mov") {
            how.set("movflags", "faststart");
        }
        output.write_header_with(how).map_err(failed)?;
        let stream_base = output.stream(0).map_or(time_base, |stream| stream.time_base());
        Ok(Self {
            path: path.to_owned(),
            output,
            encoder: opened,
            format,
            pixel,
            stream_base,
            time_base,
            ticks_a_picture: encoding.ticks_a_picture,
            last_ticks: None,
            turn: encoding.turn,
            tagged: codec == Codec::Hevc && matches!(kind, "mp4" | "mov"),
        })
    }

    /// Adds a picture to be shown from `ticks` on.
    ///
    /// # Errors
    /// When it can't be written, is of another format, or is not later than the one before.
    pub fn push(&mut self, picture: &Picture, ticks: i64) -> Result<(), VideoError> {
        let refused = |what: &str| Err(VideoError::write(&self.path, what));
        if picture.format != self.format {
            return refused("a picture of another size or layout can't go into it");
        }
        if self.last_ticks.is_some_and(|last| last >= ticks) {
            return refused("pictures have to come in the order of their times");
        }
        self.last_ticks = Some(ticks);
        // A new frame each time: the encoder may still hold the last one.
        let mut frame = frame::Video::new(self.pixel, self.format.width as u32, self.format.height as u32);
        for (number, plane) in picture.planes.iter().enumerate() {
            let rows = frame.plane_height(number) as usize;
            let (bytes, stride) = (plane.len() / rows, frame.stride(number));
            let into = frame.data_mut(number).chunks_mut(stride);
            into.zip(plane.chunks_exact(bytes)).for_each(|(into, row)| into[..bytes].copy_from_slice(row));
        }
        frame.set_pts(Some(ticks));
        self.encoder.send_frame(&frame).map_err(|error| write_error(&self.path, &error))?;
        self.write_packets()
    }

    /// Ends the file.
    pub fn finish(mut self) -> Result<(), VideoError> {
        self.encoder.send_eof().map_err(|error| write_error(&self.path, &error))?;
        self.write_packets()?;
        self.output.write_trailer().map_err(|error| write_error(&self.path, &error))?;
        // The file is closed before it is opened again.
        let Self { path, format, turn, tagged, output, .. } = self;
        drop(output);
        let turned = mp4::turn_file(&path, turn, (format.width, format.height));
        turned
            .and_then(|()| if tagged { mp4::tag_hevc(&path) } else { Ok(()) })
            .map_err(|error| VideoError::write(&path, format!("can't be written as a video: {error}")))
    }

    fn write_packets(&mut self) -> Result<(), VideoError> {
        let mut packet = Packet::empty();
        while brought(self.encoder.receive_packet(&mut packet)).map_err(|error| write_error(&self.path, &error))? {
            packet.set_stream(0);
            packet.set_duration(self.ticks_a_picture);
            packet.rescale_ts(self.time_base, self.stream_base);
            packet.write_interleaved(&mut self.output).map_err(|error| write_error(&self.path, &error))?;
        }
        Ok(())
    }
}

/// Whether a request for a packet brought one: not where the encoder waits for more pictures or has ended.
fn brought(answer: Result<(), ffmpeg::Error>) -> Result<bool, ffmpeg::Error> {
    match answer {
        Ok(()) => Ok(true),
        Err(ffmpeg::Error::Eof | ffmpeg::Error::Other { errno: ffmpeg::error::EAGAIN }) => Ok(false),
        Err(error) => Err(error),
    }
}

fn write_error(path: &Path, error: &ffmpeg::Error) -> VideoError {
    VideoError::write(path, format!("can't be written as a video: {error}"))
}

/// FFmpeg's name of the container.
fn kind(path: &Path) -> Result<&'static str, VideoError> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    Ok(match extension.to_ascii_lowercase().as_str() {
        "mp4" | "m4v" => "mp4",
        "mov" => "mov",
        "mkv" => "matroska",
        "avi" => "avi",
        "ts" => "mpegts",
        "h264" | "264" => "h264",
        _ => return Err(VideoError::write(path, "a video's name has to end in .mp4, .mov, .mkv, .avi or .ts")),
    })
}

/// The path as FFmpeg takes it; with its protocol, so that no part of it is taken for one.
fn address(path: &Path) -> Result<String, VideoError> {
    let text = path.to_str().filter(|text| !text.contains('\0'));
    let text = text.ok_or_else(|| VideoError::write(path, "FFmpeg writes to names in UTF-8 only; choose another"))?;
    Ok(format!("file:{text}"))
}

fn encodable(path: &Path, format: &Format, codec: Codec) -> Result<container::Pixel, VideoError> {
    let refused = |what: &str| VideoError::write(path, format!("{} {what}", codec.name()));
    let (across, down) = format.subsampling.unwrap_or((1, 1));
    if format.width == 0
        || format.height == 0
        || !format.width.is_multiple_of(across)
        || !format.height.is_multiple_of(down)
    {
        return Err(refused("takes no odd width or height with halved chroma; pad the picture or use 4:4:4"));
    }
    match (format.subsampling, format.depth) {
        (None | Some((2, 2) | (2, 1) | (1, 1)), 8 | 10) => pixel::of_format(format),
        _ => None,
    }
    .ok_or_else(|| refused("is written as grey, 4:2:0, 4:2:2 or 4:4:4 of 8 or 10 bits"))
}

fn options(encoding: &Encoding) -> Dictionary<'static> {
    let mut options = Dictionary::new();
    options.set("crf", &encoding.crf.to_string());
    options.set("preset", encoding.preset);
    encoding.codec.settle(&mut options, encoding.crf, (encoding.ticks_per_s, encoding.ticks_a_picture));
    if let Some(frames) = encoding.b_frames {
        options.set("bf", &frames.to_string());
    }
    if let Some(pictures) = encoding.key_every {
        options.set("g", &pictures.to_string());
    }
    let site = pixel::CHROMA_SITES.iter().find(|(.., site)| Some(*site) == encoding.chroma_site);
    options.set("chroma_sample_location", site.map_or("unknown", |(_, name, _)| name));
    options
}

fn space(matrix: &Matrix) -> color::Space {
    if matrix.k_red == Matrix::BT709.k_red {
        color::Space::BT709
    } else if matrix.k_red == Matrix::BT2020.k_red {
        color::Space::BT2020NCL
    } else {
        color::Space::SMPTE170M
    }
}

fn stated_transfer(transfer: Transfer) -> Option<color::TransferCharacteristic> {
    match transfer {
        Transfer::Power => None,
        Transfer::HybridLogGamma => Some(color::TransferCharacteristic::ARIB_STD_B67),
        Transfer::PerceptualQuantizer => Some(color::TransferCharacteristic::SMPTE2084),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_encoder_that_fails_is_not_one_that_waits_or_has_ended() {
        let waits = ffmpeg::Error::Other { errno: ffmpeg::error::EAGAIN };
        assert_eq!([Ok(()), Err(waits), Err(ffmpeg::Error::Eof)].map(brought), [Ok(true), Ok(false), Ok(false)]);
        for error in [ffmpeg::Error::Other { errno: ffmpeg::error::ENOMEM }, ffmpeg::Error::External] {
            assert_eq!(brought(Err(error)), Err(error));
        }
    }
}
