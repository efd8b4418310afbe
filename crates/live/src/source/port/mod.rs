//! Ports that bytes come from as they are sent.

mod connector;
#[cfg(feature = "lsl")]
pub(in crate::source) mod lsl;
mod serial;
mod socket;

use std::net::{TcpStream, UdpSocket};
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

pub(in crate::source) use connector::Connector;
pub(in crate::source) use serial::{hurry, open_serial, the_only_port};
pub(in crate::source) use socket::{accept, bind_udp, connect_tcp, listen};

/// An open port; reading it never waits.
pub(in crate::source) enum Port {
    Stdin,
    Serial(OwnedFd),
    Tcp(TcpStream),
    Udp(UdpSocket),
    #[cfg(feature = "lsl")]
    Lsl(std::os::unix::net::UnixStream),
}

/// What there was to read.
pub(in crate::source) enum Received {
    Bytes(usize),
    Nothing,
    /// The port was unplugged, or the other side has gone.
    Gone,
}

impl Port {
    pub(in crate::source) fn fd(&self) -> BorrowedFd<'_> {
        match self {
            Self::Stdin => rustix::stdio::stdin(),
            Self::Serial(fd) => fd.as_fd(),
            Self::Tcp(stream) => stream.as_fd(),
            Self::Udp(socket) => socket.as_fd(),
            #[cfg(feature = "lsl")]
            Self::Lsl(socket) => socket.as_fd(),
        }
    }

    /// Reads what is there, up to the buffer's length; of datagrams one.
    pub(in crate::source) fn read(&mut self, buffer: &mut [u8]) -> Received {
        // Standard input is shared with other programs: it stays as it is, and is asked before it is read.
        if matches!(self, Self::Stdin) && !is_readable(self.fd()) {
            return Received::Nothing;
        }
        match rustix::io::read(self.fd(), &mut *buffer) {
            Ok(0) if matches!(self, Self::Udp(_)) => Received::Nothing,
            Ok(0) => Received::Gone,
            Ok(count) => Received::Bytes(count),
            Err(Errno::AGAIN | Errno::INTR) => Received::Nothing,
            // A datagram of ours was refused: nothing about what is sent to us.
            Err(_) if matches!(self, Self::Udp(_)) => Received::Nothing,
            Err(_) => Received::Gone,
        }
    }
}

fn is_readable(fd: BorrowedFd<'_>) -> bool {
    let mut fds = [PollFd::from_borrowed_fd(fd, PollFlags::IN)];
    matches!(poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: 0 })), Ok(1..))
}
