//! What files hold, as SHA-256, without reading again what stands as it stood.
//!
//! A hash is remembered by the file's device and inode, and believed only where size, time of modification, time of the
//! inode's change (to the nanosecond), device and inode are all what they were, where both times lie at least
//! [`SETTLED_NS`] before the moment at which the file was read (else it could have changed again within the same tick
//! of the file system's clock), and where that moment is not in the future (else the clock was set back since).
//! Whatever is not believed is read again, so a doubt costs time and never a wrong answer. The times need not be true:
//! a picture that a camera dates to the year 2000 is believed by the inode's time, one of tomorrow is read each time.
//!
//! What is remembered is a text of one line a file that is only ever added to, and rewritten where most of it has
//! become idle: a line that was cut short is not read.

use std::collections::HashMap;
use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use thiserror::Error;

use crate::files::write_whole;
use crate::input::open_regular;

/// How long before its reading a file must have come to rest, nanoseconds: the coarsest clock of a file system in use
/// (FAT).
const SETTLED_NS: i128 = 2_000_000_000;

/// Folders within folders that are followed; deeper is a circle of links.
const DEEPEST: usize = 64;

/// The SHA-256 of some content; written as 64 hexadecimal digits.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct ContentHash([u8; 32]);

impl ContentHash {
    /// Of bytes.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        Self(Sha256::digest(bytes).into())
    }
}

impl fmt::Display for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl From<ContentHash> for String {
    fn from(hash: ContentHash) -> Self {
        hash.to_string()
    }
}

impl FromStr for ContentHash {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = "a SHA-256 is 64 hexadecimal digits";
        if text.len() != 64 || !text.is_ascii() {
            return Err(wrong);
        }
        let mut bytes = [0; 32];
        for (k, byte) in bytes.iter_mut().enumerate() {
            *byte = u8::from_str_radix(&text[2 * k..2 * k + 2], 16).map_err(|_| wrong)?;
        }
        Ok(Self(bytes))
    }
}

impl TryFrom<String> for ContentHash {
    type Error = &'static str;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

/// Why a file's content is not known.
#[derive(Debug, Error)]
pub(in crate::pipeline) enum FileFault {
    #[error("{}: is not there; put it back, or correct the pipeline file", .0.display())]
    Missing(PathBuf),
    #[error("{}: cannot be read ({why})", .path.display())]
    Unreadable { path: PathBuf, why: io::Error },
    #[error("{}: changes as it is read; run again when it is whole", .0.display())]
    Changing(PathBuf),
    #[error("{}: is neither a file nor a folder", .0.display())]
    Strange(PathBuf),
    #[error("{}: lies {DEEPEST} folders deep; look for a link that leads back to a folder above it", .0.display())]
    Deep(PathBuf),
    #[error("{}: its name is not UTF-8; rename it", .0.display())]
    Name(PathBuf),
}

impl FileFault {
    fn of(path: &Path, why: io::Error) -> Self {
        match why.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => Self::Missing(path.to_owned()),
            _ => Self::Unreadable { path: path.to_owned(), why },
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct FileId {
    device: u64,
    inode: u64,
}

/// Both times are nanoseconds since 1970.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Stat {
    size: u64,
    modified_ns: i128,
    changed_ns: i128,
}

/// What a file held when it was read last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Seen {
    stat: Stat,
    /// The moment before it was read.
    read_ns: i128,
    hash: ContentHash,
}

impl Seen {
    /// It was at rest when it was read.
    fn is_settled(&self) -> bool {
        [self.stat.modified_ns, self.stat.changed_ns].iter().all(|time| time + SETTLED_NS <= self.read_ns)
    }

