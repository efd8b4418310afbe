//! Streams that come live: read when bytes are there, lost and found again.

use std::net::TcpListener;
use std::os::fd::{AsFd, BorrowedFd};
use std::path::Path;

use super::{Event, Feed, Form, Sample, Sequence, Sink, Step, Stream};
use crate::source::address::Place;
use crate::source::fault::SourceFault;
use crate::source::health::{Condition, FIRST_ROW_NS};
use crate::source::port::{
    Connector, Port, Received, accept, bind_udp, connect_tcp, hurry, listen, open_serial, the_only_port,
};
use crate::time::{Link, Verdict};
use crate::wire::{Decoded, Row};

/// The most bytes that are read at a time, and the longest datagram.
const PIECE: usize = 1 << 16;

/// The most datagrams, or pieces of rows without a clock, that are read at a time.
const PIECES: u32 = 64;

/// A port, and how it is opened again.
pub(super) struct Live {
    port: Option<Port>,
    again: Again,
    /// The columns' names, where the place knows them.
    pub(super) names: Option<Vec<String>>,
    buffer: Vec<u8>,
    /// When the port was opened, nanoseconds.
    opened_ns: u64,
    /// What is unusual about the port.
    pub(super) notes: Vec<String>,
    baud: Option<u32>,
    bytes: u64,
    /// What comes first may be the end of a row.
    pub(super) within: bool,
}

enum Again {
    /// The stream ends with the port.
    Never,
    Connect(Connector),
    Listen {
        listener: TcpListener,
        once: bool,
    },
}

impl Live {
    /// Opens a place; it waits as long as a server takes to answer.
    pub(super) fn open(place: &Place, now_ns: u64) -> Result<Self, String> {
        let no_thread = |why: std::io::Error| format!("cannot be watched ({why})");
        let (port, again) = match place {
            Place::Stdin => (Some(Port::Stdin), Again::Never),
            Place::Serial { path, baud } => {
                let path = path.clone().map_or_else(|| the_only_port(Path::new("/dev")), Ok)?;
                let port = open_serial(&path, *baud)?;
                let notes = hurry(&path, Path::new("/sys/class/tty")).into_iter().collect();
                let baud = *baud;
                let connector = Connector::start(move || open_serial(&path, baud)).map_err(no_thread)?;
                let live = Self::of(Some(port), Again::Connect(connector), now_ns);
                return Ok(Self { notes, baud: Some(baud), within: true, ..live });
            }
            Place::Tcp { to, once: true } => (Some(connect_tcp(to)?), Again::Never),
            Place::Tcp { to, once: false } => {
                let port = connect_tcp(to)?;
                let to = to.clone();
                (Some(port), Again::Connect(Connector::start(move || connect_tcp(&to)).map_err(no_thread)?))
            }
            Place::TcpListen { at, once } => (None, Again::Listen { listener: listen(at)?, once: *once }),
            Place::Udp { at } => (Some(bind_udp(at)?), Again::Never),
            #[cfg(feature = "lsl")]
            Place::Lsl(query) => {
                let (port, names) = crate::source::port::lsl::open(query)?;
                return Ok(Self { names: Some(names), ..Self::of(Some(port), Again::Never, now_ns) });
            }
            #[cfg(not(feature = "lsl"))]
            Place::Lsl(_) => {
                let what = "streams of the Lab Streaming Layer are not built in; pipe it into `-`, or build with the \
                            feature `lsl`";
                return Err(what.to_owned());
            }
            Place::File { .. } | Place::Phantom { .. } => return Err("is no port".to_owned()),
        };
        Ok(Self::of(port, again, now_ns))
    }

    fn of(port: Option<Port>, again: Again, now_ns: u64) -> Self {
        Self {
            port,
            again,
            names: None,
            // Behind a whole piece there is room for another and its end.
            buffer: vec![0; 2 * PIECE + 1],
            opened_ns: now_ns,
            notes: Vec::new(),
            baud: None,
            bytes: 0,
            within: false,
        }
    }

    pub(super) fn is_open(&self) -> bool {
        self.port.is_some()
    }

