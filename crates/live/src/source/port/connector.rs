//! Opens a port again without holding up the loop: a thread tries, and wakes the loop when it has it.

use std::io::{Read, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use super::Port;

/// The time between tries.
const TRY_EVERY: Duration = Duration::from_millis(200);

/// Opens a port again.
pub(in crate::source) struct Connector {
    orders: Sender<()>,
    ports: Receiver<Port>,
    wake: UnixStream,
}

impl Connector {
    /// Starts a thread that opens ports by `open` when it is asked to.
    pub(in crate::source) fn start(
        mut open: impl FnMut() -> Result<Port, String> + Send + 'static,
    ) -> std::io::Result<Self> {
        let (wake, mut waker) = UnixStream::pair()?;
        wake.set_nonblocking(true)?;
        let (orders, asked) = channel();
        let (found, ports) = channel();
        std::thread::Builder::new().name("connector".to_owned()).spawn(move || {
            // It ends with the stream, whose end of the channel closes.
            while asked.recv().is_ok() {
                loop {
                    match asked.recv_timeout(TRY_EVERY) {
                        Err(RecvTimeoutError::Disconnected) => return,
                        Err(RecvTimeoutError::Timeout) | Ok(()) => {}
                    }
                    if let Ok(port) = open() {
                        if found.send(port).is_err() || waker.write_all(&[1]).is_err() {
                            return;
                        }
                        break;
                    }
                }
            }
        })?;
        Ok(Self { orders, ports, wake })
    }

    pub(in crate::source) fn ask(&self) {
        // The thread ends only with the stream.
        let _ = self.orders.send(());
    }

    /// What is readable when there is a port.
    pub(in crate::source) fn fd(&self) -> BorrowedFd<'_> {
        self.wake.as_fd()
    }

    /// The port, when there is one.
    pub(in crate::source) fn port(&mut self) -> Option<Port> {
        let port = self.ports.try_recv().ok()?;
        let _ = self.wake.read(&mut [0; 8]);
        Some(port)
    }
}
