//! A source's rows as they come, its state, and what is known of its clock.
//!
//! The stream's clock, which ends holds and watchdogs, is that of its rows: of a recording nothing passes between two
//! rows, however slowly it is played; of a live source the host's time since its last row does ([`Stream::now_s`]).

use std::os::fd::{AsFd, BorrowedFd, OwnedFd};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

use super::address::{Form, Place, Rate, Source};
use super::certificate::{Span, StreamCertificate, StreamState};
use super::host::HostClock;
use super::input::{Input, Rows, Search, SourceFault, open};
use crate::latency::{Latencies, Percentiles};
use crate::time::{Envelope, Placed, Timeline};
use crate::wire::{Frames, Line, LineOptions, Lines, Meaning, Naming, Row, SpoiltKind, Use};

/// Bytes that are read at once.
const BUFFER: usize = 1 << 16;
/// Silence of so many periods, and at least so long, is a stall (assumed: a tenth of a second is a burst of USB).
const STALL_PERIODS: f64 = 3.0;
const STALL_NS: u64 = 100_000_000;
/// Over so long the rate is compared.
const RATE_NS: u64 = 1_000_000_000;
const SLOW_SHARE: f64 = 0.9;
/// States that are kept.
const MOST_STATES: usize = 100;
/// Rows of a recording that are handed out before others get their turn.
const AT_ONCE: usize = 1000;

/// How a stream is read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StreamOptions {
    /// The columns' names, where the stream does not name them.
    pub names: Option<Vec<String>>,
    /// Volts of a step of the converter, where counts are sent.
    pub volts_per_count: Option<f64>,
}

/// What a stream says.
#[derive(Debug)]
pub enum Event<'a> {
    /// The columns are known, or named again by a device that started again.
    Names {
        /// Whether they were known before.
        again: bool,
    },
    /// A row.
    Row(Row<'a>),
    /// A row was spoilt.
    Spoilt(SpoiltKind),
    /// It is doing well, or not any more.
    State(StreamState),
    /// Nothing more will come.
    End,
}

enum Decoder {
    Lines(Lines),
    Frames(Frames),
    /// Rows that are no bytes, their meaning and cells.
    Cells {
        meaning: Option<Meaning>,
        cells: Vec<f64>,
        values: Vec<f64>,
        texts: Vec<Vec<u8>>,
    },
}

/// One source.
pub struct Stream {
    source: Source,
    options: StreamOptions,
    clock: HostClock,
    input: Input,
    decoder: Decoder,
    timeline: Option<Timeline>,
    envelope: Envelope,
    buffer: Vec<u8>,
    at: usize,
    ended: bool,
    /// A recording's pace; none of live sources.
    rate: Option<Rate>,
    /// A row that is not due yet.
    held: Option<Held>,
    /// The host's and the stream's time at which playing began.
    began: Option<(u64, f64)>,
    rows: u64,
    first_s: f64,
    last_s: f64,
    last_ns: u64,
    /// The rate now: since when, rows.
    window: (u64, u64),
    usual_rows: f64,
    state: StreamState,
    states: Vec<Span>,
    changes: u64,
    lateness: Latencies,
    /// The line of the fastest rows so far, and how much later others came.
    fastest: Option<[f64; 2]>,
    arrival: Latencies,
}

#[derive(Debug, Clone, Copy)]
struct Held {
    placed: Placed,
    lit: Option<bool>,
    due_ns: u64,
}

impl Stream {
    /// Opens a source.
    ///
    /// # Errors
    /// [`SourceFault`]: it does not exist, is held by somebody else, or may not be opened.
    pub fn open(source: &Source, options: StreamOptions, clock: HostClock) -> Result<Self, SourceFault> {
        let file = matches!(source.place, Place::File { .. });
        let fault = |what: &str| SourceFault { place: source.named(), what: what.to_owned() };
        let decoder = match source.form {
            Form::Lines => Decoder::Lines(Lines::new(LineOptions {
                names: options.names.clone(),
                volts_per_count: options.volts_per_count,
                file,
            })),
            Form::Frames => Decoder::Frames(Frames::new(options.volts_per_count.ok_or_else(|| {
                fault("frames hold counts; say what a step of the converter is, as --volts-per-count 10/65536")
            })?)),
        };
        let rate = match source.place {
            Place::File { rate, .. } => Some(rate),
            _ => None,
        };
        Ok(Self::new(source.clone(), options, clock, open(source)?, decoder, rate))
    }

