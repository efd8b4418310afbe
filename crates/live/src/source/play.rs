//! Recordings played back by their own clock.
//!
//! A row is due when as much of the recording has passed since its first row as the pace says, by absolute deadlines: a
//! row that is late makes none after it late.

use std::fs::File;
use std::io::{ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};

use crate::latency::Latency;
use crate::source::address::Pace;
use crate::source::fault::SourceFault;
use crate::time::RowCounts;

/// Bytes that are read at a time.
const PIECE: usize = 1 << 16;

/// A row whose time has not come.
#[derive(Debug, Clone, Copy)]
pub(in crate::source) struct Waiting {
    pub(in crate::source) time_s: f64,
    pub(in crate::source) lit: Option<bool>,
    pub(in crate::source) lost: u64,
    pub(in crate::source) begins: bool,
    pub(in crate::source) due_ns: u64,
    pub(in crate::source) before: RowCounts,
}

/// A recording that is played.
pub(in crate::source) struct Play {
    pub(in crate::source) looped: bool,
    pub(in crate::source) waiting: Option<Waiting>,
    pub(in crate::source) lateness: Latency,
    /// Rows since it began, or began again.
    pub(in crate::source) rows: u64,
    /// The time of the latest row that was handed out, seconds.
    pub(in crate::source) played_s: f64,
    /// Rows after this time of the recording are held back, seconds.
    pub(in crate::source) until_s: f64,
    pub(in crate::source) file: Option<Bytes>,
    pace: Pace,
    /// The stream's time of the first row and when it was played.
    first: Option<(f64, u64)>,
}

impl Play {
    pub(in crate::source) fn new(file: Option<Bytes>, pace: Pace, looped: bool) -> Self {
        Self {
            looped,
            waiting: None,
            lateness: Latency::default(),
            rows: 0,
            played_s: f64::NAN,
            until_s: f64::INFINITY,
            file,
            pace,
            first: None,
        }
    }

    /// When a row is due; at once where its time is not known.
    pub(in crate::source) fn due_ns(&mut self, time_s: f64, now_ns: u64) -> u64 {
        let Pace::Rate(rate) = self.pace else { return 0 };
        if time_s.is_nan() {
            return 0;
        }
        let (first_s, began_ns) = *self.first.get_or_insert((time_s, now_ns));
        began_ns.saturating_add(((time_s - first_s) / rate * 1e9).max(0.0) as u64)
    }

    /// What it holds of `first_s` is due at `now_ns`.
    pub(in crate::source) fn from(&mut self, first_s: f64, now_ns: u64) {
        self.first = Some((first_s, now_ns));
        if let Some(mut row) = self.waiting {
            row.due_ns = self.due_ns(row.time_s, now_ns);
            self.waiting = Some(row);
        }
    }

    /// Whether a row is held back, whose time has come or not; rows without a time never are.
    pub(in crate::source) fn holds(&self, row: &Waiting) -> bool {
        row.time_s > self.until_s
    }

    /// How late a row is.
    pub(in crate::source) fn record(&mut self, row: &Waiting, now_ns: u64) {
        if row.due_ns > 0 {
            self.lateness.record_ns(now_ns.saturating_sub(row.due_ns));
        }
    }
}

/// The bytes of a file, a piece at a time.
pub(in crate::source) struct Bytes {
    path: PathBuf,
    file: File,
    piece: Vec<u8>,
    at: usize,
}

impl Bytes {
    /// Opens a file of lines or frames.
    ///
    /// # Errors
    /// It does not exist or is of a format that is none of them.
    pub(in crate::source) fn open(path: &Path, is_text: bool) -> Result<Self, SourceFault> {
        let failed = |what: String| SourceFault::Open { source_name: path.display().to_string(), what };
        if path.is_dir() {
            return Err(failed("is a folder; name a file in it".to_owned()));
        }
        let file = File::open(path).map_err(|why| {
            failed(match why.kind() {
                ErrorKind::NotFound => "does not exist; check its name".to_owned(),
                _ => format!("cannot be opened ({why})"),
            })
        })?;
        let mut bytes = Self { path: path.to_owned(), file, piece: Vec::with_capacity(PIECE), at: 0 };
        bytes.more()?;
        for (magic, words) in [
            (&b"PK\x03\x04"[..], "is a spreadsheet or an archive; save it as CSV"),
            (b"\x1f\x8b", "is packed; unpack it first, as with gunzip"),
            (b"PAR1", "is a Parquet file; let its name end in .parquet"),
            (b"XDF:", "is a recording of the Lab Streaming Layer; let its name end in .xdf"),
            (b"\xff\xfe", "is in UTF-16; save it as UTF-8"),
            (b"\xfe\xff", "is in UTF-16; save it as UTF-8"),
        ] {
            if bytes.piece.starts_with(magic) {
                return Err(failed(words.to_owned()));
            }
        }
        if is_text && bytes.piece.iter().take(4096).any(|&byte| byte == 0) {
            return Err(failed("is no text; frames are played with `?form=frames`".to_owned()));
        }
        Ok(bytes)
    }

    /// The bytes that were read and not used.
    pub(in crate::source) fn left(&self) -> &[u8] {
        &self.piece[self.at..]
    }

    /// So many of them are left.
    pub(in crate::source) fn used_to(&mut self, left: usize) {
        self.at = self.piece.len() - left;
    }

    /// Reads a piece; false at the end of the file.
    pub(in crate::source) fn more(&mut self) -> Result<bool, SourceFault> {
        self.at = 0;
        self.piece.resize(PIECE, 0);
        let read = loop {
            match self.file.read(&mut self.piece) {
                Err(why) if why.kind() == ErrorKind::Interrupted => {}
                read => break read,
            }
        };
        self.piece.truncate(*read.as_ref().unwrap_or(&0));
        read.map(|count| count > 0).map_err(|why| SourceFault::Read { path: self.path.clone(), why })
    }

    /// Begins again.
    pub(in crate::source) fn rewind(&mut self) -> Result<(), SourceFault> {
        self.at = 0;
        self.piece.clear();
        self.file.rewind().map_err(|why| SourceFault::Read { path: self.path.clone(), why })
    }
}
