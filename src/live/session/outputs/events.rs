//! A file of events, one line of JSON each: of switches or the pointer. Made only once nothing else can go wrong.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::files::folder_of;
use crate::live::error::LiveError;

/// A file that grows by lines, each on disk when it is written.
#[derive(Debug)]
pub(crate) struct EventsFile<W = BufWriter<File>> {
    path: PathBuf,
    to: W,
}

impl EventsFile {
    /// Makes it; none where none is asked for.
    ///
    /// # Errors
    /// It can't be made.
    pub(crate) fn create(path: Option<&Path>) -> Result<Option<Self>, LiveError> {
        let Some(path) = path else { return Ok(None) };
        let made = std::fs::create_dir_all(folder_of(path)).and_then(|()| File::create(path));
        let file = made.map_err(|why| LiveError::Write { path: path.to_owned(), why })?;
        Ok(Some(Self { path: path.to_owned(), to: BufWriter::new(file) }))
    }

    /// Writes an event.
    ///
    /// # Errors
    /// It failed.
    pub(crate) fn write(&mut self, event: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), LiveError> {
        self.with(|to| event(to).and_then(|()| to.flush()))
    }
}

impl<W> EventsFile<W> {
    /// The same, written to through another writer.
    pub(crate) fn through<V>(self, writer: impl FnOnce(W) -> V) -> EventsFile<V> {
        EventsFile { path: self.path, to: writer(self.to) }
    }

    /// Writes as the writer does.
    ///
    /// # Errors
    /// It failed.
    pub(crate) fn with(&mut self, event: impl FnOnce(&mut W) -> io::Result<()>) -> Result<(), LiveError> {
        event(&mut self.to).map_err(|why| LiveError::Write { path: self.path.clone(), why })
    }
}
