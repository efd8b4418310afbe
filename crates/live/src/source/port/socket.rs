//! TCP, from either side, and UDP.

use std::io::{Error, ErrorKind};
use std::net::{TcpListener, TcpStream, ToSocketAddrs, UdpSocket};
use std::time::Duration;

use rustix::net::sockopt;

use super::Port;

/// A server that does not answer for so long is not there.
const ANSWER: Duration = Duration::from_secs(3);

/// A peer whose machine is gone is noticed after so long.
const PEER_GONE: Duration = Duration::from_secs(1);
const PEER_TRIES: u32 = 3;

/// Connects to a server at `HOST:PORT`.
pub(in crate::source) fn connect_tcp(to: &str) -> Result<Port, String> {
    let addresses = to.to_socket_addrs().map_err(|why| format!("is not known ({why}); correct the host's name"))?;
    let mut last = "has no address; correct the host's name".to_owned();
    for address in addresses {
        match TcpStream::connect_timeout(&address, ANSWER) {
            Ok(stream) => return settled(stream),
            Err(why) => last = connecting(&why),
        }
    }
    Err(last)
}

fn connecting(why: &Error) -> String {
    match why.kind() {
        ErrorKind::ConnectionRefused => {
            "refuses: nothing listens there; start the device's server, or correct the port".to_owned()
        }
        ErrorKind::TimedOut => "does not answer; is the device on, and in this network?".to_owned(),
        _ => format!("cannot be reached ({why})"),
    }
}

fn settled(stream: TcpStream) -> Result<Port, String> {
    let settle = || {
        stream.set_nonblocking(true)?;
        stream.set_nodelay(true)?;
        sockopt::set_socket_keepalive(&stream, true)?;
        sockopt::set_tcp_keepidle(&stream, PEER_GONE)?;
        sockopt::set_tcp_keepintvl(&stream, PEER_GONE)?;
        sockopt::set_tcp_keepcnt(&stream, PEER_TRIES)?;
        Ok::<_, Error>(())
    };
    settle().map_err(|why| format!("cannot be set up ({why})"))?;
    Ok(Port::Tcp(stream))
}

/// Listens at `ADDRESS:PORT`.
pub(in crate::source) fn listen(at: &str) -> Result<TcpListener, String> {
    let listener = TcpListener::bind(at).map_err(|why| binding(&why))?;
    listener.set_nonblocking(true).map_err(|why| format!("cannot be set up ({why})"))?;
    Ok(listener)
}

/// The client that waits, if there is one.
pub(in crate::source) fn accept(listener: &TcpListener) -> Option<Port> {
    listener.accept().ok().and_then(|(stream, _)| settled(stream).ok())
}

/// Takes datagrams at `ADDRESS:PORT`.
pub(in crate::source) fn bind_udp(at: &str) -> Result<Port, String> {
    let socket = UdpSocket::bind(at).map_err(|why| binding(&why))?;
    socket.set_nonblocking(true).map_err(|why| format!("cannot be set up ({why})"))?;
    Ok(Port::Udp(socket))
}

fn binding(why: &Error) -> String {
    match why.kind() {
        ErrorKind::AddrInUse => "is in use: another program listens there; close it, or take another port".to_owned(),
        ErrorKind::PermissionDenied => "is not permitted; take a port from 1024 on".to_owned(),
        ErrorKind::AddrNotAvailable => "is no address of this machine; write 0.0.0.0 for all of its own".to_owned(),
        _ => format!("cannot be listened at ({why})"),
    }
}
