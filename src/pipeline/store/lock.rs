//! One run at a time in a folder of results.
//!
//! The lock is the process's: it is free as soon as that has ended, however it ended. What stands in the file is for
//! people.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

/// Who works in a folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Holder {
    /// The process.
    pub pid: u32,
    /// The machine.
    pub host: String,
    /// Since when (UTC).
    pub since: String,
}

impl std::fmt::Display for Holder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "process {} on {}, since {}", self.pid, self.host, self.since)
    }
}

/// A lock, held as long as this lives.
#[derive(Debug)]
pub(in crate::pipeline) struct Held {
    file: File,
    /// The system's words where the file system knows no locks.
    pub(in crate::pipeline) unlocked: Option<String>,
}

impl Drop for Held {
    fn drop(&mut self) {
        // Closing is not enough where another thread is about to start a program: that holds the file too, for a
        // moment.
        let _ = self.file.unlock();
    }
}

#[derive(Debug)]
pub(in crate::pipeline) enum Refused {
    /// Somebody else holds it.
    Held(Option<Holder>),
    Io(std::io::Error),
}

/// Takes the lock, or says who has it.
pub(in crate::pipeline) fn hold(place: &Path) -> Result<Held, Refused> {
    let open = OpenOptions::new().create(true).truncate(false).read(true).write(true).open(place);
    let mut file = open.map_err(Refused::Io)?;
    let unlocked = match file.try_lock() {
        Ok(()) => None,
        Err(TryLockError::WouldBlock) => {
            return Err(Refused::Held(read_holder(&mut file)));
        }
        Err(TryLockError::Error(why)) => Some(why.to_string()),
    };
    let now = Timestamp::now().round(jiff::Unit::Second).unwrap_or_else(|_| Timestamp::now());
    let holder = Holder { pid: std::process::id(), host: host(), since: now.to_string() };
    // Whether it can be written or not, it is held; a full disk must not stop a run that has nothing to do.
    let _ = file.set_len(0).and_then(|()| file.seek(SeekFrom::Start(0)));
    let _ = serde_json::to_string(&holder).map(|text| file.write_all(text.as_bytes()));
    Ok(Held { file, unlocked })
}

/// Keeps others from taking the lock while this lives, where nobody has it; the folder may be one that can only be
/// read.
pub(in crate::pipeline) fn share(place: &Path) -> Result<Option<File>, Refused> {
    let Ok(mut file) = File::open(place) else { return Ok(None) };
    match file.try_lock_shared() {
        Err(TryLockError::WouldBlock) => Err(Refused::Held(read_holder(&mut file))),
        Ok(()) | Err(TryLockError::Error(_)) => Ok(Some(file)),
    }
}

fn read_holder(file: &mut File) -> Option<Holder> {
    let mut text = String::new();
    file.read_to_string(&mut text).ok()?;
    serde_json::from_str(&text).ok()
}

fn host() -> String {
    let host = std::fs::read_to_string("/proc/sys/kernel/hostname").ok().or_else(|| std::env::var("HOSTNAME").ok());
    host.map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).unwrap_or_else(|| "this machine".into())
}
