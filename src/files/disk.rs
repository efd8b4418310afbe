//! Every call by which results come onto a disk, so that each can be made to fail in a test.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Up to so many files, a call for each; beyond, one for the whole disk, which waits for what others write there as
/// well. Measured on ext4 (virtual disk) with files of 4 kB: 5 to 7 ms for each file's own call, 5 to 18 ms for the
/// disk's (135 ms beside a compilation).
const FEW: usize = 16;
/// Calls at a time: the disk does them together.
const AT_ONCE: usize = 8;

pub(super) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    faults::next()?;
    fs::write(path, bytes)
}

/// Renames a file or a folder.
pub(crate) fn rename(from: &Path, to: &Path) -> io::Result<()> {
    faults::next()?;
    fs::rename(from, to)
}

/// Gives a file a second name.
pub(super) fn link(from: &Path, to: &Path) -> io::Result<()> {
    faults::next()?;
    fs::hard_link(from, to)
}

pub(super) fn make_folder(path: &Path) -> io::Result<()> {
    faults::next()?;
    fs::create_dir(path)
}

/// Has these files and folders on the disk, all of which lie on that of `within`, before it returns.
pub(crate) fn sync<'a>(paths: impl ExactSizeIterator<Item = &'a PathBuf>, within: &Path) -> io::Result<()> {
    faults::next()?;
    #[cfg(target_os = "linux")]
    if paths.len() > FEW && rustix::fs::syncfs(File::open(within)?).is_ok() {
        return Ok(());
    }
    let paths: Vec<&PathBuf> = paths.collect();
    if let [path] = paths[..] {
        return sync_one(path);
    }
    std::thread::scope(|scope| {
        let share = paths.len().div_ceil(AT_ONCE).max(1);
        let shares =
            paths.chunks(share).map(|share| scope.spawn(move || share.iter().try_for_each(|path| sync_one(path))));
        let shares: Vec<_> = shares.collect();
        shares
            .into_iter()
            .try_for_each(|share| share.join().unwrap_or_else(|_| Err(io::Error::other("a thread ended"))))
    })
}

/// A file or a folder. Some file systems (FUSE, FAT) can't do this with folders: what they can't do is no fault.
pub(super) fn sync_one(path: &Path) -> io::Result<()> {
    match File::open(path)?.sync_all() {
        Err(why) if matches!(why.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
        other => other,
    }
}

#[cfg(not(test))]
mod faults {
    pub(super) fn next() -> std::io::Result<()> {
        Ok(())
    }
}

/// Lets the N-th call of this thread fail, and if it is to be so all after it.
#[cfg(test)]
pub(super) mod faults {
    use std::cell::Cell;
    use std::io;

    thread_local! {
        /// Calls until one fails, and how many fail then.
        static LEFT: Cell<Option<(usize, usize)>> = const { Cell::new(None) };
    }

    pub(in super::super) fn fail(after: usize, count: usize) {
        LEFT.set(Some((after, count)));
    }

    /// Whether all failed that were to.
    pub(in super::super) fn end() -> bool {
        LEFT.take() == Some((0, 0))
    }

    pub(super) fn next() -> io::Result<()> {
        match LEFT.get() {
            None | Some((0, 0)) => Ok(()),
            Some((0, count)) => {
                LEFT.set(Some((0, count - 1)));
                Err(io::Error::from_raw_os_error(28))
            }
            Some((after, count)) => {
                LEFT.set(Some((after - 1, count)));
                Ok(())
            }
        }
    }
}
