//! The clock in one frame.

/// What the clock shows in one frame, or why it was not read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reading {
    /// The clock shows this.
    Read {
        /// The seconds that its digits mean, not yet unwrapped: `59:59.9` is 3599.9, and `00:00.0` after it is 0.
        shown_s: f64,
        /// How probably every digit is right, 0 to 1.
        confidence: f64,
    },
    /// Not sure enough.
    Abstained(Doubt),
}

/// Why a frame's clock was not read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Doubt {
    /// No clock was found in the frame, or it is covered.
    NotFound,
    /// Its digits changed during the exposure, or a digit is unclear.
    Unclear,
    /// Its digits were read, and beside them stands what the format does not have: a further digit, a colon, AM or PM.
    OtherFormat,
    /// Its digits were read, but not AM or PM beside them.
    HalfUnclear,
    /// The frame could not be decoded.
    Undecoded,
    /// It was not looked at, to save time.
    NotAsked,
}

/// How much was looked at.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct ReaderEffort {
    /// Frames that were asked for a reading.
    pub frames: u64,
    /// Whole frames that were searched for the clock.
    pub searched: u64,
    /// Digits whose pixels were looked at.
    pub digits: u64,
    /// Digits that the network judged; the others were known by the clock's own glyphs.
    pub judged: u64,
}
