//! A stream of rows, read without waiting.
//!
//! In: an address, or rows that a program makes, and what the columns mean. Out: [`Event`]s, from [`Stream::poll`]. No
//! call waits, and none allocates for a row.

mod held;
mod live;
mod played;

use std::ops::ControlFlow;
use std::os::fd::BorrowedFd;

use crate::latency::Latency;
use crate::source::address::{Address, Form, Pace, Place};
use crate::source::certificate::{Gaps, StreamCertificate, StreamTimes};
use crate::source::decoder::{Decoder, Rows, Table};
use crate::source::fault::SourceFault;
use crate::source::health::{Condition, Health, State};
use crate::source::play::{Bytes, Play};
use crate::time::{ClockFit, Envelope, Link, RowCounts, Sequence};
use crate::wire::{Frames, LineOptions, Lines, Meaning, Naming, Row, Sample, Spoil, SpoiltRows, Step, WireFault};
use held::Held;
use live::Live;

const FRAME_COUNTER_BITS: u32 = 16;

/// What the caller knows of a stream beforehand.
#[derive(Debug, Clone, Default)]
pub struct StreamOptions {
    /// The columns' names, where the stream does not say them.
    pub columns: Option<Vec<String>>,
    /// When the host's clock was zero, seconds since 1970, for the certificate.
    pub host_start_unix_s: Option<f64>,
}

/// What happens on a stream.
#[derive(Debug)]
pub enum Event<'a> {
    /// The columns are known now, by these names; once, before the first row.
    Columns(&'a [String]),
    /// A row.
    Row(&'a Row<'a>),
    /// A row that is spoilt.
    Spoilt {
        /// What is wrong with it.
        kind: Spoil,
        /// The row, where it is the first of its kind.
        first: Option<&'a SpoiltRows>,
    },
    /// The stream is in another condition.
    State(State),
    /// Nothing more comes.
    End,
}

/// What is called with what happens, until it wants nothing more.
struct Sink<'s> {
    on: &'s mut dyn FnMut(Event<'_>) -> ControlFlow<()>,
    is_over: bool,
}

impl Sink<'_> {
    fn send(&mut self, event: Event<'_>) {
        self.is_over |= (self.on)(event).is_break();
    }
}

/// A stream of rows.
pub struct Stream {
    name: String,
    form: Option<Form>,
    host_start_unix_s: Option<f64>,
    feed: Feed,
    decoder: Decoder,
    /// Of rows, once the columns are known.
    sequence: Option<Sequence>,
    held: Held,
    envelope: Envelope,
    health: Health,
    gaps: Gaps,
    ended: bool,
}

enum Feed {
    Live(Live),
    Play(Play),
}

impl Stream {
    /// Opens a source at `now_ns`; its columns mean what `naming` says. A phantom, a Parquet file and an XDF file are
    /// given as rows ([`of_rows`](Self::of_rows)).
    ///
    /// # Errors
    /// The source cannot be opened: what is wrong, and what to do.
    pub fn open(address: &Address, options: StreamOptions, naming: Naming, now_ns: u64) -> Result<Self, SourceFault> {
        let name = address.to_string();
        let feed = match &address.place {
            Place::File { path, pace, looped } => {
                let bytes = Bytes::open(path, address.form == Form::Lines)?;
                Feed::Play(Play::new(Some(bytes), *pace, *looped))
            }
            place => {
                let live = Live::open(place, now_ns);
                Feed::Live(live.map_err(|what| SourceFault::Open { source_name: name.clone(), what })?)
            }
        };
        let mut decoder = match address.form {
            Form::Frames => Decoder::Frames(Box::new(Frames::new(naming, address.volts_per_count))),
            Form::Lines => {
                let names = if let Feed::Live(live) = &feed { live.names.clone() } else { None };
                let options = LineOptions {
                    columns: options.columns.or(names),
                    is_file: matches!(feed, Feed::Play(_)),
                    volts_per_count: address.volts_per_count,
                };
                Decoder::Lines(Box::new(Lines::new(naming, options)))
            }
        };
        if matches!(&feed, Feed::Live(live) if live.within) {
            decoder.cut(true);
        }
        Ok(Self::of(name, Some(address.form), options.host_start_unix_s, feed, decoder, now_ns))
    }

    /// Rows that a program makes, under a name for messages, played at a pace.
    #[must_use]
    pub fn of_rows(
        name: String,
        rows: Box<dyn Rows>,
        (pace, looped): (Pace, bool),
        volts_per_count: Option<f64>,
        options: &StreamOptions,
        naming: Naming,
    ) -> Self {
        let decoder = Decoder::Table(Box::new(Table::new(rows, naming, volts_per_count)));
        Self::of(name, None, options.host_start_unix_s, Feed::Play(Play::new(None, pace, looped)), decoder, 0)
    }

