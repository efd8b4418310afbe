//! What was wrong with rows: how many of each kind, and the first of each.

use serde::Serialize;

/// What is wrong with a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SpoiltKind {
    /// Too many cells, or too few.
    Cells,
    /// A cell that is no finite number.
    Number,
    /// A cell of `led` that is neither on nor off.
    Led,
    /// The checksum is wrong, or missing where others have one.
    Checksum,
    /// A line without an end.
    TooLong,
    /// Bytes that are no text.
    NotText,
    /// A line of text before the columns are named.
    Message,
    /// A frame of another length.
    Frame,
}

impl SpoiltKind {
    const ALL: [Self; 8] = [
        Self::Cells,
        Self::Number,
        Self::Led,
        Self::Checksum,
        Self::TooLong,
        Self::NotText,
        Self::Message,
        Self::Frame,
    ];

    /// In words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Cells => "too many or too few cells",
            Self::Number => "a cell that is no finite number",
            Self::Led => "an LED that is neither on (1) nor off (0)",
            Self::Checksum => "a wrong or missing checksum",
            Self::TooLong => "a line longer than a MiB",
            Self::NotText => "bytes that are no text",
            Self::Message => "text before the names of the columns",
            Self::Frame => "a frame of another length",
        }
    }
}

/// Spoilt rows by kind.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Spoilt {
    counts: [u64; 8],
    first: [Option<(u64, String)>; 8],
}

/// One kind's, as reported.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpoiltRows {
    /// What is wrong.
    pub what: &'static str,
    /// How many rows.
    pub rows: u64,
    /// The first's line (or frame), from 1.
    pub first_line: u64,
    /// How it begins.
    pub first: String,
}

impl Spoilt {
    /// Counts a row; keeps the first of its kind.
    pub fn count(&mut self, kind: SpoiltKind, line: u64, text: &[u8]) {
        let at = kind as usize;
        self.counts[at] += 1;
        if self.first[at].is_none() {
            let text = String::from_utf8_lossy(&text[..text.len().min(160)]);
            let text = text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).take(40).collect();
            self.first[at] = Some((line, text));
        }
    }

    /// How many rows were spoilt; text before the names is no row.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.counts.iter().sum::<u64>() - self.counts[SpoiltKind::Message as usize]
    }

    /// By kind, those that came.
    #[must_use]
    pub fn kinds(&self) -> Vec<SpoiltRows> {
        let one = |kind: SpoiltKind| {
            let (first_line, first) = self.first[kind as usize].clone()?;
            Some(SpoiltRows { what: kind.words(), rows: self.counts[kind as usize], first_line, first })
        };
        SpoiltKind::ALL.into_iter().filter_map(one).collect()
    }
}
