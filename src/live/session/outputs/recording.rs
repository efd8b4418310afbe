//! A recording that is on disk while it grows: killed at any moment, it lacks a second at most.
//!
//! In: rows of text. Out: a CSV file as `align`, `train` and `fit` read it; where a Parquet table is asked for, it is
//! made of that file at the end. A thread of its own writes four times a second and makes the disk keep it twice, so
//! that a slow disk never holds a sample up. Nothing is written before the first row, and nothing that exists is
//! replaced unless that is asked for.

use std::fs::{File, OpenOptions};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::files::{WriteError, create_growing, folder_of, is_taken};
use crate::live::error::LiveError;
use crate::table::{Column, TableFormat, TableWriter, Value};

/// How often rows are written, and the disk is made to keep them.
const WRITE: Duration = Duration::from_millis(250);
const SYNC: Duration = Duration::from_millis(500);
/// What may wait for a disk: about ten minutes of eight photodiodes at 1 kHz; and what is written before its time.
const MOST_BYTES: usize = 64 << 20;
const MUCH_BYTES: usize = 4 << 20;

/// A file that grows.
#[derive(Debug)]
pub(crate) struct Recording {
    out: PathBuf,
    /// The file that grows: `out`, or beside it where that is to be Parquet.
    grows: PathBuf,
    columns: Vec<String>,
    replace: bool,
    /// Whether the source can wait for the disk: then nothing is lost.
    waits: bool,
    shared: Arc<Shared>,
    writer: Option<JoinHandle<io::Result<()>>>,
    begun: bool,
    /// Rows that were handed on to be written.
    handed_on: u64,
    /// Rows that the file lacks, as the disk was too slow or full; all of them once it is closed.
    pub(crate) lost: u64,
}

#[derive(Debug, Default)]
struct Shared {
    pending: Mutex<Pending>,
    wake: Condvar,
}

#[derive(Debug, Default)]
struct Pending {
    bytes: Vec<u8>,
    ends: bool,
    failed: bool,
    /// Rows that the file has.
    written: u64,
}

impl Recording {
    /// A recording, not begun yet; `waits` where the source can wait for the disk.
    ///
    /// # Errors
    /// A name that is no table's, a file that exists and is not to be replaced or grows already, or a place that can't
    /// be written to: nobody is recorded for nothing.
    pub(crate) fn new(out: &Path, replace: bool, waits: bool) -> Result<Self, LiveError> {
        let grows = match TableFormat::of(out)? {
            TableFormat::Csv => out.to_owned(),
            TableFormat::Parquet => PathBuf::from(format!("{}.csv", out.display())),
        };
        for path in [out, &grows] {
            if !replace && path.exists() {
                return Err(LiveError::Exists(path.to_owned()));
            }
        }
        if OpenOptions::new().write(true).open(&grows).is_ok_and(|file| is_taken(&file)) {
            return Err(LiveError::Taken(grows));
        }
        let folder = folder_of(&grows);
        let there = folder.ancestors().find(|at| at.exists()).unwrap_or(Path::new("."));
        tempfile::tempfile_in(there).map_err(|why| WriteError::Folder { path: there.to_owned(), why })?;
        Ok(Self {
            out: out.to_owned(),
            grows,
            columns: Vec::new(),
            replace,
            waits,
            shared: Arc::default(),
            writer: None,
            begun: false,
            handed_on: 0,
            lost: 0,
        })
    }

    /// Names the columns; before the first row.
    pub(crate) fn name(&mut self, columns: Vec<String>) {
        self.columns = columns;
    }

    /// Adds a row with its end.
    ///
    /// # Errors
    /// The file can't be made, or could not be written.
    pub(crate) fn push(&mut self, row: &str) -> Result<(), LiveError> {
        self.begin()?;
        let mut pending = self.shared.pending.lock().unwrap_or_else(PoisonError::into_inner);
        if pending.failed {
            drop(pending);
            self.lost += 1;
            return Err(self.close().err().unwrap_or_else(|| self.refused(io::ErrorKind::Other.into())));
        }
        if pending.bytes.len() + row.len() > MUCH_BYTES {
            self.shared.wake.notify_all();
        }
        while self.waits && !pending.failed && pending.bytes.len() + row.len() > MOST_BYTES {
            // The writer says when it has taken what there was.
            pending = self.shared.wake.wait(pending).unwrap_or_else(PoisonError::into_inner);
        }
        if pending.bytes.len() + row.len() > MOST_BYTES {
            self.lost += 1;
        } else {
            pending.bytes.extend_from_slice(row.as_bytes());
            self.handed_on += 1;
        }
        Ok(())
    }

