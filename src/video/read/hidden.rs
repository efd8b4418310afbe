//! Packets that an edit list hides: decoded for what follows, never shown.
//!
//! FFmpeg marks them with a flag that its Rust interface does not pass on. A decoder does honour it: it gives no frame
//! for such a packet. So a decoder of raw pictures of one sample is asked, with one byte of the packet.

use ffmpeg::codec::{self, Parameters};
use ffmpeg::{Packet, format::Pixel, frame};
use ffmpeg_next as ffmpeg;

pub(in crate::video) struct HiddenPackets {
    raw: ffmpeg::decoder::Video,
    sample: frame::Video,
}

impl HiddenPackets {
    /// None where FFmpeg was built without raw video.
    pub(in crate::video) fn new() -> Option<Self> {
        let codec = ffmpeg::encoder::find(codec::Id::RAWVIDEO)?;
        let mut one = codec::Context::new_with_codec(codec).encoder().video().ok()?;
        one.set_width(1);
        one.set_height(1);
        one.set_format(Pixel::GRAY8);
        let raw = codec::Context::from_parameters(Parameters::from(&one)).ok()?.decoder().video().ok()?;
        Some(Self { raw, sample: frame::Video::empty() })
    }

    pub(in crate::video) fn is_hidden(&mut self, packet: &Packet) -> bool {
        let mut byte = packet.clone();
        byte.shrink(1);
        self.raw.send_packet(&byte).is_ok() && self.raw.receive_frame(&mut self.sample).is_err()
    }
}
