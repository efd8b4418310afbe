//! A file's video stream: its packets in the file's order and its decoder.
//!
//! The file is read through the standard library, so that any path will do and no name is taken for an address.

use std::fs::File;
use std::io::{Seek, SeekFrom};
use std::path::Path;

use ffmpeg::codec::{self, Id, threading};
use ffmpeg::format::stream::Disposition;
use ffmpeg::format::{context, stream::Stream};
use ffmpeg::{Dictionary, Packet, media};
use ffmpeg_next as ffmpeg;

use crate::input::open_regular;
use crate::video::VideoError;
use crate::video::quantizer;
use crate::video::read::extent::{self, Extent};
use crate::video::read::hidden::HiddenPackets;

/// How faults in the stream are met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::video) enum Care {
    /// As fast as can be; the first fault is an alarm.
    Fast,
    /// One packet after the other, so that it is known which of them is at fault.
    Exact,
}

/// An open stream.
pub(in crate::video) struct Source {
    input: context::Input,
    pub(in crate::video) decoder: ffmpeg::decoder::Video,
    stream: usize,
    hidden: Option<HiddenPackets>,
    pub(in crate::video) extent: Extent,
    pub(in crate::video) codec: Id,
    /// A stream that may begin with frames that are predicted from what was before it.
    pub(in crate::video) may_start_anywhere: bool,
}

/// A packet of the stream.
pub(in crate::video) struct Piece {
    pub(in crate::video) packet: Packet,
    /// Makes no frame that is shown.
    pub(in crate::video) hidden: bool,
}

impl Source {
    /// Opens `path`, to be decoded with `threads` threads (0: all cores).
    pub(in crate::video) fn open(path: &Path, threads: usize, care: Care) -> Result<Self, VideoError> {
        let failed = |what: String| VideoError::open(path, what);
        let _ = ffmpeg::init();
        ffmpeg::log::set_level(ffmpeg::log::Level::Quiet);
        let mut file = open_file(path)?;
        let extent = extent::look(&mut file)
            .and_then(|extent| file.seek(SeekFrom::Start(0)).map(|_| extent))
            .map_err(|error| failed(format!("can't be read: {error}")))?;
        if extent.no_index {
            return Err(failed(
                "was cut off before its index (moov) was written, so that no program can tell its frames apart; copy \
                 it again if the original is whole, or repair it with a tool such as `untrunc` and another video of \
                 the same camera"
                    .into(),
            ));
        }
        let mut options = Dictionary::new();
        // A playlist in the guise of a video opens nothing else.
        options.set("protocol_whitelist", "none");
        let input = context::StreamIo::from_read_seek(file)
            .and_then(|io| ffmpeg::format::input_from_stream(io, None, Some(options)))
            .map_err(|error| {
                failed(format!("is not a video that FFmpeg can read ({error}); play it to see whether it is whole"))
            })?;
        let stream = input
            .streams()
            .best(media::Type::Video)
            .filter(|stream| !stream.disposition().contains(Disposition::ATTACHED_PIC))
            .ok_or_else(|| failed(no_video(&input)))?;
        let (index, decoder) = (stream.index(), decoder(&stream, threads, care));
        let decoder = decoder.map_err(|error| {
            let codec = stream.parameters().id();
            failed(format!("its video ({}) can't be decoded: {error}; convert it to H.264", codec.name()))
        })?;
        let is_iso = input.format().name().contains("mov");
        let hidden = if is_iso { HiddenPackets::new() } else { None };
        Ok(Self { may_start_anywhere: !is_iso, stream: index, codec: decoder.id(), input, decoder, hidden, extent })
    }

