//! Input files: what may be read at all, and how much of it.
//!
//! A regular file is read; a pipe (`<(zcat log.csv.gz)`, `/dev/stdin`) is read once, kept, and read again from there,
//! for most inputs are looked at twice. Whoever waits for a pipe can be interrupted ([`interrupt`]). Devices, which
//! never end (`/dev/zero`), sockets and folders are refused. What unpacks to far more than it is, or never ends, is
//! refused before it fills the memory.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, Cursor, ErrorKind, Read};
use std::os::unix::fs::{FileTypeExt as _, MetadataExt as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

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
    let about = fs::metadata(path)?;
    if about.file_type().is_fifo() {
        return Ok(Input::Held(Cursor::new(piped(path, (about.dev(), about.ino()))?)));
    }
    Ok(Input::File(open_regular(path)?))
}

/// Opens a file whose places are read in any order: no pipe.
pub(crate) fn open_regular(path: &Path) -> io::Result<File> {
    let kind = fs::metadata(path)?.file_type();
    let what = if kind.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    } else if kind.is_file() {
        return File::open(path);
    } else if kind.is_fifo() {
        "it is a pipe, and this is not read from the front to the back: write it to a file first"
    } else if kind.is_socket() {
        "it is a socket, no file"
    } else {
        "it is a device, no file"
    };
    Err(io::Error::new(ErrorKind::InvalidInput, what))
}

/// All of a file or a pipe.
pub(crate) fn read(path: &Path) -> io::Result<Vec<u8>> {
    match open(path)? {
        Input::File(mut file) => {
            let mut bytes = Vec::new();
            // Refused rather than aborted where there is no such memory.
            bytes.try_reserve_exact(usize::try_from(file.metadata()?.len()).unwrap_or(usize::MAX))?;
            file.read_to_end(&mut bytes)?;
            Ok(bytes)
        }
        Input::Held(bytes) => Ok(bytes.into_inner().to_vec()),
    }
}

/// As [`read()`], of text.
pub(crate) fn read_text(path: &Path) -> io::Result<String> {
    String::from_utf8(read(path)?).map_err(|_| io::Error::new(ErrorKind::InvalidData, "it is not UTF-8 text"))
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
