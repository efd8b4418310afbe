//! Rows as their device numbers them to rows of one stream.
//!
//! In: samples and when they came. Out: seconds that never descend, lost rows, and where a recording begins. A row
//! that comes twice or late is dropped and counted: what was decided already is not decided again. Nothing is
//! interpolated.
//!
//! A clock or counter that leaps is believed where the next row agrees with it; otherwise the row is damaged, and is
//! dropped as doubtful. Who takes rows holds back the one that is doubtful until then.

use crate::time::arrivals::Arrivals;
use crate::time::counter::{Count, Counter, fits};
use crate::time::period::Period;
use crate::time::unwrap::{Expected, Reading, Unwrap};
use crate::wire::{Meaning, Sample, Use};

/// Rows that are at most so many periods behind are late, and as many in a row at most: otherwise the clock was set
/// back. As where logs are sorted.
const LATE_ROWS: u32 = 16;

/// A device that comes back with a clock that differs from the host's by more than this started again meanwhile,
/// seconds and as a part of the time that passed (*assumed*: quartz is a hundred times better).
const AWAY_S: f64 = 10.0;
const AWAY_PART: f64 = 0.01;

/// A device's clock that goes on by this and twice what the host saw pass, or more, was set, seconds (*assumed*: more
/// than a machine holds rows back).
const LEAP_S: f64 = 10.0;

/// Rows without a clock come in heaps; only over so many seconds their arrival says how many there should be.
const HEAP_S: f64 = 1.0;

/// What becomes of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// It is a row.
    Row {
        /// The stream's time, seconds; NaN where the row has none.
        time_s: f64,
        /// Rows lost just before it, by the counter.
        lost: u64,
        /// Whether a recording begins with it.
        begins: bool,
    },
    /// It came before.
    Duplicate,
    /// Rows after it came already.
    Late,
    /// Its time or count does not fit to the rows before it, and may be damaged: [`Sequence::settle`] says so by the
    /// next row.
    Doubtful,
}

/// Where rows come from, and what is therefore known of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Link {
    /// A recording, whose rows come when they are asked for.
    Recording,
    /// A program on this machine: rows come live, and whole.
    Pipe,
    /// A device: rows come live, and may be damaged.
    Device,
}

/// Rows counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct RowCounts {
    /// Rows that were handed out.
    pub rows: u64,
    /// Rows that never came or came late, by the counter.
    pub lost: u64,
    /// Rows that probably never came, by gaps in time of more than 1.5 periods and than the clock's resolution
    /// explains; of streams without a counter.
    pub lost_by_time: u64,
    /// Rows that have the time of the row before, and no tick of a coarse clock explains it.
    pub shared: u64,
    /// Rows that came twice and were dropped.
    pub duplicates: u64,
    /// Rows that came behind later ones and were dropped.
    pub disorder: u64,
    /// Rows that were dropped since their time or count fitted neither to the row before nor to the one behind.
    pub doubtful: u64,
    /// How often the device's clock or counter began again.
    pub set_back: u64,
    /// How often its clock reached its last value and went on.
    pub wraps: u64,
}

/// Puts samples in sequence.
#[derive(Debug, Clone)]
pub struct Sequence {
    /// None where rows have no time of their own.
    clock: Option<(Unwrap, f64)>,
    counter: Counter,
    counted: bool,
    link: Link,
    /// What is not believed of the latest sample.
    doubt: Option<Doubt>,
    /// The next sample is the doubtful one, and the one behind it agrees with it.
    trusted: bool,
    period: Period,
    /// Rows that are lost just before the latest stamp, as counted.
    gap_rows: u64,
    /// Of rows without a clock.
    arrivals: Arrivals,
    /// What is added to the device's seconds since its clock was set.
    shift_s: f64,
    last: Option<Last>,
    begins: bool,
    away: bool,
    late_run: u32,
    counts: RowCounts,
}

/// The latest row with a time.
#[derive(Debug, Clone, Copy)]
struct Last {
    time_s: f64,
    host_ns: u64,
}

