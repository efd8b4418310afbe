//! A switch over recordings whose contacts are known: false switches an hour, misses, delays.
//!
//! Definitions, ours, as the thesis has none. A press belongs to the contact that began last before it, if that is not
//! over for more than [`LATE_S`], and if no other press belongs to it already; else it is **false**, *repeated* where
//! its contact has one already. A contact without a press is **missed**. **Delays** are from the contact's first row to
//! the press and from the first row after it to the release, so they hold half a row's period of bias at most. The rate
//! is that of false presses in all the time of which contact is known, touching or not.

use serde::Serialize;

use super::config::SwitchConfig;
use super::contact::{Contact, Contacts};
use super::event::{Reason, Turn};
use super::machine::{Reading, Switch};
use super::poisson::{Rate, rate_per_hour};

/// How long after a contact's end a press may still be its own, seconds: assumed; blood follows within 0.4 s (4.3).
const LATE_S: f64 = 0.5;

/// What a model said of a recording, and what was true.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trace {
    /// The stream's time of each row, seconds.
    pub time_s: Vec<f64>,
    /// What the switch compares, N; NaN where not known.
    pub value: Vec<f64>,
    /// Whether the voltages lie beyond the trained ones.
    pub outside: Vec<bool>,
    /// Rows at which a recording begins.
    pub begins: Vec<usize>,
    /// What was true.
    pub contacts: Contacts,
}

/// The middle and the quarters of some numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quartiles {
    /// How many.
    pub count: usize,
    /// A quarter is at this or below.
    pub low: f64,
    /// Half is.
    pub median: f64,
    /// Three quarters are.
    pub high: f64,
}

/// How a switch did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evaluation {
    /// Time of which contact is known.
    pub hours: f64,
    /// True presses: contacts whose beginning and end are known.
    pub presses: usize,
    /// Times that the switch pressed.
    pub decisions: usize,
    /// Presses that belong to no contact, or to one that has a press already.
    pub false_switches: u64,
    /// Of these, those whose contact has a press already.
    pub repeated: u64,
    /// An hour; none without time.
    #[serde(flatten)]
    pub rate: Option<FalseRate>,
    /// Contacts without a press.
    pub missed: usize,
    /// From true contact to the press, seconds; none without any.
    pub delay_on_s: Option<Quartiles>,
    /// From the true end to the release, seconds; less than 0 where it let go too early.
    pub delay_off_s: Option<Quartiles>,
    /// Releases by the watchdog, by a clock set back or a lost source.
    pub let_go: u64,
}

/// False switches an hour.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FalseRate {
    /// As counted.
    pub false_per_hour: f64,
    /// The least that agrees with the count (95 %).
    pub false_per_hour_low: f64,
    /// The most that agrees with it.
    pub false_per_hour_high: f64,
}

impl From<Rate> for FalseRate {
    fn from(rate: Rate) -> Self {
        Self { false_per_hour: rate.per_hour, false_per_hour_low: rate.low, false_per_hour_high: rate.high }
    }
}

/// What is counted over one trace or several.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Tally {
    pub(super) seconds: f64,
    pub(super) presses: usize,
    pub(super) decisions: usize,
    pub(super) false_switches: u64,
    pub(super) repeated: u64,
    pub(super) missed: usize,
    pub(super) let_go: u64,
    pub(super) delays_on_s: Vec<f64>,
    pub(super) delays_off_s: Vec<f64>,
}

/// A press, and its release where that came.
#[derive(Debug, Clone, Copy)]
struct Press {
    on_s: f64,
    off_s: Option<f64>,
}

impl Evaluation {
    /// A switch over recordings.
    #[must_use]
    pub fn of(config: &SwitchConfig, traces: &[Trace]) -> Self {
        let mut all = Tally::default();
        traces.iter().for_each(|trace| all.add(&Tally::of(config, trace)));
        all.evaluation()
    }
}

impl Tally {
    pub(super) fn of(config: &SwitchConfig, trace: &Trace) -> Self {
        let mut tally = Self { seconds: trace.contacts.seconds(), ..Self::default() };
        let mut presses: Vec<Press> = Vec::new();
        let mut switch = Switch::new(config.clone());
        let mut begins = trace.begins.iter().peekable();
        for (row, (&t_s, &value)) in trace.time_s.iter().zip(&trace.value).enumerate() {
            let lost = begins.next_if(|&&begin| begin == row).and_then(|_| switch.lose(t_s, Reason::Lost));
            let event = lost.or(switch.sample(t_s, Reading { value, outside: trace.outside[row] }));
            let Some(event) = event else { continue };
            match event.turn {
                Turn::Press => presses.push(Press { on_s: event.t_s, off_s: None }),
                Turn::Release => {
                    tally.let_go += u64::from(!matches!(event.reason, Reason::Value | Reason::Outside));
                    if let Some(press) = presses.last_mut() {
                        press.off_s = Some(event.t_s);
                    }
                }
            }
        }
        tally.compare(&presses, trace.contacts.contacts());
        tally
    }

    fn compare(&mut self, presses: &[Press], contacts: &[Contact]) {
        self.decisions = presses.len();
        let mut taken = vec![false; contacts.len()];
        for press in presses {
            // Contacts of recordings whose clocks overlap are looked through from the last.
            let own = contacts.iter().rposition(|one| (one.start_s..=one.end_s + LATE_S).contains(&press.on_s));
            let Some(own) = own else {
                self.false_switches += 1;
                continue;
            };
            if std::mem::replace(&mut taken[own], true) {
                self.false_switches += 1;
                self.repeated += 1;
                continue;
            }
            let contact = contacts[own];
            if contact.start_known {
                self.delays_on_s.push(press.on_s - contact.start_s);
            }
            if let Some(off_s) = press.off_s.filter(|_| contact.end_known) {
                self.delays_off_s.push(off_s - contact.end_s);
            }
        }
        for (contact, taken) in contacts.iter().zip(taken) {
            let whole = contact.start_known && contact.end_known;
            self.presses += usize::from(whole);
            self.missed += usize::from(whole && !taken);
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.seconds += other.seconds;
        self.presses += other.presses;
        self.decisions += other.decisions;
        self.false_switches += other.false_switches;
        self.repeated += other.repeated;
        self.missed += other.missed;
        self.let_go += other.let_go;
        self.delays_on_s.extend(&other.delays_on_s);
        self.delays_off_s.extend(&other.delays_off_s);
    }

    pub(super) fn hours(&self) -> f64 {
        self.seconds / 3600.0
    }

    pub(super) fn evaluation(&self) -> Evaluation {
        Evaluation {
            hours: self.hours(),
            presses: self.presses,
            decisions: self.decisions,
            false_switches: self.false_switches,
            repeated: self.repeated,
            rate: rate_per_hour(self.false_switches, self.hours()).map(FalseRate::from),
            missed: self.missed,
            delay_on_s: Quartiles::of(&self.delays_on_s),
            delay_off_s: Quartiles::of(&self.delays_off_s),
            let_go: self.let_go,
        }
    }
}

impl Quartiles {
    /// Of numbers, those between two neighbours by a straight line; none of none.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        let at = |share: f64| {
            let place = share * last as f64;
            let (below, part) = (place.floor() as usize, place.fract());
            sorted[below] + part * (sorted[(below + 1).min(last)] - sorted[below])
        };
        Some(Self { count: sorted.len(), low: at(0.25), median: at(0.5), high: at(0.75) })
    }
}
