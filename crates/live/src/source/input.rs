//! Opening sources, and opening them again.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::net::{TcpListener, TcpStream, ToSocketAddrs, UdpSocket};
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use super::address::{Place, Source};
use crate::wire::Meaning;

/// How long a connection may take, and how often a lost source is tried again.
const CONNECT: Duration = Duration::from_secs(3);
const AGAIN: Duration = Duration::from_millis(200);

/// Why a source can't be used: where, what, and what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {what}")]
pub struct SourceFault {
    /// The source, as written.
    pub place: String,
    /// What is wrong and what to do.
    pub what: String,
}

/// Rows that are no bytes: of tables that are not text, or generated.
pub trait Rows {
    /// The columns' names.
    fn names(&self) -> &[String];

    /// What the columns mean, once that is known: which are texts.
    fn keep(&mut self, meaning: &Meaning) {
        let _ = meaning;
    }

    /// The next row into `cells`, one number for each name, NaN where missing, `led` as 0 or 1; and its `texts`.
    /// Whether there is one.
    ///
    /// # Errors
    /// What is wrong, and where.
    fn next(&mut self, cells: &mut [f64], texts: &mut [Vec<u8>]) -> Result<bool, String>;
}

/// What bytes or rows come out of.
pub(super) enum Input {
    Bytes(OwnedFd),
    /// Datagrams.
    Datagrams(UdpSocket),
    /// Waits for a device to connect.
    Listening(TcpListener),
    File(File),
    Rows(Box<dyn Rows>),
    /// Looked for by a thread.
    Lost(Search),
    Ended,
}

/// A thread that tries to open a source.
pub(super) struct Search {
    found: Receiver<OwnedFd>,
    wanted: Arc<AtomicBool>,
}

impl Search {
    pub(super) fn start(place: &Place) -> Self {
        let (send, found) = channel();
        let wanted = Arc::new(AtomicBool::new(true));
        let (place, goes_on) = (place.clone(), Arc::clone(&wanted));
        std::thread::spawn(move || {
            while goes_on.load(Ordering::Relaxed) {
                if let Ok(Input::Bytes(fd)) = open_place(&place) {
                    let _ = send.send(fd);
                    return;
                }
                std::thread::sleep(AGAIN);
            }
        });
        Self { found, wanted }
    }

    pub(super) fn found(&self) -> Option<OwnedFd> {
        self.found.try_recv().ok()
    }
}

impl Drop for Search {
    fn drop(&mut self) {
        self.wanted.store(false, Ordering::Relaxed);
    }
}

impl Input {
    /// What to wait for; none where there is nothing, or a deadline instead.
    pub(super) fn fd(&self) -> Option<BorrowedFd<'_>> {
        match self {
            Self::Bytes(fd) => Some(fd.as_fd()),
            Self::Datagrams(socket) => Some(socket.as_fd()),
            Self::Listening(listener) => Some(listener.as_fd()),
            Self::File(_) | Self::Rows(_) | Self::Lost(_) | Self::Ended => None,
        }
    }
}

/// Opens a source.
pub(super) fn open(source: &Source) -> Result<Input, SourceFault> {
    open_place(&source.place).map_err(|what| SourceFault { place: source.named(), what })
}

fn open_place(place: &Place) -> Result<Input, String> {
    match place {
        Place::Serial { path, baud } => {
            let path = path.clone().map_or_else(only_port, Ok)?;
            let port = serial2::SerialPort::open(&path, *baud).map_err(|why| no_port(&path, &why))?;
            Ok(Input::Bytes(port.into()))
        }
        Place::Tcp { address, .. } => {
            let refused =
                |why: io::Error| format!("can't connect ({why}); is the device on, and does it listen on that port?");
            let mut last = io::Error::from(ErrorKind::AddrNotAvailable);
            for address in address.to_socket_addrs().map_err(refused)? {
                match TcpStream::connect_timeout(&address, CONNECT) {
                    Ok(stream) => {
                        stream.set_nonblocking(true).and_then(|()| stream.set_nodelay(true)).map_err(refused)?;
                        return Ok(Input::Bytes(stream.into()));
                    }
                    Err(why) => last = why,
                }
            }
            Err(refused(last))
        }
        Place::TcpListen { address } => {
            let listener = TcpListener::bind(address).and_then(|one| one.set_nonblocking(true).map(|()| one));
            let refused = |why: io::Error| format!("can't listen there ({why}); does another program hold that port?");
            Ok(Input::Listening(listener.map_err(refused)?))
        }
        Place::Udp { address } => {
            let socket = UdpSocket::bind(address).and_then(|one| one.set_nonblocking(true).map(|()| one));
            let refused = |why: io::Error| format!("can't listen there ({why}); does another program hold that port?");
            Ok(Input::Datagrams(socket.map_err(refused)?))
        }
        Place::Stdin => {
            let fd = rustix::io::dup(rustix::stdio::stdin()).map_err(|why| format!("can't be read ({why})"))?;
            Ok(Input::Bytes(fd))
        }
        Place::File { path, .. } => {
            let file = File::open(path).and_then(|file| Ok((file.metadata()?.is_file(), file)));
            match file {
                Ok((true, file)) => Ok(Input::File(file)),
                Ok((false, _)) => Err("is no file; write `-` for a pipe, serial:PATH for a serial port".to_owned()),
                Err(why) => {
                    Err(format!("can't be read ({why}); give it as a path, or a source as serial:, tcp:, udp:"))
                }
            }
        }
        Place::Phantom { kind, .. } => Err(format!("no phantom `{kind}` can be opened here")),
    }
}

/// The ports that there are.
fn ports() -> Vec<PathBuf> {
    let mut ports = serial2::SerialPort::available_ports().unwrap_or_default();
    // Ports of the board itself mostly lead nowhere.
    ports.retain(|port| !port.to_string_lossy().contains("ttyS"));
    ports.sort();
    ports
}

fn listed(ports: &[PathBuf]) -> String {
    match ports {
        [] => "no serial port of a device is there: is it plugged in?".to_owned(),
        _ => {
            format!("there are {}", ports.iter().map(|port| port.display().to_string()).collect::<Vec<_>>().join(", "))
        }
    }
}

fn only_port() -> Result<PathBuf, String> {
    match &ports()[..] {
        [only] => Ok(only.clone()),
        [] => Err(listed(&[])),
        several => Err(format!("could be any of several; {}: name one", listed(several))),
    }
}

fn no_port(path: &Path, why: &io::Error) -> String {
    match why.kind() {
        ErrorKind::NotFound => format!("does not exist; {}", listed(&ports())),
        ErrorKind::PermissionDenied => format!(
            "may not be opened by this user ({why}); `sudo usermod -aG dialout $USER` and a new login allow it, or a udev \
             rule: SUBSYSTEM==\"tty\", MODE=\"0660\", GROUP=\"dialout\""
        ),
        ErrorKind::ResourceBusy => format!("is held by another program ({why}); close it (a serial monitor?)"),
        _ if path.is_dir() => "is a folder; name a port".to_owned(),
        _ => format!("can't be opened as a serial port ({why}); {}", listed(&ports())),
    }
}
