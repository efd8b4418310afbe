//! Rows to a reader that may be slow: standard output or a TCP client, written without ever waiting for it.
//!
//! What the reader does not take is kept up to [`MOST_BYTES`]; beyond that rows are left out, whole ones, and counted:
//! a slow reader loses what it would have shown, the recording and the decisions lose nothing. Where the source itself
//! can wait (a file played back as fast as possible, a pipe), so does the session, and nothing is left out.

use std::collections::VecDeque;
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::{Errno, write};

/// What a reader may be behind: some ten minutes of a 1 kHz stream's predictions.
const MOST_BYTES: usize = 16 << 20;
/// Once a pipe is ready, so much is taken without waiting (PIPE_BUF).
const AT_ONCE: usize = 4096;
/// Where the source waits, rows are written together up to here.
const TOGETHER: usize = 1 << 16;

/// A reader's end.
#[derive(Debug)]
pub(crate) struct Pipe {
    fd: OwnedFd,
    pending: VecDeque<u8>,
    waits: bool,
    /// Whether the reader has gone away.
    pub(crate) gone: bool,
    /// Why it can't be written, where it is not that the reader has gone away.
    failed: Option<Errno>,
    /// Rows that were left out as the reader was too slow.
    pub(crate) lost: u64,
}

impl Pipe {
    /// To a reader; `waits` where nothing is lost by waiting for it.
    pub(crate) fn new(fd: OwnedFd, waits: bool) -> Self {
        Self { fd, pending: VecDeque::with_capacity(2 * TOGETHER), waits, gone: false, failed: None, lost: 0 }
    }

    /// Adds a row with its end.
    pub(crate) fn push(&mut self, row: &str) {
        if self.gone {
            return;
        }
        if self.pending.len() + row.len() > MOST_BYTES {
            self.lost += 1;
            return;
        }
        self.pending.extend(row.as_bytes());
        if self.waits && self.pending.len() >= TOGETHER {
            self.flush();
        }
    }

    /// Writes what the reader takes now; all of it where the source waits.
    pub(crate) fn flush(&mut self) {
        while !self.pending.is_empty() && !self.gone {
            if !self.waits && !ready(self.fd.as_fd()) {
                return;
            }
            let (front, _) = self.pending.as_slices();
            let most = if self.waits { front.len() } else { front.len().min(AT_ONCE) };
            match write(&self.fd, &front[..most]) {
                Ok(written) => drop(self.pending.drain(..written)),
                Err(Errno::INTR) => {}
                Err(Errno::AGAIN) if !self.waits => return,
                Err(Errno::AGAIN) => {
                    let _ = poll(&mut [PollFd::new(&self.fd, PollFlags::OUT)], None);
                }
                Err(why) => {
                    self.gone = true;
                    self.failed = (!matches!(why, Errno::PIPE | Errno::CONNRESET)).then_some(why);
                }
            }
        }
    }

    /// At the end: gives the reader a moment to take what is left.
    pub(crate) fn finish(&mut self) {
        self.waits = true;
        self.flush();
    }

    /// Whether something is left that the reader has not taken.
    pub(crate) fn is_behind(&self) -> bool {
        !self.pending.is_empty() && !self.gone
    }

    /// Why rows could not be written; a reader that has gone away is no fault.
    pub(crate) fn failed(&self) -> Option<io::Error> {
        self.failed.map(io::Error::from)
    }
}

/// Whether something can be written without waiting.
fn ready(fd: BorrowedFd<'_>) -> bool {
    let mut fds = [PollFd::from_borrowed_fd(fd, PollFlags::OUT)];
    matches!(poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: 0 })), Ok(ready) if ready > 0)
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::Read;

    use rustix::pipe::pipe;

    use super::*;

    #[test]
    fn a_reader_that_sleeps_loses_whole_rows_and_nobody_waits() {
        let (from, to) = pipe().unwrap();
        let mut pipe = Pipe::new(to, false);
        let row = format!("{}\n", "x".repeat(999));
        for _ in 0..20_000 {
            pipe.push(&row);
            pipe.flush();
        }
        // 64 KiB are in the pipe itself.
        let kept = 20_000 - pipe.lost;
        assert!((16_000..17_500).contains(&kept) && pipe.is_behind(), "{kept}");
        let reader = std::thread::spawn(move || {
            let mut text = String::new();
            File::from(from).read_to_string(&mut text).unwrap();
            text
        });
        pipe.finish();
        drop(pipe);
        let text = reader.join().unwrap();
        assert_eq!(text.len() as u64, 1000 * kept);
        assert!(text.lines().all(|line| line.len() == 999));
    }

    #[test]
    fn where_the_source_waits_nothing_is_lost() {
        let (from, to) = pipe().unwrap();
        let reader = std::thread::spawn(move || {
            let mut text = String::new();
            File::from(from).read_to_string(&mut text).unwrap();
            text.lines().count()
        });
        let mut pipe = Pipe::new(to, true);
        (0..300_000).for_each(|k| pipe.push(&format!("{k},{k},{k},{k},{k},{k},{k},{k},{k},{k},{k}\n")));
        pipe.finish();
        assert_eq!((pipe.lost, pipe.gone), (0, false));
        drop(pipe);
        assert_eq!(reader.join().unwrap(), 300_000);
    }

    #[test]
    fn a_reader_that_has_gone_is_noticed() {
        let (from, to) = pipe().unwrap();
        drop(from);
        let mut pipe = Pipe::new(to, false);
        pipe.push("1\n");
        pipe.flush();
        assert!(pipe.gone && !pipe.is_behind());
    }
}
