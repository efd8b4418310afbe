//! Waiting for several streams at once, and the clock by which it is done.

use std::io;
use std::os::fd::BorrowedFd;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::source::stream::Stream;

/// How many streams and other descriptors can be waited for at once.
pub const MOST_WAITED: usize = 32;

/// The host's monotonic clock since a session began.
#[derive(Debug, Clone, Copy)]
pub struct HostClock(Instant);

impl HostClock {
    /// A session that begins now.
    #[must_use]
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Nanoseconds since then.
    #[must_use]
    pub fn now_ns(&self) -> u64 {
        self.0.elapsed().as_nanos() as u64
    }
}

/// What there is to do after waiting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Ready {
    streams: u32,
    others: u32,
}

impl Ready {
    /// Whether bytes came for a stream, or its time has come.
    #[must_use]
    pub fn stream(&self, at: usize) -> bool {
        self.streams.checked_shr(at as u32).is_some_and(|bits| bits & 1 == 1)
    }

    /// Whether bytes came for one of the other descriptors.
    #[must_use]
    pub fn other(&self, at: usize) -> bool {
        self.others.checked_shr(at as u32).is_some_and(|bits| bits & 1 == 1)
    }
}

/// Waits until a stream or one of the `others` has something to read, a stream is due, or it is `until_ns` by `clock`.
/// Nothing is allocated.
///
/// # Errors
/// There are more than [`MOST_WAITED`], or the system can't wait.
pub fn wait(
    streams: &[&Stream],
    others: &[BorrowedFd<'_>],
    until_ns: Option<u64>,
    clock: &HostClock,
) -> io::Result<Ready> {
    if streams.len() + others.len() > MOST_WAITED {
        return Err(io::Error::other(format!("more than {MOST_WAITED} streams and descriptors to wait for")));
    }
    let due_ns = streams.iter().filter_map(|stream| stream.due_ns()).chain(until_ns).min();
    let now_ns = clock.now_ns();
    let left = due_ns.map(|due_ns| Duration::from_nanos(due_ns.saturating_sub(now_ns)));
    let all = || streams.iter().map(|stream| stream.fd()).chain(others.iter().copied().map(Some)).enumerate();
    let mut waited = all().filter_map(|(at, fd)| fd.map(|fd| (at, fd)));
    let mut places = [usize::MAX; MOST_WAITED];
    let Some((first_place, first)) = waited.next() else {
        if let Some(left) = left {
            std::thread::sleep(left);
        }
        return Ok(ready_by_time(streams, clock.now_ns()));
    };
    let mut fds: [PollFd<'_>; MOST_WAITED] = std::array::from_fn(|_| PollFd::from_borrowed_fd(first, PollFlags::IN));
    places[0] = first_place;
    let mut count = 1;
    for (place, fd) in waited {
        fds[count] = PollFd::from_borrowed_fd(fd, PollFlags::IN);
        places[count] = place;
        count += 1;
    }
    let timeout = left.map(|left| Timespec { tv_sec: left.as_secs() as i64, tv_nsec: left.subsec_nanos().into() });
    match poll(&mut fds[..count], timeout.as_ref()) {
        // A signal: the caller looks why.
        Ok(_) | Err(rustix::io::Errno::INTR) => {}
        Err(why) => return Err(why.into()),
    }
    let mut ready = ready_by_time(streams, clock.now_ns());
    for (fd, place) in fds[..count].iter().zip(places) {
        if fd.revents().is_empty() {
            continue;
        }
        match place.checked_sub(streams.len()) {
            None => ready.streams |= 1 << place,
            Some(other) => ready.others |= 1 << other,
        }
    }
    Ok(ready)
}

fn ready_by_time(streams: &[&Stream], now_ns: u64) -> Ready {
    let due = |stream: &Stream| stream.due_ns().is_some_and(|due_ns| due_ns <= now_ns);
    let bits = streams.iter().enumerate().filter(|(_, stream)| due(stream)).map(|(at, _)| 1 << at);
    Ready { streams: bits.sum(), others: 0 }
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::os::fd::AsFd;
    use std::os::unix::net::UnixStream;

    use super::*;

    #[test]
    fn others_wake_it_and_so_does_the_clock() {
        let clock = HostClock::start();
        let (ours, mut theirs) = UnixStream::pair().unwrap();
        let (silent, _open) = UnixStream::pair().unwrap();
        let others = [silent.as_fd(), ours.as_fd()];
        let until_ns = clock.now_ns() + 5_000_000;
        assert_eq!(wait(&[], &others, Some(until_ns), &clock).unwrap(), Ready::default());
        assert!(clock.now_ns() >= until_ns);
        theirs.write_all(b"x").unwrap();
        let ready = wait(&[], &others, None, &clock).unwrap();
        assert!(ready.other(1) && !ready.other(0) && !ready.stream(0) && !ready.other(99));
        let many = [ours.as_fd(); MOST_WAITED + 1];
        assert!(wait(&[], &many, None, &clock).is_err());
        assert!(wait(&[], &many[1..], None, &clock).unwrap().other(MOST_WAITED - 1));
    }
}
