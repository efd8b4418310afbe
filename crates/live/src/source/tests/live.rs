//! Ports that come and go.

use std::io::Write;
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::Instant;

use rustix::fd::OwnedFd;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

use super::*;
use crate::wire::{Frame, Spoil};

#[test]
fn a_server_that_goes_is_found_again_within_a_second() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let at = listener.local_addr().unwrap();
    let mut reader = Reader::open(&format!("tcp:{at}"));
    let (mut peer, _) = listener.accept().unwrap();
    peer.write_all(b"time_s,n,P1\n0.1,1,1\n0.2,2,2\n0.3,3").unwrap();
    reader.rows(2);
    drop(peer);
    let gone = Instant::now();
    reader.until(Condition::Reconnecting);
    assert_eq!(reader.log.states[reader.log.states.len() - 2], Condition::Lost);
    // The half row at the seam is dropped, and the names need not come again.
    let (mut peer, _) = listener.accept().unwrap();
    peer.write_all(b"0.7,7,7\n0.8,8,8\n").unwrap();
    reader.rows(4);
    assert!(gone.elapsed() < Duration::from_secs(1), "{:?}", gone.elapsed());
    assert_eq!((reader.log.rows[2].begins, reader.log.rows[2].lost, reader.log.rows[3].begins), (true, 4, false));
    assert_eq!((reader.log.rows[2].time_s, reader.log.spoilt), (0.7, 0));
    assert_eq!(reader.log.states.last(), Some(&Condition::Ok));
    let certificate = reader.stream.certificate();
    assert_eq!((certificate.counts.rows, certificate.counts.lost, certificate.gaps_count), (4, 4, 1));
    assert_eq!(certificate.states.len(), reader.log.states.len() + 1);
}

#[test]
fn once_is_enough_where_the_address_says_so() {
    let (mut reader, mut peer) = connected("?once");
    peer.write_all(b"time_s,P1\n0.1,1\n0.2,2").unwrap();
    drop(peer);
    reader.run(|_| false).unwrap();
    assert_eq!((reader.log.rows.len(), reader.log.ended), (2, true));
    let said = refused("tcp:127.0.0.1:1");
    assert!(said.contains("nothing listens there"), "{said}");
}

#[test]
fn rows_without_a_clock_that_come_at_once_are_spread() {
    let (mut reader, mut peer) = connected("");
    peer.write_all(b"P1\n").unwrap();
    for burst in 1..=12_usize {
        peer.write_all("7\n".repeat(10).as_bytes()).unwrap();
        reader.rows(10 * burst);
        std::thread::sleep(Duration::from_millis(20));
    }
    // Of the first nothing is known before it.
    let times: Vec<f64> = reader.log.rows[10..].iter().map(|row| row.time_s).collect();
    assert!(times.windows(2).all(|pair| pair[1] > pair[0]), "{times:?}");
    for burst in reader.log.rows[10..].chunks(10) {
        let off_s = burst[9].time_s - burst[9].host_ns as f64 / 1e9;
        // Only where this machine slept the last row is not at the arrival.
        assert!(off_s <= 1e-9 && burst[9].time_s - burst[0].time_s >= 0.001, "{off_s} {burst:?}");
    }
    let certificate = reader.stream.certificate();
    assert!(certificate.burst_s.is_some_and(|burst_s| burst_s >= 0.015), "{certificate:?}");
}

#[test]
fn clients_may_come_and_go() {
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let mut reader = Reader::open(&format!("tcp-listen:{free}"));
    assert_eq!(reader.stream.state().condition, Condition::Reconnecting);
    for client in 0..3_usize {
        let mut peer = TcpStream::connect(free).unwrap();
        write!(peer, "time_s,P1\n{client}.1,1\n{client}.2,2\n").unwrap();
        reader.rows(2 * client + 2);
        drop(peer);
        reader.until(Condition::Reconnecting);
    }
    let begins: Vec<bool> = reader.log.rows.iter().map(|row| row.begins).collect();
    assert_eq!(begins, [true, false, true, false, true, false]);
    let said = refused(&format!("tcp-listen:{free}"));
    assert!(said.contains("another program listens there"), "{said}");
}

#[test]
fn datagrams_are_rows_in_any_order() {
    let free = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let mut reader = Reader::open(&format!("udp:{free}"));
    let peer = UdpSocket::bind("127.0.0.1:0").unwrap();
    // The ends of lines may be missing.
    for datagram in ["time_us,n,P1", "10,1,1\n20,2,2", "40,4,4\n", "30,3,3", "40,4,4", "50,5,5"] {
        peer.send_to(datagram.as_bytes(), free).unwrap();
    }
    reader.rows(4);
    let counts = reader.stream.certificate().counts;
    assert_eq!((counts.rows, counts.lost, counts.disorder, counts.duplicates), (4, 1, 1, 1));
    reader.until(Condition::Stalled);
}