    fn of(
        name: String,
        form: Option<Form>,
        host_start_unix_s: Option<f64>,
        feed: Feed,
        decoder: Decoder,
        now_ns: u64,
    ) -> Self {
        let open = match &feed {
            Feed::Live(live) => live.is_open(),
            Feed::Play(_) => true,
        };
        let condition = if open { Condition::Ok } else { Condition::Reconnecting };
        Self {
            name,
            form,
            host_start_unix_s,
            feed,
            decoder,
            sequence: None,
            held: Held::default(),
            envelope: Envelope::default(),
            health: Health::new(condition, now_ns),
            gaps: Gaps::default(),
            ended: false,
        }
    }

    /// Reads what is there, up to a piece of it, and hands out what happened. `now_ns` is the host's clock. Where `on`
    /// breaks off, what lies behind is not looked at, and the stream has ended.
    ///
    /// # Errors
    /// The stream cannot go on; it has ended then.
    pub fn poll(&mut self, now_ns: u64, on: &mut dyn FnMut(Event<'_>) -> ControlFlow<()>) -> Result<(), SourceFault> {
        if self.ended {
            return Ok(());
        }
        let mut sink = Sink { on, is_over: false };
        let polled = match self.feed {
            Feed::Live(_) => self.poll_live(now_ns, &mut sink),
            Feed::Play(_) => self.poll_played(now_ns, &mut sink),
        };
        self.ended |= polled.is_err() || sink.is_over;
        polled
    }

    /// What is readable when there is something to do; none where only time says so.
    #[must_use]
    pub fn fd(&self) -> Option<BorrowedFd<'_>> {
        match &self.feed {
            Feed::Live(live) if !self.ended => live.fd(),
            _ => None,
        }
    }

    /// When [`poll`](Self::poll) has something to do without anything to read; none where it never has.
    #[must_use]
    pub fn due_ns(&self) -> Option<u64> {
        if self.ended {
            return None;
        }
        match &self.feed {
            Feed::Live(_) => self.health.due_ns(self.step_s(), self.garbled_for_ns()),
            Feed::Play(play) => match play.waiting {
                Some(row) if play.holds(&row) => None,
                row => Some(row.map_or(0, |row| row.due_ns)),
            },
        }
    }

    /// Of a recording, holds back rows after `until_s` of its time, so that several are played in the order of their
    /// rows; a live stream knows no such thing.
    pub fn play_until(&mut self, until_s: f64) {
        if let Feed::Play(play) = &mut self.feed {
            play.until_s = until_s;
        }
    }

    /// Of a recording that is played at a rate: what it holds of `first_s` is due at `now_ns`, so that several keep the
    /// distance of their rows.
    pub fn play_from(&mut self, first_s: f64, now_ns: u64) {
        if let Feed::Play(play) = &mut self.feed {
            play.from(first_s, now_ns);
        }
    }

    /// The time of the row that a recording hands out next, seconds; none before it is read, or where rows are live.
    #[must_use]
    pub fn next_s(&self) -> Option<f64> {
        match &self.feed {
            Feed::Play(play) => play.waiting.map(|row| row.time_s),
            Feed::Live(_) => None,
        }
    }

    /// Whether nothing more comes.
    #[must_use]
    pub fn ended(&self) -> bool {
        self.ended
    }

    /// The stream's time, seconds: of a live one that of its latest row and what the host saw pass since; of a
    /// recording that of its latest row, so that it says the same at every pace. NaN before the first row.
    #[must_use]
    pub fn stream_now_s(&self, now_ns: u64) -> f64 {
        match &self.feed {
            Feed::Play(play) => play.played_s,
            Feed::Live(_) => self.sequence.as_ref().map_or(f64::NAN, |sequence| sequence.now_s(now_ns)),
        }
    }

