//! Frames of a fixed size for slow serial links: 27 bytes a row where a line takes 70.
//!
//! A frame is 25 bytes, little endian: eight `u16` counts of P1 to P8, `u32` microseconds, `u16` counter, `u8` flags (bit
//! 0: the LED is on), `u16` CRC-16/IBM-3740 (polynomial 0x1021, initial value 0xFFFF) of the 23 bytes before; encoded by
//! consistent overhead byte stuffing (Cheshire, Baker 1999, DOI 10.1109/90.769765) and ended by a zero: 27 bytes. What
//! is damaged is known to be and costs itself; the next zero begins again.

use crc::{CRC_16_IBM_3740, Crc};

use super::lines::{Cells, Line, Naming, WireFault};
use super::row::{Meaning, Use};
use super::spoilt::{Spoilt, SpoiltKind};

/// Photodiodes of a frame.
const PHOTODIODES: usize = 8;
/// Bytes before encoding, and the longest that lie between two zeros.
const BYTES: usize = 25;
const ENCODED: usize = 26;
const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_3740);

/// What a frame says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame {
    /// Counts of P1 to P8.
    pub counts: [u16; PHOTODIODES],
    /// The device's time, microseconds.
    pub time_us: u32,
    /// Grows by one with each frame.
    pub counter: u16,
    /// Whether the LED is on.
    pub lit: bool,
}

impl Frame {
    /// The bytes on the wire, the zero at the end included.
    #[must_use]
    pub fn encoded(&self) -> [u8; ENCODED + 1] {
        let mut bytes = [0; BYTES];
        for (at, count) in bytes.chunks_exact_mut(2).zip(self.counts) {
            at.copy_from_slice(&count.to_le_bytes());
        }
        bytes[16..20].copy_from_slice(&self.time_us.to_le_bytes());
        bytes[20..22].copy_from_slice(&self.counter.to_le_bytes());
        bytes[22] = u8::from(self.lit);
        let sum = CRC.checksum(&bytes[..23]);
        bytes[23..].copy_from_slice(&sum.to_le_bytes());
        let mut encoded = [0; ENCODED + 1];
        // 25 bytes take one byte more.
        let _ = cobs::encode(&bytes, &mut encoded[..ENCODED]);
        encoded
    }

    fn decoded(encoded: &[u8]) -> Result<Self, SpoiltKind> {
        let mut bytes = [0; ENCODED + 1];
        let known = cobs::decode(encoded, &mut bytes).is_ok_and(|report| report.frame_size() == BYTES);
        if !known {
            return Err(SpoiltKind::Frame);
        }
        let word = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
        if CRC.checksum(&bytes[..23]) != word(23) {
            return Err(SpoiltKind::Checksum);
        }
        Ok(Self {
            counts: std::array::from_fn(|k| word(2 * k)),
            time_us: u32::from(word(16)) | u32::from(word(18)) << 16,
            counter: word(20),
            lit: bytes[22] & 1 == 1,
        })
    }
}

/// Reads frames.
#[derive(Debug)]
pub struct Frames {
    names: Vec<String>,
    volts_per_count: f64,
    meaning: Option<Meaning>,
    partial: Vec<u8>,
    too_long: bool,
    frame: u64,
    values: Vec<f64>,
    spoilt: Spoilt,
}

impl Frames {
    /// At a stream's beginning; a step of the converter is so many volts.
    #[must_use]
    pub fn new(volts_per_count: f64) -> Self {
        let photodiodes = (1..=PHOTODIODES).map(|k| format!("P{k}"));
        Self {
            names: ["time_us", "n", "led"].into_iter().map(str::to_owned).chain(photodiodes).collect(),
            volts_per_count,
            meaning: None,
            partial: Vec::with_capacity(2 * ENCODED),
            too_long: false,
            frame: 0,
            values: Vec::new(),
            spoilt: Spoilt::default(),
        }
    }

    /// The names of the columns.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// What their columns mean, once that was asked.
    #[must_use]
    pub fn meaning(&self) -> Option<&Meaning> {
        self.meaning.as_ref()
    }

    /// The numbers of the last row.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// What was spoilt so far.
    #[must_use]
    pub fn spoilt(&self) -> &Spoilt {
        &self.spoilt
    }

    /// As [`Lines::next`](super::Lines::next).
    ///
    /// # Errors
    /// The caller can't use the columns.
    pub fn next(&mut self, bytes: &mut &[u8], naming: &mut Naming<'_>) -> Result<Option<Line<'_>>, WireFault> {
        if self.meaning.is_none() {
            let meaning = naming(&self.names).map_err(WireFault)?;
            self.values = vec![f64::NAN; meaning.values];
            self.meaning = Some(meaning);
            return Ok(Some(Line::Names { again: false }));
        }
        loop {
            let Some(end) = bytes.iter().position(|&b| b == 0) else {
                self.keep(bytes);
                *bytes = &[];
                return Ok(None);
            };
            let (piece, rest) = (&bytes[..end], &bytes[end + 1..]);
            *bytes = rest;
            self.keep(piece);
            let too_long = std::mem::take(&mut self.too_long);
            if self.partial.is_empty() && !too_long {
                continue;
            }
            self.frame += 1;
            let decoded = if too_long { Err(SpoiltKind::Frame) } else { Frame::decoded(&self.partial) };
            self.partial.clear();
            return Ok(Some(match decoded {
                Ok(frame) => self.cells(&frame),
                Err(kind) => {
                    self.spoilt.count(kind, self.frame, b"");
                    Line::Spoilt(kind)
                }
            }));
        }
    }

    /// The source was lost: what was begun of a frame is none.
    pub fn cut(&mut self) {
        self.partial.clear();
        self.too_long = false;
    }

    fn keep(&mut self, bytes: &[u8]) {
        self.too_long |= self.partial.len() + bytes.len() > ENCODED;
        if !self.too_long {
            self.partial.extend_from_slice(bytes);
        }
    }

    fn cells(&mut self, frame: &Frame) -> Line<'_> {
        let uses = self.meaning.as_ref().map_or(&[][..], |meaning| &meaning.uses);
        for (what, count) in uses.iter().skip(3).zip(frame.counts) {
            if let Use::Value(at) | Use::Counts(at) = *what {
                self.values[at] = f64::from(count) * self.volts_per_count;
            }
        }
        Line::Cells(Cells {
            time: f64::from(frame.time_us),
            counter: Some(u64::from(frame.counter)),
            lit: Some(frame.lit),
            values: &self.values,
            texts: &[],
        })
    }
}