/// A port whose other end is in our hand, under a path of its own.
fn device(path: &Path) -> OwnedFd {
    let device = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&device).unwrap();
    unlockpt(&device).unwrap();
    let name = ptsname(&device, Vec::new()).unwrap();
    // Gone before the first time.
    let _ = std::fs::remove_file(path);
    symlink(name.to_str().unwrap(), path).unwrap();
    device
}

/// A folder, a port in it, and its other end.
fn port() -> (tempfile::TempDir, PathBuf, OwnedFd) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("port");
    let plugged = device(&path);
    (folder, path, plugged)
}

/// A stream over TCP, and its other end.
fn connected(query: &str) -> (Reader, TcpStream) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let reader = Reader::open(&format!("tcp:{}{query}", listener.local_addr().unwrap()));
    (reader, listener.accept().unwrap().0)
}

fn send(device: &OwnedFd, mut bytes: &[u8]) {
    while !bytes.is_empty() {
        bytes = &bytes[rustix::io::write(device, bytes).unwrap()..];
    }
}

#[test]
fn a_serial_port_is_unplugged_and_plugged_in_again() {
    let (_folder, path, plugged) = port();
    let address = format!("serial:{}?baud=921600", path.display());
    let mut reader = Reader::open(&address);
    let busy = refused(&address);
    assert!(busy.contains("another program reads it"), "{busy}");
    send(&plugged, b"\xff\x00,7\nboot: 1\r\ntime_us,n,P1\r\n1000,1,1\r\n2000,2,2\r\n3000,");
    reader.rows(2);
    drop(plugged);
    let gone = Instant::now();
    reader.until(Condition::Reconnecting);
    // Seen at once: this allows for a machine that sleeps.
    assert!(gone.elapsed() < Duration::from_secs(1), "{:?}", gone.elapsed());
    // It comes back within a row, and starts again.
    let plugged = device(&path);
    let back = Instant::now();
    reader.until(Condition::Stalled);
    send(&plugged, b"00,8,8\r\ntime_us,n,P1\r\n500,0,5\r\n1500,1,6\r\n");
    reader.rows(4);
    assert!(back.elapsed() < Duration::from_secs(1), "{:?}", back.elapsed());
    assert_eq!((reader.log.rows[2].begins, reader.log.rows[2].lost, &reader.log.rows[2].values), (true, 0, &vec![5.0]));
    assert!(reader.log.rows[2].time_s > reader.log.rows[1].time_s, "{:?}", reader.log.rows);
    assert!((reader.log.rows[3].time_s - reader.log.rows[2].time_s - 0.001).abs() <= 1e-9, "{:?}", reader.log.rows);
    let counts = reader.stream.certificate().counts;
    assert_eq!((counts.rows, counts.set_back, reader.log.columns), (4, 1, 1));
    assert!(reader.stream.certificate().spoilt.iter().all(|rows| rows.kind == Spoil::BeforeNames));
}

#[test]
fn half_a_row_that_we_come_into_is_no_row() {
    let (_folder, path, plugged) = port();
    let columns = Some(["time_us", "P1"].map(str::to_owned).into());
    let options = StreamOptions { columns, ..StreamOptions::default() };
    let mut reader = Reader::with(&format!("serial:{}", path.display()), options).unwrap();
    send(&plugged, b"00,1\r\n2000,2\r\n3000,3\r\n");
    reader.rows(2);
    assert_eq!((reader.log.rows[0].time_s, reader.log.rows[0].begins), (0.002, true));
}

#[test]
fn frames_come_over_a_serial_port() {
    let (_folder, path, plugged) = port();
    let mut reader = Reader::open(&format!("serial:{}?form=frames&volts-per-count=0.001", path.display()));
    let frame = |n: u16| Frame {
        photodiodes: [n, 0, 1000, 4, 5, 6, 7, 65_535],
        time_us: u32::from(n) * 1000,
        counter: 65_530_u16.wrapping_add(n),
        lit: n.is_multiple_of(2),
    };
    // We come in the middle of one.
    send(&plugged, &frame(0).encoded()[9..]);
    for n in (1..20).filter(|n| *n != 5) {
        send(&plugged, &frame(n).encoded());
    }
    reader.rows(18);
    assert_eq!(reader.log.rows[4].lost, 1);
    assert_eq!(reader.log.rows[17].values, [0.019, 0.0, 1.0, 0.004, 0.005, 0.006, 0.007, 65.535]);
    assert!(reader.stream.certificate().spoilt.is_empty());
}

