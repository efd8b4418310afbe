//! Input files: what may be read at all, and how much of it.
//!
//! A regular file is read; a pipe (`<(zcat log.csv.gz)`, `/dev/stdin`) is read once, kept, and read again from there,
//! for most inputs are looked at twice. Whoever waits for a pipe can be interrupted ([`interrupt`]). Devices, which
//! never end (`/dev/zero`), sockets and folders are refused. What unpacks to far more than it is, or never ends, is
//! refused before it fills the memory.
//!
//! What the system refuses comes in words: what is not there with the name that it may have meant. Errors keep their
//! kind; whoever shows them puts the path before.

mod copies;

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, Cursor, ErrorKind, Read};
use std::os::unix::fs::{FileTypeExt as _, MetadataExt as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use crate::words::{composed, nearest};
pub(crate) use copies::{copies, same_to_the_byte};

/// The most that a pipe may bring (assumed: two hours of eight photodiodes at 1 kHz are 0.6 GB of CSV).
pub const PIPE_BYTES: u64 = 1 << 30;
/// What a packed file may unpack to, however small it is.
pub const UNPACKED_BYTES: u64 = 64 << 20;
/// Beyond that, how many times its size (measured: logs of photodiodes as CSV pack to a third to a twentieth; deflate's
/// own most is 1032).
pub const UNPACKED_TIMES: u64 = 200;
/// How often it is looked whether somebody interrupts a wait.
const PATIENCE: Duration = Duration::from_millis(20);

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static CUT: AtomicBool = AtomicBool::new(false);
/// Bytes by device and inode.
type ByPlace = HashMap<(u64, u64), Arc<[u8]>>;
/// What pipes brought.
static HELD: Mutex<Option<ByPlace>> = Mutex::new(None);

/// Ends every wait for a pipe, now and later.
pub fn interrupt() {
    INTERRUPTED.store(true, Ordering::Relaxed);
}

/// Whether a wait was ended by [`interrupt`].
#[must_use]
pub fn was_cut() -> bool {
    CUT.load(Ordering::Relaxed)
}

/// An input being read.
pub(crate) enum Input {
    File(File),
    Held(Cursor<Arc<[u8]>>),
}

impl Read for Input {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(into),
            Self::Held(bytes) => bytes.read(into),
        }
    }
}

/// Opens a file or a pipe.
pub(crate) fn open(path: &Path) -> io::Result<Input> {
    let about = fs::metadata(path).map_err(|why| in_words(path, why))?;
    if about.file_type().is_fifo() {
        return Ok(Input::Held(Cursor::new(piped(path, (about.dev(), about.ino()))?)));
    }
    Ok(Input::File(open_regular(path)?))
}

/// Opens a file whose places are read in any order: no pipe.
pub(crate) fn open_regular(path: &Path) -> io::Result<File> {
    let kind = fs::metadata(path).map_err(|why| in_words(path, why))?.file_type();
    let what = if kind.is_dir() {
        return Err(in_words(path, ErrorKind::IsADirectory.into()));
    } else if kind.is_file() {
        return File::open(path).map_err(|why| in_words(path, why));
    } else if kind.is_fifo() {
        "is a pipe, and this is not read from the front to the back: write it to a file first"
    } else if kind.is_socket() {
        "is a socket, no file"
    } else {
        "is a device, no file"
    };
    Err(io::Error::new(ErrorKind::InvalidInput, what))
}

/// Whether a path is of what is no file and no folder: a pipe, a socket, a device. Where a folder is searched nobody
/// means those, and reading one may wait for ever.
pub(crate) fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|kind| !kind.is_file() && !kind.is_dir())
}

/// What a folder holds, in the order of the names.
pub(crate) fn list(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).map_err(|why| match why.kind() {
        ErrorKind::NotADirectory if folder.is_file() => io::Error::new(why.kind(), "is a file, no folder"),
        _ => in_words(folder, why),
    })?;
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    paths.retain(|path| !is_special(path));
    paths.sort();
    Ok(paths)
}

/// What was refused, in words that say what to do.
pub(crate) fn in_words(path: &Path, why: io::Error) -> io::Error {
    match why.kind() {
        kind @ (ErrorKind::NotFound | ErrorKind::NotADirectory) => io::Error::new(kind, Missing(path.to_owned())),
        kind @ ErrorKind::IsADirectory => io::Error::new(kind, "is a folder; name a file in it"),
        kind @ ErrorKind::PermissionDenied => {
            io::Error::new(kind, "may not be read by this user; change its permissions")
        }
        kind => io::Error::new(kind, format!("cannot be read ({why})")),
    }
}

/// A path that leads nowhere. What it may have meant is looked for as it is shown: often nobody minds.
#[derive(Debug, thiserror::Error)]
#[error("{}", missing(.0))]
struct Missing(PathBuf);

