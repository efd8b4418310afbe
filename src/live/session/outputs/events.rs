//! A file of events, one line of JSON each: of switches or the pointer. Made only once nothing else can go wrong.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::files::create_growing;
use crate::live::error::LiveError;

/// Hardly an event's line is longer, bytes.
const USUAL: usize = 256;

/// A file that grows by lines, each handed to the system whole; nothing is allocated for one.
#[derive(Debug)]
pub(crate) struct EventsFile {
    path: PathBuf,
    to: File,
    line: Vec<u8>,
}

impl EventsFile {
    /// Makes it; none where none is asked for.
    pub(crate) fn create(path: Option<&Path>) -> Result<Option<Self>, LiveError> {
        let Some(path) = path else { return Ok(None) };
        let to = create_growing(path, true).map_err(|why| LiveError::Write { path: path.to_owned(), why })?;
        Ok(Some(Self { path: path.to_owned(), to, line: Vec::with_capacity(USUAL) }))
    }

    /// Writes an event, whose line `event` makes.
    pub(crate) fn write(&mut self, event: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> Result<(), LiveError> {
        self.line.clear();
        let written = event(&mut self.line).and_then(|()| self.to.write_all(&self.line));
        written.map_err(|why| LiveError::Write { path: self.path.clone(), why })
    }
}