    /// It holds now what it held then.
    fn is_believed(&self, stat: Stat, now_ns: i128) -> bool {
        self.stat == stat && self.is_settled() && self.read_ns <= now_ns
    }
}

fn identity(of: &fs::Metadata) -> (FileId, Stat) {
    let ns = |seconds: i64, rest: i64| i128::from(seconds) * 1_000_000_000 + i128::from(rest);
    let stat = Stat {
        size: of.size(),
        modified_ns: ns(of.mtime(), of.mtime_nsec()),
        changed_ns: ns(of.ctime(), of.ctime_nsec()),
    };
    (FileId { device: of.dev(), inode: of.ino() }, stat)
}

/// The machine's clock: nanoseconds since 1970 began.
pub(in crate::pipeline) fn now_ns() -> i128 {
    let ns = |since: std::time::Duration| i128::try_from(since.as_nanos()).unwrap_or(i128::MAX);
    SystemTime::now().duration_since(UNIX_EPOCH).map_or_else(|before| -ns(before.duration()), ns)
}

type Slot = Arc<Mutex<(Option<Seen>, bool)>>;

/// The contents of files; shared by threads.
#[derive(Debug)]
pub(in crate::pipeline) struct Hashes {
    /// Each file's slot is held while it is read, so that no two threads read it: what is known, and whether it was
    /// asked for.
    known: Mutex<HashMap<FileId, Slot>>,
    /// What is remembered ends within a line.
    is_cut: bool,
    place: Option<PathBuf>,
    log: Option<Mutex<File>>,
    lines: AtomicUsize,
    log_fails: AtomicBool,
    read: AtomicUsize,
    /// The clock: nanoseconds since 1970 began.
    now_ns: fn() -> i128,
}

impl Hashes {
    /// What is remembered at `place`, if anything; nothing is written there.
    pub(in crate::pipeline) fn look(place: &Path) -> Self {
        let text = fs::read(place).unwrap_or_default();
        let mut known = HashMap::new();
        let mut lines = 0;
        for line in text.split(|&byte| byte == b'\n') {
            lines += 1;
            if let Some((file, seen)) = std::str::from_utf8(line).ok().and_then(parse) {
                known.insert(file, Arc::new(Mutex::new((Some(seen), false))));
            }
        }
        Self {
            known: Mutex::new(known),
            is_cut: text.last().is_some_and(|&byte| byte != b'\n'),
            place: None,
            log: None,
            lines: AtomicUsize::new(lines),
            log_fails: AtomicBool::new(false),
            read: AtomicUsize::new(0),
            now_ns,
        }
    }

    /// The same, and what is learned is remembered there. Where that can't be written, files are read again the next
    /// time.
    pub(in crate::pipeline) fn keep(place: &Path) -> Self {
        let mut hashes = Self::look(place);
        let mut log = OpenOptions::new().create(true).append(true).open(place).ok();
        // A line that was cut short must not swallow the next one.
        if let Some(file) = log.as_mut().filter(|_| hashes.is_cut) {
            let _ = file.write_all(b"\n");
        }
        hashes.place = Some(place.to_owned());
        hashes.log = log.map(Mutex::new);
        hashes
    }

    /// Remembers what another folder's run remembers, of files that are not known here.
    pub(in crate::pipeline) fn learn(&self, place: &Path) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        for (file, slot) in Self::look(place).known.get_mut().unwrap_or_else(PoisonError::into_inner).drain() {
            known.entry(file).or_insert(slot);
        }
    }

    /// The same by another clock, which counts nanoseconds since 1970 began.
    #[cfg(test)]
    pub(in crate::pipeline) fn by(mut self, now_ns: fn() -> i128) -> Self {
        self.now_ns = now_ns;
        self
    }

    /// How many files were read, not remembered.
    #[cfg(test)]
    pub(in crate::pipeline) fn read(&self) -> usize {
        self.read.load(Ordering::Relaxed)
    }

    /// What a file holds, and its size in bytes.
    pub(in crate::pipeline) fn of_file(&self, path: &Path) -> Result<(ContentHash, u64), FileFault> {
        let metadata = fs::metadata(path).map_err(|why| FileFault::of(path, why))?;
        if !metadata.is_file() {
            return Err(FileFault::Strange(path.to_owned()));
        }
        let (file, stat) = identity(&metadata);
        let slot = Arc::clone(self.known.lock().unwrap_or_else(PoisonError::into_inner).entry(file).or_default());
        let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
        slot.1 = true;
        if let Some(seen) = slot.0.filter(|seen| seen.is_believed(stat, (self.now_ns)())) {
            return Ok((seen.hash, stat.size));
        }
        let (file, seen) = self.read_file(path)?;
        slot.0 = Some(seen);
        drop(slot);
        self.remember(file, &seen);
        Ok((seen.hash, seen.stat.size))
    }

    /// What a file, or all files in a folder with their names, hold.
    pub(in crate::pipeline) fn of_given(&self, path: &Path) -> Result<ContentHash, FileFault> {
        if !fs::metadata(path).map_err(|why| FileFault::of(path, why))?.is_dir() {
            return Ok(self.of_file(path)?.0);
        }
        let names = files_in(path)?;
        let hashed = names.into_iter().map(|name| {
            let (hash, _) = self.of_file(&path.join(&name))?;
            Ok((name, hash))
        });
        Ok(of_names(hashed.collect::<Result<Vec<_>, FileFault>>()?.iter().map(|(name, hash)| (name.as_str(), *hash))))
    }