/// Names of a folder among which a slip of the finger is looked for (assumed: a set of photographs).
const MOST_NAMES: usize = 10_000;

/// Where a path ends that leads nowhere, and what there is of nearly that name.
#[must_use]
pub fn missing(path: &Path) -> String {
    // The first part that is not there, and the folder that lacks it.
    let parent = |path: &Path| match path.parent() {
        Some(at) if at.as_os_str().is_empty() => Some(PathBuf::from(".")),
        other => other.map(Path::to_owned),
    };
    let (mut part, mut folder) = (path.to_owned(), parent(path));
    while let Some(at) = folder.take_if(|at| !at.exists()) {
        folder = parent(&at);
        part = at;
    }
    let what = if part == path { String::new() } else { format!(": there is no folder {}", part.display()) };
    if part.is_symlink() {
        return format!("is not there{what}; it is a link that leads nowhere: make it again");
    }
    let Some(folder) = folder.filter(|at| at.is_dir()) else {
        return "is not there: what its path leads through is a file, no folder".to_owned();
    };
    let names = fs::read_dir(&folder).into_iter().flatten().flatten().take(MOST_NAMES);
    let mut names: Vec<String> = names.filter_map(|one| one.file_name().into_string().ok()).collect();
    names.sort();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let name = part.file_name().unwrap_or_default().to_string_lossy();
    match nearest(&name, &names) {
        Some(near) => format!("is not there{what}; did you mean `{}`?", part.with_file_name(near).display()),
        None => format!("is not there{what}; check its name"),
    }
}

/// The file in the folder of `path`, among those that fit, of a name that looks the same up to its ending: its accents
/// are encoded in another way, as a Mac does.
pub(crate) fn encoded_otherwise(path: &Path, fits: impl Fn(&Path) -> bool) -> Option<PathBuf> {
    let stem = path.file_stem()?.to_str().filter(|stem| !stem.is_ascii())?;
    let folder = path.parent().filter(|at| !at.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let looks_the_same = |other: &PathBuf| {
        let other = other.file_stem().and_then(|other| other.to_str());
        other.is_some_and(|other| other != stem && composed(other) == composed(stem))
    };
    list(folder).ok()?.into_iter().find(|other| looks_the_same(other) && fits(other))
}

/// All of a file or a pipe.
pub(crate) fn read(path: &Path) -> io::Result<Vec<u8>> {
    match open(path)? {
        Input::File(mut file) => {
            let mut bytes = Vec::new();
            // Refused rather than aborted where there is no such memory.
            bytes.try_reserve_exact(usize::try_from(file.metadata()?.len()).unwrap_or(usize::MAX))?;
            file.read_to_end(&mut bytes).map_err(|why| in_words(path, why))?;
            Ok(bytes)
        }
        Input::Held(bytes) => Ok(bytes.into_inner().to_vec()),
    }
}

/// Ends lines with `\n` where they end with `\r` alone, as spreadsheets on a Mac may write them.
pub(crate) fn end_lines(bytes: &mut [u8]) {
    if memchr::memchr(b'\n', bytes).is_none() {
        bytes.iter_mut().filter(|b| **b == b'\r').for_each(|b| *b = b'\n');
    }
}

pub(crate) fn read_text(path: &Path) -> io::Result<String> {
    String::from_utf8(read(path)?).map_err(|_| io::Error::new(ErrorKind::InvalidData, "is not UTF-8 text"))
}

/// All that a pipe brings, and has brought.
fn piped(path: &Path, id: (u64, u64)) -> io::Result<Arc<[u8]>> {
    // One reads, whoever else wants it waits here.
    let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
    let held = held.get_or_insert_default();
    if let Some(bytes) = held.get(&id) {
        return Ok(Arc::clone(bytes));
    }
    let (send, receive) = channel();
    let path: PathBuf = path.to_owned();
    // It waits for who may never come: it is left behind when somebody interrupts.
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        let read = File::open(path).and_then(|pipe| pipe.take(PIPE_BYTES + 1).read_to_end(&mut bytes));
        let _ = send.send(read.map(|_| bytes));
    });
    let bytes = loop {
        match receive.recv_timeout(PATIENCE) {
            Ok(read) => break read?,
            Err(RecvTimeoutError::Timeout) if !INTERRUPTED.load(Ordering::Relaxed) => {}
            Err(RecvTimeoutError::Timeout) => {
                CUT.store(true, Ordering::Relaxed);
                return Err(io::Error::other("interrupted"));
            }
            Err(RecvTimeoutError::Disconnected) => return Err(io::Error::other("the pipe's reader ended")),
        }
    };
    if bytes.len() as u64 > PIPE_BYTES {
        let what = format!("the pipe brings more than {} MiB; write it to a file first", PIPE_BYTES >> 20);
        return Err(io::Error::new(ErrorKind::FileTooLarge, what));
    }
    let bytes: Arc<[u8]> = bytes.into();
    held.insert(id, Arc::clone(&bytes));
    Ok(bytes)
}