    /// Of rows that are no bytes, played back as the source says.
    #[must_use]
    pub fn of_rows(source: &Source, options: StreamOptions, clock: HostClock, rows: Box<dyn Rows>) -> Self {
        let rate = match source.place {
            Place::File { rate, .. } | Place::Phantom { rate, .. } => rate,
            _ => Rate::Max,
        };
        let decoder = Decoder::Cells {
            meaning: None,
            cells: vec![f64::NAN; rows.names().len()],
            values: Vec::new(),
            texts: Vec::new(),
        };
        Self::new(source.clone(), options, clock, Input::Rows(rows), decoder, Some(rate))
    }

    fn new(
        source: Source,
        options: StreamOptions,
        clock: HostClock,
        input: Input,
        decoder: Decoder,
        rate: Option<Rate>,
    ) -> Self {
        let now_ns = clock.now_ns();
        Self {
            source,
            options,
            clock,
            input,
            decoder,
            timeline: None,
            envelope: Envelope::default(),
            buffer: Vec::with_capacity(BUFFER),
            at: 0,
            ended: false,
            rate,
            held: None,
            began: None,
            rows: 0,
            first_s: f64::NAN,
            last_s: f64::NAN,
            last_ns: now_ns,
            window: (now_ns, 0),
            usual_rows: 0.0,
            state: StreamState::Ok,
            states: Vec::with_capacity(MOST_STATES),
            changes: 0,
            lateness: Latencies::default(),
            fastest: None,
            arrival: Latencies::default(),
        }
    }

    /// Whether it is a recording, which can wait, or a live source, which can't.
    #[must_use]
    pub fn can_wait(&self) -> bool {
        self.rate.is_some()
    }

    /// Whether it plays as fast as possible.
    #[must_use]
    pub fn hurries(&self) -> bool {
        self.rate == Some(Rate::Max)
    }

    /// Its state.
    #[must_use]
    pub fn state(&self) -> StreamState {
        self.state
    }

    /// Rows that came.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// The usual time between rows, seconds.
    #[must_use]
    pub fn period_s(&self) -> Option<f64> {
        self.timeline.as_ref()?.period_s()
    }

    /// The stream's time now: its last row's and what passed since on the host's clock; none of a recording, where
    /// nothing passes between rows, and before the first row.
    #[must_use]
    pub fn now_s(&self, now_ns: u64) -> Option<f64> {
        let passed_s = 1e-9 * now_ns.saturating_sub(self.last_ns) as f64;
        (self.rate.is_none() && self.last_s.is_finite()).then_some(self.last_s + passed_s)
    }

    /// The host's moment that is `time_s` of the stream's clock, as [`now_s`](Self::now_s) counts.
    #[must_use]
    pub fn moment_ns(&self, time_s: f64) -> Option<u64> {
        let ahead_s = time_s - self.last_s;
        (self.rate.is_none() && ahead_s.is_finite()).then(|| self.last_ns + (1e9 * ahead_s.max(0.0)) as u64)
    }