    /// That a serial port is too slow for its rows, where some were lost.
    pub(super) fn overload(&self, rows: u64, lost: u64, period_s: Option<f64>) -> Option<String> {
        // A byte takes ten bits; bridges and devices pause between some.
        const BITS: f64 = 10.0;
        const NEAR: f64 = 0.9;
        let (baud, period_s) = (f64::from(self.baud?), period_s?);
        let bytes_a_row = self.bytes as f64 / rows.max(1) as f64;
        let (carried, sent) = (baud / (BITS * bytes_a_row), 1.0 / period_s);
        (lost > 0 && carried < sent / NEAR).then(|| {
            format!(
                "{lost} rows were lost: {baud} baud carry {carried:.0} rows of {bytes_a_row:.0} bytes a second, and \
                 the device has {sent:.0}; raise the baud rate on both sides, or send frames (`form=frames`)"
            )
        })
    }

    pub(super) fn link(&self) -> Link {
        match self.port {
            Some(Port::Stdin) => Link::Pipe,
            #[cfg(feature = "lsl")]
            Some(Port::Lsl(_)) => Link::Pipe,
            _ => Link::Device,
        }
    }

    pub(super) fn fd(&self) -> Option<BorrowedFd<'_>> {
        match (&self.port, &self.again) {
            (Some(port), _) => Some(port.fd()),
            (None, Again::Connect(connector)) => Some(connector.fd()),
            (None, Again::Listen { listener, .. }) => Some(listener.as_fd()),
            (None, Again::Never) => None,
        }
    }

    /// Whether a port is open, or was found just now: `Some(true)`.
    fn find(&mut self) -> Option<bool> {
        if self.port.is_some() {
            return Some(false);
        }
        self.port = match &mut self.again {
            Again::Never => None,
            Again::Connect(connector) => connector.port(),
            Again::Listen { listener, .. } => accept(listener),
        };
        self.port.is_some().then_some(true)
    }

    /// Reads what is there: one piece, but of datagrams, and of rows without a clock, all that came by now. How many
    /// bytes, and whether the port is gone. Each datagram ends a row, which `end` shows.
    fn gather(&mut self, end: u8, has_clock: bool) -> (usize, bool) {
        let Some(port) = &mut self.port else { return (0, false) };
        let datagrams = matches!(port, Port::Udp(_));
        let mut count = 0;
        for _ in 0..PIECES {
            match port.read(&mut self.buffer[count..count + PIECE]) {
                Received::Nothing => break,
                Received::Gone => return (count, true),
                Received::Bytes(more) => {
                    self.bytes += more as u64;
                    count += more;
                    if datagrams && self.buffer[count - 1] != end {
                        self.buffer[count] = end;
                        count += 1;
                    }
                }
            }
            if !datagrams && has_clock || count >= PIECE {
                break;
            }
        }
        (count, false)
    }

    /// Closes the port; whether it is opened again.
    fn lose(&mut self) -> bool {
        self.port = None;
        match &self.again {
            Again::Never => false,
            Again::Connect(connector) => {
                connector.ask();
                true
            }
            Again::Listen { once, .. } => !once,
        }
    }
}

impl Stream {
    pub(super) fn poll_live(&mut self, now_ns: u64, on: &mut Sink<'_>) -> Result<(), SourceFault> {
        let Feed::Live(live) = &mut self.feed else { return Ok(()) };
        let Some(found) = live.find() else { return Ok(()) };
        if found {
            live.opened_ns = now_ns;
            if live.within {
                self.decoder.cut(true);
            }
            // Open, and silent until a row comes.
            let condition = if self.health.any { Condition::Stalled } else { Condition::Ok };
            if let Some(state) = self.health.set(condition, now_ns) {
                on.send(Event::State(state));
            }
            self.health.opened(now_ns);
        }
        let end = if self.form == Some(Form::Frames) { 0 } else { b'\n' };
        let has_clock = self.sequence.as_ref().is_none_or(Sequence::has_clock);
        let (count, gone) = live.gather(end, has_clock);
        if count > 0 {
            let buffer = std::mem::take(&mut live.buffer);
            let decoded = self.decode(&buffer[..count], end, now_ns, on);
            if let Feed::Live(live) = &mut self.feed {
                live.buffer = buffer;
            }
            decoded?;
        }
        match on.is_over {
            true => Ok(()),
            false if gone => self.gone(now_ns, on),
            false => self.look(now_ns, on),
        }
    }

