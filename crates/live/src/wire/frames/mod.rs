//! Frames: rows of eight photodiodes in 27 bytes.
//!
//! A frame holds 25 bytes, little end first: eight photodiodes in counts (u16), the device's time in microseconds
//! (u32), a counter (u16), flags (u8, bit 0: the LED is on), and the [`crc16`] of these 23 bytes (u16). They are sent
//! in COBS (Cheshire and Baker 1999, doi:10.1109/90.769765) and ended by a zero, so that a receiver that comes late or
//! loses bytes is in step again after the next zero.

use crate::wire::checksum::crc16;
use crate::wire::fault::WireFault;
use crate::wire::row::{Decoded, Naming, Sample, Step, Use};
use crate::wire::spoilt::{Spoil, shown_bytes};

/// The columns of a frame.
pub const FRAME_NAMES: [&str; 11] = ["time_us", "n", "led", "P1", "P2", "P3", "P4", "P5", "P6", "P7", "P8"];

/// The bytes of a frame with its checksum.
const BYTES: usize = 25;

/// The bytes of a frame on the wire: one more for COBS, and the zero.
pub const WIRE_BYTES: usize = BYTES + 2;

/// So many bytes without a frame are no frames: 75 of them, longer than a device's messages when it starts (*assumed*).
const BYTES_WITHOUT_FRAME: u64 = 2048;

/// What a frame holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Frame {
    /// The photodiodes, counts.
    pub photodiodes: [u16; 8],
    /// The device's time, microseconds; begins again after 2^32.
    pub time_us: u32,
    /// Grows by one with each frame; begins again after 2^16.
    pub counter: u16,
    /// Whether the LED is on.
    pub lit: bool,
}

impl Frame {
    /// The bytes that are sent.
    #[must_use]
    pub fn encoded(&self) -> [u8; WIRE_BYTES] {
        let mut frame = [0; BYTES];
        for (bytes, count) in frame.chunks_exact_mut(2).zip(self.photodiodes) {
            bytes.copy_from_slice(&count.to_le_bytes());
        }
        frame[16..20].copy_from_slice(&self.time_us.to_le_bytes());
        frame[20..22].copy_from_slice(&self.counter.to_le_bytes());
        frame[22] = u8::from(self.lit);
        let sum = crc16(&frame[..23]);
        frame[23..].copy_from_slice(&sum.to_le_bytes());
        let mut wire = [0; WIRE_BYTES];
        cobs::encode(&frame, &mut wire[..WIRE_BYTES - 1]);
        wire
    }

    /// The frame in the bytes between two zeros.
    ///
    /// # Errors
    /// They are no frame, or do not fit its checksum.
    fn decoded(wire: &[u8]) -> Result<Self, Spoil> {
        let mut frame = [0; WIRE_BYTES];
        if wire.len() != WIRE_BYTES - 1 || cobs::decode(wire, &mut frame).map(|report| report.frame_size()) != Ok(BYTES)
        {
            return Err(Spoil::Frame);
        }
        let u16_at = |at: usize| u16::from_le_bytes([frame[at], frame[at + 1]]);
        if crc16(&frame[..23]) != u16_at(23) {
            return Err(Spoil::Checksum);
        }
        Ok(Self {
            photodiodes: std::array::from_fn(|k| u16_at(2 * k)),
            time_us: u32::from_le_bytes([frame[16], frame[17], frame[18], frame[19]]),
            counter: u16_at(20),
            lit: frame[22] & 1 == 1,
        })
    }
}

/// Decodes frames.
pub struct Frames {
    naming: Option<Naming>,
    pub(crate) decoded: Decoded,
    volts_per_count: Option<f64>,
    /// The bytes since the last zero; of longer garbage the beginning.
    carry: [u8; WIRE_BYTES],
    carried: usize,
    /// The bytes until the next zero may be half a frame.
    seam: bool,
    frames: u64,
    bytes: u64,
    any: bool,
}