    /// Waits until bytes are there, `until_ns` comes, or one of `writers` can be written to; a recording waits for its
    /// next row.
    pub fn wait(&self, until_ns: u64, writers: &[BorrowedFd<'_>]) {
        let due_ns = match (&self.input, &self.held) {
            (_, Some(held)) => held.due_ns.min(until_ns),
            (Input::File(_) | Input::Rows(_), None) => return,
            _ if self.at < self.buffer.len() => return,
            _ => until_ns,
        };
        let left = self.clock.until(due_ns);
        let timeout = Timespec { tv_sec: left.as_secs() as i64, tv_nsec: i64::from(left.subsec_nanos()) };
        let reader = self.input.fd().filter(|_| self.held.is_none());
        // Without writers nothing is allocated.
        if writers.is_empty() {
            let _ = match reader {
                Some(fd) => poll(&mut [PollFd::from_borrowed_fd(fd, PollFlags::IN)], Some(&timeout)),
                None => poll(&mut [], Some(&timeout)),
            };
            return;
        }
        let mut fds: Vec<PollFd<'_>> = writers.iter().map(|fd| PollFd::from_borrowed_fd(*fd, PollFlags::OUT)).collect();
        fds.extend(reader.map(|fd| PollFd::from_borrowed_fd(fd, PollFlags::IN)));
        let _ = poll(&mut fds, Some(&timeout));
    }

    /// Hands out what has come, without waiting. `take` says whether to go on.
    ///
    /// # Errors
    /// [`SourceFault`]: the stream can't be read at all.
    pub fn poll(
        &mut self,
        naming: &mut Naming<'_>,
        take: &mut dyn FnMut(Event<'_>) -> bool,
    ) -> Result<(), SourceFault> {
        if self.ended {
            return Ok(());
        }
        let read = self.read();
        let place = || self.source.named();
        let read = read.map_err(|what| SourceFault { place: place(), what })?;
        let goes_on = if matches!(self.decoder, Decoder::Cells { .. }) {
            self.take_rows(naming, take)
        } else {
            self.take_bytes(read == Read::End, naming, take)
        };
        let goes_on = goes_on.map_err(|what| SourceFault { place: self.source.named(), what })?;
        if goes_on && self.at >= self.buffer.len() && self.held.is_none() {
            match read {
                Read::Bytes | Read::Nothing => {}
                Read::End => {
                    self.ended = true;
                    take(Event::End);
                }
                Read::Lost => self.lose(take),
            }
        }
        self.watch(take);
        Ok(())
    }

    /// Reads bytes where there is room.
    fn read(&mut self) -> Result<Read, String> {
        if self.at < self.buffer.len() || self.held.is_some() {
            return Ok(Read::Bytes);
        }
        self.buffer.clear();
        self.at = 0;
        self.buffer.resize(BUFFER, 0);
        let (read, bytes) = match &mut self.input {
            Input::Bytes(fd) => match ready(fd.as_fd()).then(|| rustix::io::read(&*fd, &mut self.buffer)) {
                None => (Read::Nothing, 0),
                Some(Ok(0)) => (self.gone(), 0),
                Some(Ok(bytes)) => (Read::Bytes, bytes),
                Some(Err(Errno::AGAIN | Errno::INTR)) => (Read::Nothing, 0),
                Some(Err(_)) => (self.gone(), 0),
            },
            Input::Datagrams(socket) => match socket.recv(&mut self.buffer[..BUFFER - 1]) {
                Ok(bytes) if matches!(self.decoder, Decoder::Lines(_)) && !self.buffer[..bytes].ends_with(b"\n") => {
                    self.buffer[bytes] = b'\n';
                    (Read::Bytes, bytes + 1)
                }
                Ok(bytes) => (Read::Bytes, bytes),
                Err(_) => (Read::Nothing, 0),
            },
            Input::Listening(listener) => match listener.accept() {
                Ok((stream, _)) => {
                    let _ = stream.set_nonblocking(true).and_then(|()| stream.set_nodelay(true));
                    self.input = Input::Bytes(OwnedFd::from(stream));
                    (Read::Nothing, 0)
                }
                Err(_) => (Read::Nothing, 0),
            },
            Input::File(file) => match std::io::Read::read(file, &mut self.buffer) {
                Ok(0) => match self.source.place {
                    Place::File { again: true, .. } if self.rows > 0 => {
                        std::io::Seek::rewind(file).map_err(|why| format!("can't be read again ({why})"))?;
                        if let Decoder::Lines(lines) = &mut self.decoder {
                            lines.cut();
                        }
                        (Read::Nothing, 0)
                    }
                    _ => (Read::End, 0),
                },
                Ok(bytes) => (Read::Bytes, bytes),
                Err(why) => return Err(format!("can't be read any further ({why})")),
            },
            Input::Lost(search) => match search.found() {
                Some(fd) => {
                    self.input = Input::Bytes(fd);
                    (Read::Nothing, 0)
                }
                None => (Read::Nothing, 0),
            },
            Input::Rows(_) => (Read::Bytes, 0),
            Input::Ended => (Read::End, 0),
        };
        self.buffer.truncate(bytes);
        Ok(read)
    }

    /// What it means that a source gives nothing more.
    fn gone(&self) -> Read {
        match &self.source.place {
            Place::Stdin | Place::Tcp { once: true, .. } => Read::End,
            _ => Read::Lost,
        }
    }

    fn lose(&mut self, take: &mut dyn FnMut(Event<'_>) -> bool) {
        match &mut self.decoder {
            Decoder::Lines(lines) => lines.cut(),
            Decoder::Frames(frames) => frames.cut(),
            Decoder::Cells { .. } => {}
        }
        if let Some(timeline) = &mut self.timeline {
            timeline.cut();
        }
        self.envelope.forget();
        self.turn(StreamState::Lost, take);
        // A listener's port is free again once its device has gone.
        self.input = match &self.source.place {
            Place::TcpListen { .. } => open(&self.source).unwrap_or(Input::Ended),
            place => Input::Lost(Search::start(place)),
        };
        self.turn(StreamState::Reconnecting, take);
    }

    /// Decodes what is in the buffer.
    fn take_bytes(
        &mut self,
        ends: bool,
        naming: &mut Naming<'_>,
        take: &mut dyn FnMut(Event<'_>) -> bool,
    ) -> Result<bool, String> {
        if let Some(held) = self.held {
            if self.clock.now_ns() < held.due_ns {
                return Ok(true);
            }
            if !self.hand_out(held, take) {
                return Ok(false);
            }
        }
        for _ in 0..AT_ONCE {
            let mut rest = &self.buffer[self.at..];
            let before = rest.len();
            let line = match &mut self.decoder {
                Decoder::Lines(lines) => lines.next(&mut rest, naming),
                Decoder::Frames(frames) => frames.next(&mut rest, naming),
                Decoder::Cells { .. } => return Ok(true),
            };
            self.at += before - rest.len();
            let said = match line.map_err(|why| why.0)? {
                None => {
                    if !ends {
                        return Ok(true);
                    }
                    let Decoder::Lines(lines) = &mut self.decoder else { return Ok(true) };
                    match lines.end(naming).map_err(|why| why.0)? {
                        None => return Ok(true),
                        Some(line) => Said::of(&line),
                    }
                }
                Some(line) => Said::of(&line),
            };
            match said {
                Said::Names { again } => {
                    let per_second = self.meaning().map_or(1.0, per_second);
                    match &mut self.timeline {
                        Some(timeline) => timeline.cut(),
                        None => self.timeline = Some(Timeline::new(per_second)),
                    }
                    if !take(Event::Names { again }) {
                        return Ok(false);
                    }
                }
                Said::Spoilt(kind) => {
                    if !take(Event::Spoilt(kind)) {
                        return Ok(false);
                    }
                }
                Said::Row { time, counter, lit } => {
                    // Names that were given beforehand come with the first row.
                    if self.timeline.is_none() {
                        self.timeline = Some(Timeline::new(self.meaning().map_or(1.0, per_second)));
                        if !take(Event::Names { again: false }) {
                            return Ok(false);
                        }
                    }
                    if !self.row(time, counter, lit, take) {
                        return Ok(false);
                    }
                    if self.held.is_some() {
                        return Ok(true);
                    }
                }
            }
        }
        Ok(true)
    }

    /// The same of rows that are no bytes.
    fn take_rows(&mut self, naming: &mut Naming<'_>, take: &mut dyn FnMut(Event<'_>) -> bool) -> Result<bool, String> {
        if let Some(held) = self.held {
            if self.clock.now_ns() < held.due_ns {
                return Ok(true);
            }
            if !self.hand_out(held, take) {
                return Ok(false);
            }
        }
        for _ in 0..AT_ONCE {
            let (Input::Rows(rows), Decoder::Cells { meaning, cells, values, texts }) =
                (&mut self.input, &mut self.decoder)
            else {
                return Ok(true);
            };
            let known = match meaning {
                Some(known) => known,
                None => {
                    let known = naming(rows.names())?;
                    rows.keep(&known);
                    *values = vec![f64::NAN; known.values];
                    *texts = vec![Vec::new(); known.texts];
                    self.timeline = Some(Timeline::new(per_second(&known)));
                    *meaning = Some(known);
                    if !take(Event::Names { again: false }) {
                        return Ok(false);
                    }
                    continue;
                }
            };
            if !rows.next(cells, texts)? {
                self.input = Input::Ended;
                self.ended = true;
                take(Event::End);
                return Ok(false);
            }
            let (mut time, mut counter, mut lit) = (f64::NAN, None, None);
            for (what, &cell) in known.uses.iter().zip(cells.iter()) {
                match *what {
                    Use::Time { .. } => time = cell,
                    Use::Counter => counter = (cell >= 0.0).then_some(cell as u64),
                    Use::Led => lit = (!cell.is_nan()).then_some(cell != 0.0),
                    Use::Value(at) => values[at] = cell,
                    Use::Counts(at) => values[at] = cell * self.options.volts_per_count.unwrap_or(1.0),
                    // Texts are written by whoever has the rows.
                    Use::Text(_) | Use::None => {}
                }
            }
            if !self.row(time, counter, lit, take) {
                return Ok(false);
            }
            if self.held.is_some() {
                return Ok(true);
            }
        }
        Ok(true)
    }

    /// Places a row in time; hands it out, or holds it until it is due.
    fn row(
        &mut self,
        time: f64,
        counter: Option<u64>,
        lit: Option<bool>,
        take: &mut dyn FnMut(Event<'_>) -> bool,
    ) -> bool {
        let now_ns = self.clock.now_ns();
        let timed =
            self.meaning().is_some_and(|meaning| meaning.uses.iter().any(|what| matches!(what, Use::Time { .. })));
        let Some(timeline) = &mut self.timeline else { return true };
        // A live source without a time gets that of arrival; a recording without one has none.
        let raw = if timed || self.rate.is_some() { time } else { 1e-9 * now_ns as f64 };
        let Some(placed) = timeline.place(raw, counter) else { return true };
        let due_ns = match self.rate {
            Some(Rate::Times(rate)) if placed.time_s.is_finite() => {
                if placed.begins || self.began.is_none() {
                    self.began = Some((now_ns, placed.time_s));
                }
                let (began_ns, from_s) = self.began.unwrap_or((now_ns, placed.time_s));
                began_ns + (1e9 * (placed.time_s - from_s).max(0.0) / rate) as u64
            }
            _ => now_ns,
        };
        let held = Held { placed, lit, due_ns };
        if due_ns > now_ns {
            self.held = Some(held);
            return true;
        }
        if timed && self.rate.is_none() {
            let host_s = 1e-9 * now_ns as f64;
            self.envelope.push(placed.time_s, host_s);
            if let Some([ahead_s, slope]) = self.fastest {
                let late_s = host_s - placed.time_s - ahead_s - slope * placed.time_s;
                self.arrival.record((1e9 * late_s.max(0.0)) as u64);
            }
        }
        self.hand_out(held, take)
    }

    fn hand_out(&mut self, Held { placed, lit, due_ns }: Held, take: &mut dyn FnMut(Event<'_>) -> bool) -> bool {
        self.held = None;
        let host_ns = self.clock.now_ns();
        if matches!(self.rate, Some(Rate::Times(_))) {
            self.lateness.record(host_ns.saturating_sub(due_ns));
        }
        self.rows += 1;
        self.window.1 += 1;
        if placed.time_s.is_finite() {
            if !self.first_s.is_finite() {
                self.first_s = placed.time_s;
            }
            self.last_s = placed.time_s;
        }
        self.last_ns = host_ns;
        if !matches!(self.state, StreamState::Ok | StreamState::Slow) {
            self.turn(StreamState::Ok, take);
        }
        let (values, texts): (&[f64], &[Vec<u8>]) = match &self.decoder {
            Decoder::Lines(lines) => (lines.values(), lines.texts()),
            Decoder::Frames(frames) => (frames.values(), &[]),
            Decoder::Cells { values, texts, .. } => (values, texts),
        };
        let Placed { time_s, lost, begins } = placed;
        take(Event::Row(Row { host_ns, time_s, lit, lost, begins, values, texts }))
    }

    fn meaning(&self) -> Option<&Meaning> {
        match &self.decoder {
            Decoder::Lines(lines) => lines.meaning(),
            Decoder::Frames(frames) => frames.meaning(),
            Decoder::Cells { meaning, .. } => meaning.as_ref(),
        }
    }

    /// Looks at the rate and at silence.
    fn watch(&mut self, take: &mut dyn FnMut(Event<'_>) -> bool) {
        if self.rate.is_some() || self.ended || matches!(self.input, Input::Lost(_)) || self.rows == 0 {
            return;
        }
        let now_ns = self.clock.now_ns();
        let stall_ns = self.period_s().map_or(0.0, |period_s| 1e9 * STALL_PERIODS * period_s) as u64;
        if now_ns.saturating_sub(self.last_ns) > stall_ns.max(STALL_NS) {
            if self.state != StreamState::Stalled && self.state != StreamState::Reconnecting {
                self.turn(StreamState::Stalled, take);
            }
            return;
        }
        let (since_ns, rows) = self.window;
        let passed_ns = now_ns.saturating_sub(since_ns);
        if passed_ns >= RATE_NS {
            let rate = rows as f64 * 1e9 / passed_ns as f64;
            let slow = rate < SLOW_SHARE * self.usual_rows;
            self.usual_rows = self.usual_rows.max(rate);
            self.window = (now_ns, 0);
            self.fastest = self.envelope.line();
            match self.state {
                StreamState::Ok if slow => self.turn(StreamState::Slow, take),
                StreamState::Slow if !slow => self.turn(StreamState::Ok, take),
                _ => {}
            }
        }
    }

    fn turn(&mut self, state: StreamState, take: &mut dyn FnMut(Event<'_>) -> bool) {
        self.state = state;
        self.changes += 1;
        if self.states.len() < MOST_STATES {
            self.states.push(Span { state, since_s: 1e-9 * self.clock.now_ns() as f64 });
        }
        self.window = (self.clock.now_ns(), 0);
        take(Event::State(state));
    }

    /// What can be said where nothing came.
    #[must_use]
    pub fn nothing(&self) -> String {
        match &self.decoder {
            Decoder::Lines(lines) if lines.meaning().is_none() => lines.nothing(),
            _ => "no row came".to_owned(),
        }
    }

    /// What came of it so far.
    #[must_use]
    pub fn certificate(&self) -> StreamCertificate {
        let spoilt = match &self.decoder {
            Decoder::Lines(lines) => lines.spoilt().clone(),
            Decoder::Frames(frames) => frames.spoilt().clone(),
            Decoder::Cells { .. } => crate::wire::Spoilt::default(),
        };
        let span_s = self.last_s - self.first_s;
        StreamCertificate {
            source: self.source.to_string(),
            rows: self.rows,
            rate_hz: (span_s > 0.0).then(|| (self.rows - 1) as f64 / span_s),
            device_time: self.meaning().is_some_and(|m| m.uses.iter().any(|what| matches!(what, Use::Time { .. }))),
            losses: self.timeline.as_ref().map(Timeline::counts).unwrap_or_default(),
            spoilt: spoilt.rows(),
            spoilt_kinds: spoilt.kinds(),
            clock: self.envelope.fit(),
            states: self.states.clone(),
            changes: self.changes,
        }
    }

    /// How much later than the fastest rows came, by the device's clock; none without one, and of recordings.
    #[must_use]
    pub fn arrival(&self) -> Option<Percentiles> {
        self.arrival.percentiles()
    }

    /// How late rows of a recording were handed out; none of live sources.
    #[must_use]
    pub fn lateness(&self) -> Option<Percentiles> {
        self.lateness.percentiles()
    }
}

/// What a line says, without its values.
enum Said {
    Names { again: bool },
    Spoilt(SpoiltKind),
    Row { time: f64, counter: Option<u64>, lit: Option<bool> },
}

impl Said {
    fn of(line: &Line<'_>) -> Self {
        match line {
            Line::Names { again } => Self::Names { again: *again },
            Line::Spoilt(kind) => Self::Spoilt(*kind),
            Line::Cells(cells) => Self::Row { time: cells.time, counter: cells.counter, lit: cells.lit },
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Read {
    Bytes,
    Nothing,
    End,
    Lost,
}

fn per_second(meaning: &Meaning) -> f64 {
    let found = meaning.uses.iter().find_map(|what| match what {
        Use::Time { per_second } => Some(*per_second),
        _ => None,
    });
    found.unwrap_or(1.0)
}

fn ready(fd: BorrowedFd<'_>) -> bool {
    let mut fds = [PollFd::from_borrowed_fd(fd, PollFlags::IN)];
    matches!(poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: 0 })), Ok(ready) if ready > 0)
}