impl Sequence {
    /// Rows whose columns have a meaning, and `counter_bits` where the counter's width is known.
    #[must_use]
    pub fn new(meaning: &Meaning, link: Link, counter_bits: Option<u32>) -> Self {
        let clock = meaning.uses.iter().find_map(|one| match one {
            Use::Time { per_second } => Some((Unwrap::new(*per_second), *per_second)),
            _ => None,
        });
        Self {
            clock,
            counter: Counter::of_bits(counter_bits),
            counted: meaning.uses.contains(&Use::Counter),
            link,
            doubt: None,
            trusted: false,
            period: Period::default(),
            gap_rows: 0,
            arrivals: Arrivals::default(),
            shift_s: 0.0,
            last: None,
            begins: true,
            away: false,
            late_run: 0,
            counts: RowCounts::default(),
        }
    }

    /// What comes next begins a recording: the device started again.
    pub fn begin(&mut self) {
        self.drop_doubtful();
        self.begins = true;
    }

    /// What comes next begins a recording: the source was away, and the device may have started again meanwhile.
    pub fn come_back(&mut self) {
        self.drop_doubtful();
        (self.begins, self.away) = (true, true);
    }

    /// The time from row to row, seconds; none before it is known.
    #[must_use]
    pub fn period_s(&self) -> Option<f64> {
        if self.clock.is_some() { self.period.mean_s } else { self.arrivals.period.mean_s }
    }

    /// The time from stamp to stamp, seconds: of rows that are stamped together several periods.
    #[must_use]
    pub fn step_s(&self) -> Option<f64> {
        if self.clock.is_some() { self.period.of_stamps_s() } else { self.arrivals.period.mean_s }
    }

    /// So many rows arrive next, at once; of use where they have no time of their own.
    pub fn announce(&mut self, rows: usize) {
        self.arrivals.announce(rows);
    }

    /// How long the bursts are in which rows without a time of their own arrive, seconds; none where they come one by
    /// one.
    #[must_use]
    pub fn burst_s(&self) -> Option<f64> {
        self.arrivals.burst_s()
    }

    /// Whether rows have a time of their own.
    #[must_use]
    pub fn has_clock(&self) -> bool {
        self.clock.is_some()
    }

    /// Rows counted so far.
    #[must_use]
    pub fn counts(&self) -> RowCounts {
        RowCounts { wraps: self.clock.as_ref().map_or(0, |(unwrap, _)| unwrap.wraps), ..self.counts }
    }

    /// The stream's time now: the latest row's, and of live streams what the host saw pass since; NaN before any.
    #[must_use]
    pub fn now_s(&self, now_ns: u64) -> f64 {
        let since_s = |last: &Last| if self.is_live() { seconds(now_ns.saturating_sub(last.host_ns)) } else { 0.0 };
        self.last.as_ref().map_or(f64::NAN, |last| last.time_s + since_s(last))
    }

    /// Rows that a program hands on came from a device.
    pub fn doubt(&mut self) {
        if self.link == Link::Pipe {
            self.link = Link::Device;
        }
    }

    /// Whether the sample behind a doubtful one agrees with it, so that the doubtful one is right and is to be taken
    /// again, first; otherwise it is dropped.
    pub fn settle(&mut self, next: &Sample) -> bool {
        let doubt = self.doubt.take();
        self.trusted = doubt.is_some_and(|doubt| doubt.is_confirmed_by(next));
        self.counts.doubtful += u64::from(doubt.is_some() && !self.trusted);
        self.trusted
    }

    /// Nothing comes that could agree with a doubtful sample.
    pub fn drop_doubtful(&mut self) {
        self.counts.doubtful += u64::from(self.doubt.take().is_some());
    }

    fn is_live(&self) -> bool {
        self.link != Link::Recording
    }