#[test]
fn a_port_that_is_too_slow_is_named() {
    let (_folder, path, plugged) = port();
    let mut reader = Reader::open(&format!("serial:{}", path.display()));
    send(&plugged, b"time_us,n,P1\n");
    // A kilohertz, of which every sixth row comes, as 60 bytes at 115 200 baud would.
    for n in (0..240_u32).filter(|n| n % 6 == 0 || *n < 20) {
        send(&plugged, format!("{},{n},{:040}\n", n * 1000, n).as_bytes());
    }
    reader.rows(56);
    let notes = reader.stream.certificate().notes;
    assert!(
        notes.len() == 1 && notes[0].contains("115200 baud carry") && notes[0].contains("device has 1000"),
        "{notes:?}"
    );
}

#[test]
fn another_baud_rate_is_recognized() {
    let (_folder, path, plugged) = port();
    let mut reader = Reader::open(&format!("serial:{}", path.display()));
    let noise: Vec<u8> = (0..3000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8 | 0x80).collect();
    send(&plugged, &noise);
    let said = reader.run(|_| false).unwrap_err().to_string();
    assert!(said.contains("wrong baud rate") && said.contains("?baud="), "{said}");
    assert!(reader.stream.ended());
}

#[test]
fn rows_that_an_xor_misses_do_not_move_the_clock() {
    let (mut reader, mut peer) = connected("");
    writeln!(peer, "time_us,n,P1").unwrap();
    for n in 110_000..110_300 {
        let body = format!("{},{n},{}", n * 1000, n % 7);
        let line = format!("{body}*{:02X}\n", crate::wire::xor8(body.as_bytes()));
        // Two equal digits more or less have the same XOR.
        match n {
            110_100 => write!(peer, "11{line}").unwrap(),
            110_200 => write!(peer, "{}", &line[2..]).unwrap(),
            _ => write!(peer, "{line}").unwrap(),
        }
    }
    reader.rows(298);
    let counts = reader.stream.certificate().counts;
    assert_eq!((counts.doubtful, counts.lost, counts.set_back), (2, 2, 0));
    assert!(reader.log.rows.windows(2).all(|pair| pair[1].time_s - pair[0].time_s <= 0.0021));
    // Rows that were lost in the machine's own buffers: the first one behind them waits for the next.
    for n in 110_400..110_402 {
        let body = format!("{},{n},{}", n * 1000, n % 7);
        writeln!(peer, "{body}*{:02X}", crate::wire::xor8(body.as_bytes())).unwrap();
    }
    reader.rows(300);
    let [.., first, second] = &reader.log.rows[..] else { panic!("rows") };
    let (first_n, second_n) = (110_400.0, 110_401.0);
    assert_eq!((first.values[0], second.values[0]), (first_n % 7.0, second_n % 7.0));
    assert!((first.time_s - first_n / 1e3).abs() <= 1e-9 && first.lost == 100 && first.host_ns <= second.host_ns);
}

#[test]
fn ports_that_are_not_there_are_named() {
    let said = refused("serial:/dev/ttyNOWHERE");
    assert!(said.contains("serial:/dev/ttyNOWHERE: does not exist; there "), "{said}");
}

#[test]
fn a_live_row_allocates_nothing() {
    let (Reader { mut stream, clock, .. }, mut peer) = connected("");
    let mut count = 0_u64;
    let mut cycle = |peer: &mut TcpStream, text: &[u8], rows: u64| {
        peer.write_all(text).unwrap();
        let until = count + rows;
        while count < until {
            wait(&[&stream], &[], None, &clock).unwrap();
            let mut on = |event: Event<'_>| {
                count += u64::from(matches!(event, Event::Row(_)));
                ControlFlow::Continue(())
            };
            stream.poll(clock.now_ns(), &mut on).unwrap();
        }
    };
    cycle(&mut peer, b"time_us,n,P1\n0,0,1\n", 1);
    let text: Vec<String> = (1..1000_u32).map(|row| format!("{},{row},2\n", row * 1000)).collect();
    let counted = allocation_counter::measure(|| text.iter().for_each(|row| cycle(&mut peer, row.as_bytes(), 1)));
    assert_eq!(counted.count_total, 0);
}