    fn decode(&mut self, mut bytes: &[u8], end: u8, now_ns: u64, on: &mut Sink<'_>) -> Result<(), SourceFault> {
        if let Some(sequence) = self.sequence.as_mut().filter(|sequence| !sequence.has_clock()) {
            // Lines may end in CR alone.
            let ends = |end: u8| memchr::memchr_iter(end, bytes).count();
            sequence.announce(if end == b'\n' { ends(end).max(ends(b'\r')) } else { ends(end) });
        }
        while let Some(step) = self.decoder.next(&mut bytes, now_ns).map_err(|fault| self.wire(fault))? {
            self.live_step(step, now_ns, on)?;
            if on.is_over {
                break;
            }
        }
        Ok(())
    }

    fn live_step(&mut self, step: Step, now_ns: u64, on: &mut Sink<'_>) -> Result<(), SourceFault> {
        match step {
            Step::Columns { again } => self.columns(again, on),
            Step::Spoilt(kind) => {
                self.spoilt(kind, on);
                Ok(())
            }
            Step::Sample(sample) => {
                if let Some((first, host_ns)) = self.judge(&sample) {
                    self.live_row(&first, host_ns, on);
                    self.held.behind(&mut self.decoder);
                }
                if !on.is_over {
                    self.live_row(&sample, now_ns, on);
                }
                Ok(())
            }
        }
    }

    fn live_row(&mut self, sample: &Sample, now_ns: u64, on: &mut Sink<'_>) {
        let Some(sequence) = &mut self.sequence else { return };
        if self.decoder.is_sealed() {
            sequence.doubt();
        }
        let set_back = sequence.counts().set_back;
        let (time_s, lost, begins) = match sequence.take(sample, now_ns) {
            Verdict::Row { time_s, lost, begins } => (time_s, lost, begins),
            Verdict::Doubtful => return self.held.keep(*sample, now_ns, &self.decoder),
            Verdict::Duplicate | Verdict::Late => return,
        };
        if sequence.counts().set_back != set_back {
            self.envelope.clear();
        }
        if sequence.has_clock() {
            self.envelope.push(time_s, now_ns as f64 / 1e9);
        }
        self.gaps.row(time_s, begins, sequence.step_s());
        if let Some(state) = self.health.row(now_ns) {
            on.send(Event::State(state));
        }
        let Decoded { values, texts, .. } = self.decoder.decoded();
        on.send(Event::Row(&Row { host_ns: now_ns, time_s, lit: sample.lit, lost, begins, values, texts }));
    }

    /// The port was unplugged, or standard input has ended.
    fn gone(&mut self, now_ns: u64, on: &mut Sink<'_>) -> Result<(), SourceFault> {
        let Feed::Live(live) = &mut self.feed else { return Ok(()) };
        let within = live.within;
        if live.lose() {
            self.decoder.cut(within);
            if let Some(sequence) = &mut self.sequence {
                sequence.come_back();
            }
            for condition in [Condition::Lost, Condition::Reconnecting] {
                if let Some(state) = self.health.set(condition, now_ns) {
                    on.send(Event::State(state));
                }
            }
            return Ok(());
        }
        while let Some(step) = self.decoder.finish(now_ns).map_err(|fault| self.wire(fault))? {
            self.live_step(step, now_ns, on)?;
            if on.is_over {
                return Ok(());
            }
        }
        self.end(on);
        Ok(())
    }

    /// Looks whether rows come as they should.
    fn look(&mut self, now_ns: u64, on: &mut Sink<'_>) -> Result<(), SourceFault> {
        let clocked = self.sequence.as_ref().filter(|sequence| sequence.has_clock());
        let period_s = clocked.and_then(Sequence::period_s);
        if let Some(state) = self.health.look(now_ns, self.step_s(), period_s) {
            on.send(Event::State(state));
        }
        if self.garbled_for_ns().is_some_and(|since_ns| now_ns >= since_ns)
            && let Some(fault) = self.decoder.garbled()
        {
            return Err(self.wire(fault));
        }
        Ok(())
    }

    /// When what came so far, and is no text, is not a message of a device's start any more; none where it is text.
    pub(super) fn garbled_for_ns(&self) -> Option<u64> {
        // A loader speaks in the first second, and the device soon after (*assumed*).
        const LOADER: u64 = 3;
        let Feed::Live(live) = &self.feed else { return None };
        self.decoder.garbled().map(|_| live.opened_ns + LOADER * FIRST_ROW_NS)
    }
}