    /// Takes a sample that came at `host_ns`.
    pub fn take(&mut self, sample: &Sample, host_ns: u64) -> Verdict {
        let host_s = self.last.filter(|_| self.is_live()).map(|last| seconds(host_ns.saturating_sub(last.host_ns)));
        let expected = Expected { host_s, period_s: self.step_s() };
        let (clock, counter) = (self.clock.clone(), self.counter.clone());
        let device_s = match &mut self.clock {
            None => Device::Host(self.arrivals.time_s(seconds(host_ns))),
            Some(_) if sample.time.is_nan() => Device::Unknown,
            Some((unwrap, per_second)) => match unwrap.read(sample.time, expected) {
                Reading::On(time) => Device::At(time / *per_second),
                Reading::Back(by) => Device::Back { by_s: by / *per_second },
            },
        };
        let step_s = self.last.and_then(|last| match device_s {
            Device::Host(time_s) => Some(time_s - last.time_s),
            Device::At(time_s) => Some(time_s + self.shift_s - last.time_s),
            Device::Back { .. } | Device::Unknown => None,
        });
        let away = std::mem::take(&mut self.away);
        let believed = std::mem::take(&mut self.trusted) || self.begins;
        let elsewhere = |step_s: f64, host_s: f64| (step_s - host_s).abs() > AWAY_S + AWAY_PART * host_s;
        let restarted = match (device_s, step_s, host_s) {
            (Device::At(_), Some(step_s), Some(host_s)) => {
                let leaps = self.link == Link::Device && self.clock.is_some() && step_s > LEAP_S + 2.0 * host_s;
                leaps || away && elsewhere(step_s, host_s)
            }
            (Device::Back { .. }, ..) => self.begins,
            _ => false,
        };
        let fell_back = self.fell_back(device_s, sample.counter.is_some());
        let leaps = restarted || fell_back || matches!(device_s, Device::At(_)) && self.leaps(step_s, host_s);
        if leaps && !believed {
            let last = clock.as_ref().and_then(|(unwrap, _)| unwrap.last);
            self.doubt = last.map(|last| Doubt { of: Doubted::Time, is: sample.time, was: last });
            self.clock = clock;
            return Verdict::Doubtful;
        }
        if restarted || fell_back || self.late_run >= LATE_ROWS && matches!(device_s, Device::Back { .. }) {
            return self.set_back(sample, host_ns, host_s);
        }
        let lost = match self.count(sample, device_s, step_s.or(host_s), believed) {
            Ok(lost) => lost,
            Err(Count::SetBack) if matches!(device_s, Device::At(_)) => {
                if !believed {
                    let count = |count: Option<u64>| count.unwrap_or_default() as f64;
                    self.doubt =
                        Some(Doubt { of: Doubted::Count, is: count(sample.counter), was: count(counter.last) });
                    (self.clock, self.counter) = (clock, counter);
                    return Verdict::Doubtful;
                }
                self.begin_again(sample);
                return self.on(device_s, step_s, 0, host_ns);
            }
            Err(Count::SetBack) => return self.set_back(sample, host_ns, host_s),
            Err(Count::Again) => {
                self.counts.duplicates += 1;
                return Verdict::Duplicate;
            }
            Err(_) => {
                self.counts.disorder += 1;
                self.late_run += 1;
                return Verdict::Late;
            }
        };
        self.on(device_s, step_s, lost, host_ns)
    }

    /// Whether the clock goes on by more than lost rows, or what the host saw pass, explain.
    fn leaps(&self, step_s: Option<f64>, host_s: Option<f64>) -> bool {
        let rows_s = self.step_s().map_or(LEAP_S, |step_s| step_s * f64::from(LATE_ROWS));
        step_s.is_some_and(|step_s| step_s > rows_s + 2.0 * host_s.unwrap_or(0.0))
    }

    /// Whether the clock fell back by more than a row that is late explains.
    fn fell_back(&self, device_s: Device, counted: bool) -> bool {
        let Device::Back { by_s } = device_s else { return false };
        let most_s = match self.step_s() {
            Some(step_s) => step_s * f64::from(LATE_ROWS),
            // The counter knows.
            None if counted => f64::INFINITY,
            None => 0.0,
        };
        by_s > most_s
    }

    /// Rows lost before a sample, by its counter; without one, whether it is late by its time.
    /// A count that goes on by more than fits into the time began again, where it is not `believed`.
    fn count(&mut self, sample: &Sample, device_s: Device, step_s: Option<f64>, believed: bool) -> Result<u64, Count> {
        let Some(count) = sample.counter else {
            return if matches!(device_s, Device::Back { .. }) { Err(Count::Late) } else { Ok(0) };
        };
        let back = matches!(device_s, Device::Back { .. });
        let rows = step_s.filter(|_| !back).zip(self.step_s()).map(|(step_s, period_s)| step_s / period_s);
        // By arrival alone rows come in heaps.
        let rows = rows.filter(|_| self.clock.is_some() || step_s.is_some_and(|step_s| step_s > HEAP_S));
        let still = back || self.clock.is_some() && step_s.is_some_and(|step_s| step_s <= 0.0);
        match self.counter.read(count, if back { Some(0.0) } else { rows }, still) {
            // One of both times may be damaged.
            Count::Next { .. } if back && self.period_s().is_some() => Err(Count::Late),
            Count::Next { .. } if back => Err(Count::SetBack),
            Count::Again | Count::Late if self.begins => Err(Count::SetBack),
            Count::Next { lost } if !believed && self.clock.is_some() && !fits(lost + 1, rows) => Err(Count::SetBack),
            Count::Next { lost } => Ok(lost),
            other => Err(other),
        }
    }