/// What gzipped bytes hold; the others as they are.
pub(crate) fn unpack(bytes: Vec<u8>) -> Result<Vec<u8>, String> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let most = UNPACKED_BYTES.max(UNPACKED_TIMES.saturating_mul(bytes.len() as u64));
    let mut unpacked = Vec::new();
    flate2::read::MultiGzDecoder::new(&bytes[..])
        .take(most + 1)
        .read_to_end(&mut unpacked)
        .map_err(|why| format!("can't be unpacked ({why}); get it again, whole"))?;
    if unpacked.len() as u64 > most {
        return Err(format!(
            "unpacks to more than {UNPACKED_TIMES} times its size and {} MiB, as no recording does; if it is one, \
             unpack it first",
            UNPACKED_BYTES >> 20
        ));
    }
    Ok(unpacked)
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    #[test]
    fn a_small_file_that_unpacks_to_much_is_refused_as_it_is_unpacked() {
        let pack = |bytes: u64| {
            let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
            io::copy(&mut io::repeat(b'0').take(bytes), &mut packed).unwrap();
            packed.finish().unwrap()
        };
        let small = pack(1 << 20);
        assert_eq!(unpack(small).unwrap().len(), 1 << 20);
        let bomb = pack(UNPACKED_BYTES + 1);
        assert!(bomb.len() as u64 * UNPACKED_TIMES < UNPACKED_BYTES, "{}", bomb.len());
        let refused = unpack(bomb).unwrap_err();
        assert!(refused.contains("200 times") && refused.contains("64 MiB"), "{refused}");
        // Of several members each is counted.
        let half = pack(UNPACKED_BYTES / 2 + 1);
        assert!(unpack([half.clone(), half].concat()).is_err());
    }

    #[test]
    fn what_is_not_there_may_have_been_meant_otherwise() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        fs::create_dir(at("anna")).unwrap();
        fs::write(at("anna/log.csv"), "").unwrap();
        std::os::unix::fs::symlink("gone", at("link")).unwrap();
        for (path, words) in [
            ("anna/lgo.csv", "is not there; did you mean `{}/anna/log.csv`?"),
            ("ana/log.csv", "is not there: there is no folder {}/ana; did you mean `{}/anna`?"),
            ("anna/other/deep/x.csv", "is not there: there is no folder {}/anna/other; check its name"),
            ("anna/other.csv", "is not there; check its name"),
            ("anna/log.csv/x", "is not there: what its path leads through is a file, no folder"),
            ("link", "is not there; it is a link that leads nowhere: make it again"),
            ("link/x", "is not there: there is no folder {}/link; it is a link that leads nowhere: make it again"),
            ("anna", "is a folder; name a file in it"),
        ] {
            let refused = read(&at(path)).expect_err("nothing to read");
            assert_eq!(refused.to_string(), words.replace("{}", &dir.path().display().to_string()), "{path}");
        }
        assert!(list(&at("none")).unwrap_err().to_string().starts_with("is not there"));
        assert_eq!(list(&at("anna/log.csv")).unwrap_err().to_string(), "is a file, no folder");
        assert_eq!(list(&at("anna")).unwrap(), [at("anna/log.csv")]);
        // From the folder that this runs in.
        assert_eq!(read(Path::new("Cargo.tmol")).unwrap_err().to_string(), "is not there; did you mean `Cargo.toml`?");
    }

    #[test]
    fn devices_are_refused_and_pipes_are_read_once_and_kept() {
        for device in ["/dev/zero", "/dev/null"] {
            let refused = read(Path::new(device)).unwrap_err().to_string();
            assert!(refused.contains("device"), "{refused}");
        }
        let dir = tempfile::tempdir().unwrap();
        assert_eq!(read(dir.path()).unwrap_err().kind(), ErrorKind::IsADirectory);
        let place = dir.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&place).status().unwrap().success());
        assert!(open_regular(&place).unwrap_err().to_string().contains("pipe"));
        let writer = {
            let place = place.clone();
            std::thread::spawn(move || {
                fs::OpenOptions::new().write(true).open(place).unwrap().write_all(b"time_s\n1\n")
            })
        };
        assert_eq!(read(&place).unwrap(), b"time_s\n1\n");
        writer.join().unwrap().unwrap();
        assert_eq!(read_text(&place).unwrap(), "time_s\n1\n");
    }
}