    pub(in crate::video) fn stream(&self) -> Option<Stream<'_>> {
        self.input.stream(self.stream)
    }

    /// Number of frames by the container.
    pub(in crate::video) fn declared_frames(&self) -> Option<u64> {
        self.stream().and_then(|stream| u64::try_from(stream.frames()).ok()).filter(|&frames| frames > 0)
    }

    /// Frames a second that the camera took, where it says so; the file may play them at another rate.
    pub(in crate::video) fn taken_hz(&self) -> Option<f64> {
        let stated = self.input.metadata().get("com.android.capture.fps")?.trim().parse().ok();
        stated.filter(|hz: &f64| hz.is_finite() && *hz > 0.0)
    }

    /// The container's seconds.
    pub(in crate::video) fn duration_s(&self) -> Option<f64> {
        let stream = self.stream()?;
        let of_stream = Some(stream.duration()).filter(|&ticks| ticks > 0);
        let of_file = Some(self.input.duration()).filter(|&ticks| ticks > 0);
        of_stream
            .map(|ticks| ticks as f64 * f64::from(stream.time_base()))
            .or_else(|| of_file.map(|ticks| ticks as f64 / f64::from(ffmpeg::ffi::AV_TIME_BASE)))
    }

    /// The next packet of the stream; none at the end.
    pub(in crate::video) fn next_piece(&mut self) -> Result<Option<Piece>, ffmpeg::Error> {
        loop {
            let mut packet = Packet::empty();
            match packet.read(&mut self.input) {
                Ok(()) if packet.stream() == self.stream && packet.size() > 0 => {
                    let by_list = self.hidden.as_mut().is_some_and(|hidden| hidden.is_hidden(&packet));
                    return Ok(Some(Piece { hidden: by_list || self.makes_no_frame(&packet), packet }));
                }
                Ok(()) => {}
                Err(ffmpeg::Error::Eof) => return Ok(None),
                Err(error) => return Err(error),
            }
        }
    }

    /// A frame of VP8 that is only there to be predicted from.
    fn makes_no_frame(&self, packet: &Packet) -> bool {
        self.codec == Id::VP8 && packet.data().and_then(|data| data.first()).is_some_and(|first| first & 0x10 == 0)
    }
}

fn open_file(path: &Path) -> Result<File, VideoError> {
    let failed = |what: String| VideoError::open(path, what);
    let file = open_regular(path).map_err(|why| failed(why.to_string()))?;
    if file.metadata().is_ok_and(|about| about.len() == 0) {
        return Err(failed("is empty (0 bytes); copy or record it again".into()));
    }
    Ok(file)
}

fn no_video(input: &context::Input) -> String {
    if input.streams().any(|stream| stream.parameters().medium() == media::Type::Audio) {
        "holds sound but no video; name the recording that has the picture".into()
    } else {
        "holds no video; name the recording that has the picture".into()
    }
}

/// Codecs whose frame threads can be relied upon to stop at a fault. MPEG-4's abort the program there (FFmpeg 5.1).
/// H.264's copy a frame's marks before it is decoded: where a damaged slice ends early without a contradiction, which
/// `explode` does not see either, the damage was noticed or not as the threads came to run (measured: 1 of 47 damaged
/// packets, noticed in 4 of 7 readings, and 400 bytes of 0xff in the middle of a file, in some). One thread takes 1.75
/// times as long as two.
fn is_threaded(codec: Id) -> bool {
    matches!(codec, Id::HEVC | Id::VP9 | Id::AV1 | Id::MJPEG)
}

/// With frame threads, the marks on frames come too late to be relied upon; refusing to go on at a fault (`explode`)
/// does not. With one thread the marks of H.264 and of the MPEG family show what was concealed, and the decoder
/// forgives slips beside the picture that a refusal would not.
fn decoder(stream: &Stream<'_>, threads: usize, care: Care) -> Result<ffmpeg::decoder::Video, ffmpeg::Error> {
    let mut context = codec::Context::from_parameters(stream.parameters())?;
    let id = context.id();
    let threaded = care == Care::Fast && is_threaded(id);
    // One alone would see marks that several lose: what is noticed must not depend on their number.
    let count = match threads {
        0 if threaded => 0,
        _ if threaded => threads.max(2),
        _ => 1,
    };
    context.set_threading(threading::Config { kind: threading::Type::Frame, count, ..Default::default() });
    let mut options = Dictionary::new();
    if is_threaded(id) {
        options.set("err_detect", "explode");
    }
    if id == Id::H264 {
        options.set(quantizer::EXPORT.0, quantizer::EXPORT.1);
    }
    let mut decoder = context.decoder();
    decoder.set_packet_time_base(stream.time_base());
    let codec = codec::decoder::find(id).ok_or(ffmpeg::Error::DecoderNotFound)?;
    decoder.open_as_with(codec, options)?.video()
}
