//! Standard output: every word that the program says there goes through here.
//!
//! A reader that has gone away is no error of ours. Any other failed write is, whatever else was done: the first one is
//! kept, what follows is not written any more, and [`finish`] hands it out.

use std::io::{self, ErrorKind, Write};
use std::os::fd::{AsFd, OwnedFd};
use std::sync::{Mutex, PoisonError};

static FAILED: Mutex<Option<io::Error>> = Mutex::new(None);

/// Notes how a write went.
pub(super) fn note(written: io::Result<()>) {
    if let Err(why) = written {
        FAILED.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
    }
}

fn has_failed() -> bool {
    FAILED.lock().unwrap_or_else(PoisonError::into_inner).is_some()
}

pub(super) fn print_line(text: &str) {
    print(format!("{text}\n").as_bytes());
}

/// Bytes as they are.
pub(super) fn print(bytes: &[u8]) {
    if !has_failed() {
        note(io::stdout().write_all(bytes));
    }
}

/// Ends what was said.
///
/// # Errors
/// What became of it, unless its reader went away.
pub(super) fn finish() -> io::Result<()> {
    note(io::stdout().flush());
    match FAILED.lock().unwrap_or_else(PoisonError::into_inner).take() {
        Some(why) if why.kind() != ErrorKind::BrokenPipe => Err(why),
        _ => Ok(()),
    }
}

/// Standard output for a session that writes rows as its reader takes them.
pub(super) fn descriptor() -> io::Result<OwnedFd> {
    io::stdout().as_fd().try_clone_to_owned()
}
