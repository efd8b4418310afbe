//! One source of a session: its stream, the clock that its times are brought to, and how it goes.
//!
//! Several sources are on one clock, *common* seconds: of recordings that of the recordings themselves, of live sources
//! this computer's since the session began, to which a device's time is brought by the line of its fastest rows. A
//! delay that every row of a link has can't be seen, so two devices are tied up to the difference of theirs.

use lunula_live::latency::Latency as Times;
use lunula_live::source::{Address, Condition, HostClock, Pace, Place, Rows, Stream, StreamOptions as WireOptions};
use lunula_live::time::ClockFit;
use lunula_live::wire::{Row, Spoil, SpoiltRows};

use super::columns::Recognizer;
use super::open::{named, open_stream};
use crate::live::error::LiveError;
use crate::live::options::StreamOptions;

/// A stream without a sample for so long after it was opened is an alarm.
const SILENCE_NS: u64 = 1_000_000_000;
/// More spoilt rows than this share in so long are an alarm.
const SPOILT_SHARE: f64 = 0.01;
const SPOILT_NS: u64 = 10_000_000_000;

/// A source.
pub(super) struct Feed<'a> {
    pub(super) source: &'a Address,
    pub(super) stream: Stream,
    pub(super) recognizer: Recognizer,
    pub(super) health: FeedHealth,
}

/// How a source goes.
#[derive(Default)]
pub(super) struct FeedHealth {
    /// The line of the fastest rows.
    clock_fit: Option<ClockFit>,
    is_live: bool,
    /// Whether its rows have no clock of their own: their times are this computer's, and need no line.
    pub(super) by_arrival: bool,
    /// The latest common time that was given to a row, seconds.
    latest_s: f64,
    pub(super) rows: u64,
    alarmed: bool,
    since_ns: u64,
    recent: u64,
    recent_spoilt: u64,
}

impl<'a> Feed<'a> {
    /// Opens a source that has these columns at least.
    pub(super) fn open(
        source: &'a Address,
        options: &StreamOptions,
        needs: &[String],
        clock: &HostClock,
    ) -> Result<Self, LiveError> {
        let recognizer = Recognizer::default();
        let naming = recognizer.naming(options, needs);
        let stream = open_stream(source, options, naming, clock.now_ns())?;
        Ok(Self::of(source, stream, recognizer))
    }

    /// Rows that a program makes, in place of the source, at the source's pace.
    pub(super) fn of_rows(source: &'a Address, rows: Box<dyn Rows>, options: &StreamOptions) -> Self {
        let recognizer = Recognizer::default();
        let naming = recognizer.naming(options, &[]);
        let pace = match source.place {
            Place::Phantom { pace, .. } => pace,
            _ => Pace::Max,
        };
        let wire = WireOptions::default();
        let stream = Stream::of_rows(source.to_string(), rows, (pace, false), None, &wire, naming);
        Self::of(source, stream, recognizer)
    }

    fn of(source: &'a Address, stream: Stream, recognizer: Recognizer) -> Self {
        let health = FeedHealth { is_live: stream.is_live(), latest_s: f64::NAN, ..FeedHealth::default() };
        Self { source, stream, recognizer, health }
    }

    /// The source in messages, behind a finger's name where there are several.
    pub(super) fn name(&self) -> String {
        named(self.source)
    }

    /// What is looked at now and then.
    pub(super) fn tick(&mut self, now_ns: u64, tell: &dyn Fn(&str)) {
        let health = &mut self.health;
        health.clock_fit = self.stream.clock();
        if !health.alarmed && health.rows == 0 && now_ns > SILENCE_NS && health.is_live {
            health.alarmed = true;
            tell(&format!("alarm: no sample within a second from {}", named(self.source)));
        }
        if now_ns - health.since_ns >= SPOILT_NS {
            let (spoilt, rows) = (health.recent_spoilt, health.recent + health.recent_spoilt);
            if spoilt as f64 > SPOILT_SHARE * rows as f64 {
                tell(&format!("alarm: {spoilt} of {rows} rows were spoilt in the last 10 s"));
            }
            (health.since_ns, health.recent, health.recent_spoilt) = (now_ns, 0, 0);
        }
    }

    /// What of its rows could not be used, in words.
    pub(super) fn spoilt(spoilt: &[SpoiltRows]) -> impl Iterator<Item = String> + '_ {
        spoilt.iter().filter(|rows| rows.kind != Spoil::BeforeNames).map(spoilt_words)
    }
}

impl FeedHealth {
    /// A row has come.
    pub(super) fn row(&mut self, row: &Row<'_>, arrival: &mut Times) {
        self.rows += 1;
        self.recent += 1;
        if let Some(fit) = &self.clock_fit {
            let late_s = 1e-9 * row.host_ns as f64 - fit.host_s(row.time_s);
            arrival.record_ns((1e9 * late_s.max(0.0)) as u64);
        }
    }

    /// A row was spoilt.
    pub(super) fn spoilt(&mut self) {
        self.recent_spoilt += 1;
    }

    /// A row's time on the clock that all sources are on, seconds; it never falls.
    pub(super) fn common_s(&mut self, row: &Row<'_>) -> f64 {
        if !self.is_live {
            return row.time_s;
        }
        if row.begins {
            // The device's clock may have begun again; a line of its own comes.
            self.clock_fit = None;
        }
        let arrival_s = 1e-9 * row.host_ns as f64;
        let fitted_s = match &self.clock_fit {
            _ if self.by_arrival => row.time_s,
            Some(fit) => fit.host_s(row.time_s),
            None => arrival_s,
        };
        // No row comes before it was made, and a line that is drawn again may lie lower.
        self.latest_s = self.latest_s.max(fitted_s.min(arrival_s));
        self.latest_s
    }
}

/// Whether a state means that the source is away.
pub(super) fn is_away(condition: Condition) -> bool {
    matches!(condition, Condition::Lost | Condition::Reconnecting)
}

pub(super) fn spoilt_words(rows: &SpoiltRows) -> String {
    let SpoiltRows { kind, count, line, text } = rows;
    let others = if *count > 1 { format!(", and {} more", count - 1) } else { String::new() };
    let is_date = |at: &[u8]| at[0].is_ascii_digit() && b":/-".contains(&at[1]) && at[2].is_ascii_digit();
    let dated = match kind {
        Spoil::Unreadable if text.as_bytes().windows(3).any(is_date) => {
            "; dates and times of day are read of files, by `predict`, `align` and others: a stream's time is a number"
        }
        _ => "",
    };
    format!("line {line} {} (`{text}`){others}{dated}", kind.words())
}