    /// The source, for messages.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The columns' names; empty until they are known.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.decoder.decoded().names
    }

    /// What the columns mean; nothing until it is known.
    #[must_use]
    pub fn meaning(&self) -> &Meaning {
        &self.decoder.decoded().meaning
    }

    /// How the stream is.
    #[must_use]
    pub fn state(&self) -> State {
        self.health.state
    }

    /// Whether rows come live, so that their arrival says something.
    #[must_use]
    pub fn is_live(&self) -> bool {
        matches!(self.feed, Feed::Live(_))
    }

    /// The time from row to row, seconds; none before it is known.
    #[must_use]
    pub fn period_s(&self) -> Option<f64> {
        self.sequence.as_ref().and_then(Sequence::period_s)
    }

    /// The time from stamp to stamp, seconds: of rows that are stamped together several periods.
    fn step_s(&self) -> Option<f64> {
        self.sequence.as_ref().and_then(Sequence::step_s)
    }

    /// The line between the device's clock and the host's; none where it has none, or rows do not come live.
    #[must_use]
    pub fn clock(&self) -> Option<ClockFit> {
        self.envelope.fit()
    }

    /// How late rows were played; none of a live stream.
    #[must_use]
    pub fn lateness(&self) -> Option<&Latency> {
        match &self.feed {
            Feed::Play(play) => Some(&play.lateness),
            Feed::Live(_) => None,
        }
    }

    /// What is known of the stream so far.
    #[must_use]
    pub fn certificate(&self) -> StreamCertificate {
        let (states, states_left_out) = self.health.history();
        let sequence = self.sequence.as_ref();
        StreamCertificate {
            source: self.name.clone(),
            form: self.form,
            columns: self.decoder.decoded().names.clone(),
            times: sequence.map(|sequence| match sequence.has_clock() {
                true => StreamTimes::Device,
                false => StreamTimes::Arrival,
            }),
            burst_s: sequence.and_then(Sequence::burst_s),
            host_start_unix_s: self.host_start_unix_s,
            counts: self.counts(),
            rate_hz: self.period_s().map(f64::recip),
            spoilt: self.decoder.decoded().tally.kinds.clone(),
            gaps: self.gaps.first.clone(),
            gaps_count: self.gaps.count,
            longest_gap_s: self.gaps.longest_s,
            states: states.to_vec(),
            states_left_out,
            clock: self.clock(),
            notes: self.notes(),
        }
    }

    /// Rows counted so far; of a recording without the one that it holds next.
    fn counts(&self) -> RowCounts {
        match &self.feed {
            Feed::Play(Play { waiting: Some(row), .. }) => row.before,
            _ => self.sequence.as_ref().map(Sequence::counts).unwrap_or_default(),
        }
    }

    /// What is unusual about the stream, and what to do about it.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let Feed::Live(live) = &self.feed else { return Vec::new() };
        let counts = self.counts();
        let load = live.overload(counts.rows, counts.lost + counts.lost_by_time, self.period_s());
        live.notes.iter().cloned().chain(load).collect()
    }

    /// The columns are known.
    fn columns(&mut self, again: bool, on: &mut Sink<'_>) -> Result<(), SourceFault> {
        if again && let Some(sequence) = &mut self.sequence {
            sequence.begin();
            return Ok(());
        }
        let link = match &self.feed {
            Feed::Play(_) => Link::Recording,
            Feed::Live(live) => live.link(),
        };
        let bits = (self.form == Some(Form::Frames)).then_some(FRAME_COUNTER_BITS);
        let sequence = Sequence::new(&self.decoder.decoded().meaning, link, bits);
        if link == Link::Recording && !sequence.has_clock() {
            let what = "has no column of time, by which it is played; name one time_s".to_owned();
            return Err(SourceFault::Open { source_name: self.name.clone(), what });
        }
        self.sequence = Some(sequence);
        on.send(Event::Columns(&self.decoder.decoded().names));
        Ok(())
    }

    fn spoilt(&self, kind: Spoil, on: &mut Sink<'_>) {
        let first = self.decoder.decoded().tally.kinds.iter().find(|rows| rows.kind == kind && rows.count == 1);
        on.send(Event::Spoilt { kind, first });
    }

    fn wire(&self, fault: WireFault) -> SourceFault {
        SourceFault::Wire { source_name: self.name.clone(), fault }
    }

    /// Judges the row that is held back, if there is one, by the one that came behind it. Where it is right it takes
    /// the decoder's place, and is given with when it came; where a recording began meanwhile it isn't.
    fn judge(&mut self, next: &Sample) -> Option<(Sample, u64)> {
        let first = self.held.doubtful()?;
        if !self.sequence.as_mut()?.settle(next) {
            return None;
        }
        self.held.put_before(*next, &mut self.decoder);
        Some(first)
    }

    fn end(&mut self, on: &mut Sink<'_>) {
        if let Some(sequence) = &mut self.sequence {
            sequence.drop_doubtful();
        }
        self.ended = true;
        on.send(Event::End);
    }
}