    /// Makes the file, with the names of its columns, unless that is done.
    ///
    /// # Errors
    /// It can't be made.
    pub(crate) fn begin(&mut self) -> Result<(), LiveError> {
        if self.begun {
            return Ok(());
        }
        let mut file = create_growing(&self.grows, self.replace).map_err(|why| self.refused(why))?;
        let header = self.columns.join(",") + "\n";
        file.write_all(header.as_bytes()).map_err(|why| self.refused(why))?;
        self.begun = true;
        let shared = Arc::clone(&self.shared);
        self.writer = Some(std::thread::spawn(move || {
            let written = write_rows(&mut file, header.len() as u64, &shared);
            shared.pending.lock().unwrap_or_else(PoisonError::into_inner).failed = written.is_err();
            shared.wake.notify_all();
            written
        }));
        Ok(())
    }

    fn refused(&self, why: io::Error) -> LiveError {
        LiveError::Write { path: self.grows.clone(), why }
    }

    /// Whether a row came, and the file was begun.
    pub(crate) fn is_begun(&self) -> bool {
        self.begun
    }

    /// Ends the file that grows.
    ///
    /// # Errors
    /// What could not be written; the rows before it stay.
    pub(crate) fn close(&mut self) -> Result<(), LiveError> {
        self.shared.pending.lock().unwrap_or_else(PoisonError::into_inner).ends = true;
        self.shared.wake.notify_all();
        let Some(writer) = self.writer.take() else { return Ok(()) };
        let written = writer.join().unwrap_or_else(|_| Err(io::ErrorKind::Other.into()));
        self.lost += self.handed_on - self.shared.pending.lock().unwrap_or_else(PoisonError::into_inner).written;
        written.map_err(|why| self.refused(why))
    }

    /// Ends it: all rows are on disk, in the format asked for. Whether there is a recording.
    ///
    /// # Errors
    /// What could not be written; what was written before stays.
    pub(crate) fn finish(mut self) -> Result<bool, LiveError> {
        self.close()?;
        // What failed was said when it was closed.
        if !self.begun || self.shared.pending.lock().unwrap_or_else(PoisonError::into_inner).failed {
            return Ok(false);
        }
        if !self.grows.exists() {
            return Err(self.refused(io::Error::new(io::ErrorKind::NotFound, "it was removed while it was written")));
        }
        if self.grows != self.out {
            self.to_parquet()?;
            std::fs::remove_file(&self.grows).map_err(|why| self.refused(why))?;
        }
        Ok(true)
    }

    /// The rows as a Parquet table.
    fn to_parquet(&self) -> Result<(), LiveError> {
        let columns = self.columns.iter().map(Column::number).collect();
        let mut table = TableWriter::create(&self.out, &self.out, columns, &[])?;
        let refused = |why: csv::Error| self.refused(why.into());
        let mut rows = csv::Reader::from_path(&self.grows).map_err(refused)?;
        let mut row = csv::StringRecord::new();
        while rows.read_record(&mut row).map_err(refused)? {
            let cells: Vec<Value<'_>> =
                row.iter().map(|cell| Value::Number(cell.parse().unwrap_or(f64::NAN))).collect();
            table.write(&cells)?;
        }
        Ok(table.finish()?)
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

/// Writes what comes until it ends, behind the `length` bytes that are there. Where the disk is full no half row is
/// left, whose last number would be a wrong one.
fn write_rows(file: &mut File, mut length: u64, shared: &Shared) -> io::Result<()> {
    let mut bytes = Vec::new();
    let mut synced = Instant::now();
    loop {
        let ends = {
            let pending = shared.pending.lock().unwrap_or_else(PoisonError::into_inner);
            let waits = |pending: &mut Pending| !pending.ends && pending.bytes.len() < MUCH_BYTES;
            let waited = shared.wake.wait_timeout_while(pending, WRITE, waits);
            let mut pending = waited.unwrap_or_else(PoisonError::into_inner).0;
            // What was written is room for what comes.
            bytes.clear();
            std::mem::swap(&mut bytes, &mut pending.bytes);
            shared.wake.notify_all();
            pending.ends
        };
        let written = file.write_all(&bytes);
        let reached = match written {
            Ok(()) => bytes.len(),
            Err(_) => (file.stream_position().unwrap_or(length) - length) as usize,
        };
        let whole = bytes[..reached].iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1);
        length += whole as u64;
        let rows = memchr::memchr_iter(b'\n', &bytes[..whole]).count() as u64;
        shared.pending.lock().unwrap_or_else(PoisonError::into_inner).written += rows;
        if written.is_err() {
            let _ = file.set_len(length);
            return written;
        }
        if ends || synced.elapsed() >= SYNC {
            file.sync_data()?;
            synced = Instant::now();
        }
        if ends {
            return Ok(());
        }
    }
}
