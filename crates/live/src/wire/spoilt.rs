//! Rows that are spoilt: counted by kind, the first of each kind kept.

use serde::Serialize;

/// The most characters of a spoilt row that are kept.
const MOST_CHARS: usize = 40;

/// What is wrong with a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Spoil {
    /// It came before the names of the columns.
    BeforeNames,
    /// It has more or fewer cells than there are columns.
    Cells,
    /// A cell of a column in use is no finite number.
    Unreadable,
    /// It does not fit its checksum.
    Checksum,
    /// It has no checksum, and rows before it had one.
    Unchecked,
    /// It is longer than a mebibyte.
    TooLong,
    /// It is no frame: bytes between two zeros that cannot be decoded, or are too many or too few.
    Frame,
}

impl Spoil {
    /// What is wrong, in words that follow "line 7".
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::BeforeNames => "comes before the names of the columns",
            Self::Cells => "has more or fewer cells than there are columns",
            Self::Unreadable => "has a cell that is no finite number",
            Self::Checksum => "does not fit its checksum",
            Self::Unchecked => "has no checksum, and rows before it had one",
            Self::TooLong => "is longer than a mebibyte",
            Self::Frame => "is no frame of 25 bytes",
        }
    }
}

/// Spoilt rows of one kind.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SpoiltRows {
    /// What is wrong with them.
    pub kind: Spoil,
    /// How many there are.
    pub count: u64,
    /// The line (of frames: the frame) of the first, counted from 1 since the source was opened.
    pub line: u64,
    /// How the first begins; bytes of frames in hexadecimal.
    pub text: String,
}

/// Spoilt rows by kind, in the order in which the kinds first came.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// Spoilt rows of each kind that came.
    pub(crate) kinds: Vec<SpoiltRows>,
}

impl Tally {
    /// Rows of one kind.
    #[must_use]
    pub fn count(&self, kind: Spoil) -> u64 {
        self.kinds.iter().find(|rows| rows.kind == kind).map_or(0, |rows| rows.count)
    }

    /// Rows of all kinds that should have been rows: without what came before the names.
    #[must_use]
    pub fn spoilt(&self) -> u64 {
        self.kinds.iter().filter(|rows| rows.kind != Spoil::BeforeNames).map(|rows| rows.count).sum()
    }

    /// Counts a row; its text is made only for the first of its kind.
    pub(crate) fn add(&mut self, kind: Spoil, line: u64, text: impl FnOnce() -> String) {
        match self.kinds.iter_mut().find(|rows| rows.kind == kind) {
            Some(rows) => rows.count += 1,
            None => self.kinds.push(SpoiltRows { kind, count: 1, line, text: text() }),
        }
    }
}

/// How a line begins, without control characters.
pub(in crate::wire) fn shown(line: &[u8]) -> String {
    // A character has at most four bytes.
    let head = String::from_utf8_lossy(&line[..line.len().min(4 * MOST_CHARS + 4)]).into_owned();
    let plain = |c: char| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c };
    let mut text: String = head.chars().take(MOST_CHARS).map(plain).collect();
    if head.chars().count() > MOST_CHARS {
        text.push_str("..");
    }
    text
}

/// How a frame begins.
pub(in crate::wire) fn shown_bytes(frame: &[u8]) -> String {
    let mut text = String::new();
    for byte in frame.iter().take(MOST_CHARS / 2) {
        text.push_str(&format!("{byte:02x}"));
    }
    text
}
