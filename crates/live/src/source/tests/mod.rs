//! Streams opened, played, lost and found again.

mod firmware;
mod live;
#[cfg(feature = "lsl")]
mod lsl;
mod played;

use std::ops::ControlFlow;
use std::time::Duration;

use crate::source::{Address, Condition, Event, HostClock, SourceFault, Stream, StreamOptions, wait};
use crate::wire::testing::naming;

/// A row without what depends on the host's clock.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Seen {
    pub(super) time_s: f64,
    pub(super) lost: u64,
    pub(super) begins: bool,
    pub(super) values: Vec<f64>,
    pub(super) host_ns: u64,
}

/// What came from a stream.
#[derive(Debug, Default)]
pub(super) struct Log {
    pub(super) rows: Vec<Seen>,
    pub(super) columns: usize,
    pub(super) spoilt: usize,
    pub(super) states: Vec<Condition>,
    pub(super) ended: bool,
}

impl Log {
    pub(super) fn take(&mut self, event: Event<'_>) {
        match event {
            Event::Columns(_) => self.columns += 1,
            Event::Row(row) => self.rows.push(Seen {
                time_s: row.time_s,
                lost: row.lost,
                begins: row.begins,
                values: row.values.to_vec(),
                host_ns: row.host_ns,
            }),
            Event::Spoilt { .. } => self.spoilt += 1,
            Event::State(state) => self.states.push(state.condition),
            Event::End => self.ended = true,
        }
    }
}

/// A stream that is open, and what came from it.
pub(super) struct Reader {
    pub(super) stream: Stream,
    pub(super) clock: HostClock,
    pub(super) log: Log,
}

impl Reader {
    pub(super) fn of(stream: Stream, clock: HostClock) -> Self {
        Self { stream, clock, log: Log::default() }
    }

    pub(super) fn with(address: &str, options: StreamOptions) -> Result<Self, SourceFault> {
        let (address, clock): (Address, _) = (address.parse()?, HostClock::start());
        Ok(Self::of(Stream::open(&address, options, Box::new(naming), clock.now_ns())?, clock))
    }

    pub(super) fn open(address: &str) -> Self {
        Self::with(address, StreamOptions::default()).unwrap()
    }

    /// Runs the loop until `enough`, for ten seconds at most.
    pub(super) fn run(&mut self, mut enough: impl FnMut(&Log) -> bool) -> Result<(), SourceFault> {
        let until_ns = self.clock.now_ns() + Duration::from_secs(10).as_nanos() as u64;
        while !enough(&self.log) && !self.stream.ended() {
            wait(&[&self.stream], &[], Some(until_ns), &self.clock).unwrap();
            let now_ns = self.clock.now_ns();
            assert!(now_ns < until_ns, "{:?}", self.log);
            self.stream.poll(now_ns, &mut |event| {
                self.log.take(event);
                ControlFlow::Continue(())
            })?;
        }
        Ok(())
    }

    /// Goes on until so many rows have come.
    pub(super) fn rows(&mut self, count: usize) {
        self.run(|log| log.rows.len() >= count).unwrap();
        assert_eq!(self.log.rows.len(), count, "{:?}", self.log);
    }

    pub(super) fn until(&mut self, condition: Condition) {
        self.run(|log| log.states.last() == Some(&condition)).unwrap();
    }
}

/// What is said of an address that can't be opened.
pub(super) fn refused(address: &str) -> String {
    Reader::with(address, StreamOptions::default()).err().expect("a fault").to_string()
}