    fn read_file(&self, path: &Path) -> Result<(FileId, Seen), FileFault> {
        self.read.fetch_add(1, Ordering::Relaxed);
        let fault = |why| FileFault::of(path, why);
        let read_ns = (self.now_ns)();
        let mut file = open_regular(path).map_err(fault)?;
        let before = identity(&file.metadata().map_err(fault)?);
        let mut hash = Sha256::new();
        let room = usize::try_from(before.1.size.saturating_add(1)).unwrap_or(usize::MAX);
        let mut buffer = vec![0; room.clamp(1, 1 << 18)];
        loop {
            match file.read(&mut buffer) {
                Ok(0) => break,
                Ok(count) => hash.update(&buffer[..count]),
                Err(why) if why.kind() == io::ErrorKind::Interrupted => {}
                Err(why) => return Err(fault(why)),
            }
        }
        if identity(&file.metadata().map_err(fault)?) != before {
            return Err(FileFault::Changing(path.to_owned()));
        }
        Ok((before.0, Seen { stat: before.1, read_ns, hash: ContentHash(hash.finalize().into()) }))
    }

    fn remember(&self, file: FileId, seen: &Seen) {
        let Some(log) = self.log.as_ref().filter(|_| seen.is_settled()) else { return };
        let mut log = log.lock().unwrap_or_else(PoisonError::into_inner);
        // In one piece, so that a line is there or cut short, never mixed with another.
        if log.write_all(line(file, seen).as_bytes()).is_err() {
            self.log_fails.store(true, Ordering::Relaxed);
        }
        self.lines.fetch_add(1, Ordering::Relaxed);
    }
}

impl Drop for Hashes {
    fn drop(&mut self) {
        let Some(place) = self.place.as_ref().filter(|_| !self.log_fails.load(Ordering::Relaxed)) else { return };
        let known = self.known.get_mut().unwrap_or_else(PoisonError::into_inner);
        let live: Vec<String> = known
            .iter()
            .filter_map(|(file, slot)| {
                let slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
                slot.0.filter(|seen| slot.1 && seen.is_settled()).map(|seen| line(*file, &seen))
            })
            .collect();
        if self.lines.load(Ordering::Relaxed) > 2 * live.len() + 4096 {
            // What can't be rewritten stays as it is.
            let _ = write_whole(place, live.concat().as_bytes());
        }
    }
}

/// The hash of names with what they hold; in the names' order.
pub(in crate::pipeline) fn of_names<'a>(names: impl Iterator<Item = (&'a str, ContentHash)>) -> ContentHash {
    let mut named: Vec<_> = names.collect();
    named.sort_unstable();
    let mut hash = Sha256::new();
    for (name, content) in named {
        hash.update(name.as_bytes());
        hash.update([0]);
        hash.update(content.0);
    }
    ContentHash(hash.finalize().into())
}

/// All files in a folder and the folders in it, as names with `/`, sorted. Links are followed.
pub(in crate::pipeline) fn files_in(folder: &Path) -> Result<Vec<String>, FileFault> {
    let mut names = Vec::new();
    walk(folder, "", 0, &mut names)?;
    names.sort_unstable();
    Ok(names)
}

fn walk(folder: &Path, above: &str, depth: usize, names: &mut Vec<String>) -> Result<(), FileFault> {
    if depth >= DEEPEST {
        return Err(FileFault::Deep(folder.to_owned()));
    }
    for entry in fs::read_dir(folder).map_err(|why| FileFault::of(folder, why))? {
        let entry = entry.map_err(|why| FileFault::of(folder, why))?;
        let path = entry.path();
        let name = entry.file_name().into_string().map_err(|_| FileFault::Name(path.clone()))?;
        let name = if above.is_empty() { name } else { format!("{above}/{name}") };
        let mut kind = entry.file_type().map_err(|why| FileFault::of(&path, why))?;
        if kind.is_symlink() {
            kind = fs::metadata(&path).map_err(|why| FileFault::of(&path, why))?.file_type();
        }
        match (kind.is_dir(), kind.is_file()) {
            (true, _) => walk(&path, &name, depth + 1, names)?,
            (_, true) => names.push(name),
            _ => return Err(FileFault::Strange(path)),
        }
    }
    Ok(())
}

fn line(file: FileId, seen: &Seen) -> String {
    let Seen { stat, read_ns, hash } = seen;
    let FileId { device, inode } = file;
    format!("{hash} {device} {inode} {} {} {} {read_ns} .\n", stat.size, stat.modified_ns, stat.changed_ns)
}

fn parse(line: &str) -> Option<(FileId, Seen)> {
    let words: Vec<&str> = line.split(' ').collect();
    let [hash, device, inode, size, modified, changed, read, "."] = words[..] else { return None };
    let stat =
        Stat { size: size.parse().ok()?, modified_ns: modified.parse().ok()?, changed_ns: changed.parse().ok()? };
    let file = FileId { device: device.parse().ok()?, inode: inode.parse().ok()? };
    Some((file, Seen { stat, read_ns: read.parse().ok()?, hash: hash.parse().ok()? }))
}