    /// A recording begins, as the device's clock or counter began again.
    fn begin_again(&mut self, sample: &Sample) {
        self.counts.set_back += 1;
        self.begins = true;
        if let Some(count) = sample.counter {
            self.counter.set(count);
        }
    }

    /// The device's clock or counter began again: the stream's time goes on by what the host saw pass, or a period.
    fn set_back(&mut self, sample: &Sample, host_ns: u64, host_s: Option<f64>) -> Verdict {
        self.begin_again(sample);
        let passed_s = host_s.or(self.period_s()).unwrap_or(0.0);
        let (mut device_s, mut step_s) = (Device::Host(self.arrivals.latest_s()), None);
        if let Some((unwrap, per_second)) = &mut self.clock {
            device_s = Device::Unknown;
            if !sample.time.is_nan() {
                unwrap.set(sample.time);
                let at_s = sample.time / *per_second;
                self.shift_s = self.last.map_or(0.0, |last| last.time_s + passed_s - at_s);
                (device_s, step_s) = (Device::At(at_s), Some(passed_s));
            }
        }
        self.on(device_s, step_s, 0, host_ns)
    }

    fn on(&mut self, device_s: Device, step_s: Option<f64>, lost: u64, host_ns: u64) -> Verdict {
        let begins = std::mem::take(&mut self.begins);
        self.late_run = 0;
        self.counts.rows += 1;
        self.counts.lost = self.counts.lost.saturating_add(lost);
        let time_s = match device_s {
            Device::Host(time_s) => time_s,
            Device::At(time_s) => time_s + self.shift_s,
            Device::Back { .. } | Device::Unknown => return Verdict::Row { time_s: f64::NAN, lost, begins },
        };
        if let (Some(step_s), false) = (step_s, begins) {
            self.step(step_s, lost);
        }
        self.last = Some(Last { time_s, host_ns });
        Verdict::Row { time_s, lost, begins }
    }

    /// Learns the period, and counts what a gap hides.
    fn step(&mut self, step_s: f64, lost: u64) {
        let Some((unwrap, per_second)) = &self.clock else { return };
        let resolution_s = unwrap.resolution() / per_second;
        self.period.push(step_s / (lost + 1) as f64, resolution_s);
        if step_s > 0.0 {
            self.gap_rows = 0;
        } else {
            self.counts.shared += u64::from(self.period.is_packet());
        }
        if !self.counted {
            // A row that shares its stamp may explain the step to it.
            let gap_rows = self.period.lost();
            self.counts.lost_by_time = (self.counts.lost_by_time - self.gap_rows).saturating_add(gap_rows);
            self.gap_rows = gap_rows;
        }
    }
}

/// What is not believed of a sample.
#[derive(Debug, Clone, Copy)]
struct Doubt {
    of: Doubted,
    is: f64,
    /// That of the row before.
    was: f64,
}

#[derive(Debug, Clone, Copy)]
enum Doubted {
    Time,
    Count,
}

impl Doubt {
    /// Whether the next sample goes on from it, and not from the row before.
    fn is_confirmed_by(&self, next: &Sample) -> bool {
        let next = match self.of {
            Doubted::Time => Some(next.time),
            Doubted::Count => next.counter.map(|count| count as f64),
        };
        next.is_some_and(|next| next >= self.is && (self.is > self.was || next < self.was))
    }
}

/// When a sample was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Device {
    /// By its arrival, seconds.
    Host(f64),
    /// By the device's clock, seconds.
    At(f64),
    /// Before the latest.
    Back {
        by_s: f64,
    },
    Unknown,
}

fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}