impl Frames {
    /// Frames whose columns, [`FRAME_NAMES`], mean what `naming` says; values in counts become volts where
    /// `volts_per_count` is given.
    #[must_use]
    pub fn new(naming: Naming, volts_per_count: Option<f64>) -> Self {
        Self {
            naming: Some(naming),
            decoded: Decoded { names: FRAME_NAMES.map(str::to_owned).into(), ..Decoded::default() },
            volts_per_count,
            carry: [0; WIRE_BYTES],
            carried: 0,
            seam: true,
            frames: 0,
            bytes: 0,
            any: false,
        }
    }

    /// Decodes up to the next step and takes what it used off `bytes`; none where nothing more is whole.
    ///
    /// # Errors
    /// The names mean nothing to the caller, or there are no frames.
    pub fn next(&mut self, bytes: &mut &[u8]) -> Result<Option<Step>, WireFault> {
        if let Some(mut naming) = self.naming.take() {
            self.decoded.name(&mut naming)?;
            return Ok(Some(Step::Columns { again: false }));
        }
        while !bytes.is_empty() {
            let zero = memchr::memchr(0, bytes);
            let piece = &bytes[..zero.unwrap_or(bytes.len())];
            let kept = piece.len().min(WIRE_BYTES - self.carried);
            self.carry[self.carried..self.carried + kept].copy_from_slice(&piece[..kept]);
            self.carried += kept;
            self.bytes += piece.len() as u64 + u64::from(zero.is_some());
            *bytes = &bytes[piece.len() + usize::from(zero.is_some())..];
            if !self.any && self.bytes > BYTES_WITHOUT_FRAME {
                return Err(self.no_frames());
            }
            if zero.is_some()
                && let Some(step) = self.frame()
            {
                return Ok(Some(step));
            }
        }
        Ok(None)
    }

    /// The frame that a zero ended; none where there was none.
    fn frame(&mut self) -> Option<Step> {
        let (carried, seam) = (std::mem::take(&mut self.carried), std::mem::take(&mut self.seam));
        if carried == 0 {
            return None;
        }
        match Frame::decoded(&self.carry[..carried]) {
            Ok(frame) => {
                self.frames += 1;
                self.any = true;
                Some(Step::Sample(self.sample(&frame)))
            }
            Err(_) if seam => None,
            Err(spoil) => {
                self.frames += 1;
                self.decoded.tally.add(spoil, self.frames, || shown_bytes(&self.carry[..carried]));
                Some(Step::Spoilt(spoil))
            }
        }
    }

    fn sample(&mut self, frame: &Frame) -> Sample {
        let mut sample = Sample { time: f64::NAN, counter: None, lit: None };
        for (column, purpose) in self.decoded.meaning.uses.iter().enumerate() {
            let number = match column {
                0 => f64::from(frame.time_us),
                1 => f64::from(frame.counter),
                2 => f64::from(u8::from(frame.lit)),
                _ => frame.photodiodes.get(column - 3).copied().map_or(f64::NAN, f64::from),
            };
            match *purpose {
                Use::Time { .. } => sample.time = number,
                Use::Counter => sample.counter = Some(frame.counter.into()),
                Use::Led => sample.lit = Some(frame.lit),
                Use::Value { at, scaled } => {
                    let scale = self.volts_per_count.filter(|_| scaled);
                    self.decoded.values[at] = scale.map_or(number, |volts| number * volts);
                }
                Use::Text(_) | Use::None => {}
            }
        }
        sample
    }

    /// Forgets half a frame: what comes next comes from another connection.
    pub fn cut(&mut self) {
        (self.carried, self.seam) = (0, true);
    }

    /// The end of the stream.
    ///
    /// # Errors
    /// Bytes came and there was no frame in them.
    pub fn finish(&mut self) -> Result<(), WireFault> {
        if self.any || self.bytes == 0 { Ok(()) } else { Err(self.no_frames()) }
    }

    /// The columns, the last row, and what was spoilt.
    #[must_use]
    pub fn decoded(&self) -> &Decoded {
        &self.decoded
    }

    fn no_frames(&self) -> WireFault {
        WireFault::NoFrames { bytes: self.bytes, text: shown_bytes(&self.carry[..self.carried]) }
    }
}

#[cfg(test)]
mod tests;
