//! Streams opened, played, lost and found again.

mod firmware;
mod live;
#[cfg(feature = "lsl")]
mod lsl;
mod played;

use std::time::Duration;

use crate::source::{Address, Condition, Event, HostClock, SourceFault, Stream, StreamOptions, wait};
use crate::wire::{Meaning, Naming, Use};

/// Columns by their names: `time_*`, `n`, `led`; all others are values.
pub(super) fn naming() -> Naming {
    Box::new(|names| {
        let mut meaning = Meaning::default();
        for name in names {
            meaning.uses.push(match name.as_str() {
                "time_us" => Use::Time { per_second: 1e6 },
                "time_s" => Use::Time { per_second: 1.0 },
                "n" => Use::Counter,
                "led" => Use::Led,
                _ => {
                    meaning.values += 1;
                    Use::Value { at: meaning.values - 1, scaled: true }
                }
            });
        }
        Ok(meaning)
    })
}

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

pub(super) fn open(address: &str, clock: &HostClock) -> Result<Stream, SourceFault> {
    let address: Address = address.parse()?;
    Stream::open(&address, StreamOptions::default(), naming(), clock.now_ns())
}

/// Runs the loop until `enough`, for ten seconds at most.
pub(super) fn run(
    stream: &mut Stream,
    clock: &HostClock,
    log: &mut Log,
    mut enough: impl FnMut(&Log) -> bool,
) -> Result<(), SourceFault> {
    let until_ns = clock.now_ns() + Duration::from_secs(10).as_nanos() as u64;
    while !enough(log) && !stream.ended() {
        wait(&[&*stream], &[], Some(until_ns), clock).unwrap();
        let now_ns = clock.now_ns();
        assert!(now_ns < until_ns, "{log:?}");
        stream.poll(now_ns, &mut |event| log.take(event))?;
    }
    Ok(())
}
