//! A switch over recordings whose contacts are known: false switches an hour, misses, delays.
//!
//! Definitions, ours, as the thesis has none. A press belongs to the contact that began last before it, if that is not
//! over for more than [`LATE_S`], and if no other press belongs to it already; else it is **false**, *repeated* where
//! its contact has one already. A press that begins while contact is not known is neither true nor false. A contact
//! without a press is **missed**. **Delays** are from the contact's first row to the press and from the first row after
//! it to the release, so they hold half a row's period of bias at most. The rate is that of false presses in all the
//! time of which contact is known, touching or not; its interval is Garwood's, wider where recordings, or parts of
//! one, differ more than by chance ([`rate_of`]).

use serde::Serialize;
use statrs::function::beta::beta_reg;

use super::config::SwitchConfig;
use super::contact::{Contact, Contacts};
use super::event::{Reason, Turn};
use super::machine::{Reading, Switch};
use super::poisson::{PARTS, Rate, dispersion, heaping, rate_of};

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
    /// Their mean.
    pub mean: f64,
}

/// How a switch did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evaluation {
    /// Time of which contact is known.
    pub hours: f64,
    /// Time between rows of which it is not, seconds.
    pub unknown_s: f64,
    /// True presses: contacts whose beginning and end are known.
    pub presses: usize,
    /// Times that the switch pressed.
    pub decisions: usize,
    /// Presses that belong to no contact, or to one that has a press already.
    pub false_switches: u64,
    /// Of these, those whose contact has a press already.
    pub repeated: u64,
    /// Presses while contact is not known: neither true nor false.
    pub not_judged: usize,
    /// Contacts whose beginning or end is not known: no true presses.
    pub cut_off: usize,
    /// An hour; none without time.
    #[serde(flatten)]
    pub rate: Option<FalseRate>,
    /// How much more recordings, or parts of one, differ in it than chance alone makes them; 1: not more.
    pub dispersion: f64,
    /// Contacts without a press.
    pub missed: usize,
    /// From true contact to the press, seconds; none without any.
    pub delay_on_s: Option<Quartiles>,
    /// From the true end to the release, seconds; less than 0 where it let go too early.
    pub delay_off_s: Option<Quartiles>,
    /// Releases by the watchdog, by a clock set back or a lost source.
    pub let_go: u64,
}

impl Evaluation {
    /// Whether surely more than this share of presses is missed: so many, or more, come of it by chance in less than
    /// 2.5 % of cases.
    #[must_use]
    pub fn misses_more_than(&self, share: f64) -> bool {
        let (missed, presses) = (self.missed as f64, self.presses as f64);
        (1..=self.presses).contains(&self.missed) && beta_reg(missed, presses - missed + 1.0, share) < 0.025
    }
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
    pub(super) unknown_s: f64,
    /// False switches and hours of each recording.
    pub(super) recordings: Vec<(u64, f64)>,
    /// False switches in each part of each.
    pub(super) parts: Vec<[u64; PARTS]>,
    pub(super) presses: usize,
    pub(super) decisions: usize,
    pub(super) false_switches: u64,
    pub(super) repeated: u64,
    pub(super) not_judged: usize,
    pub(super) cut_off: usize,
    pub(super) missed: usize,
    pub(super) let_go: u64,
    pub(super) delays_on_s: Vec<f64>,
    pub(super) delays_off_s: Vec<f64>,
}

/// What became of a press, or of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Fate {
    /// The press belongs to a contact.
    True,
    /// It belongs to none.
    False,
    /// Its contact has a press already.
    Repeated,
    /// The contact has no press.
    Missed,
}

/// A press, its release and its contact, or a contact without a press.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Match {
    /// When the switch pressed, seconds; NaN where it did not.
    pub press_s: f64,
    /// When it released; NaN where it did not.
    pub release_s: f64,
    /// The contact.
    pub contact: Option<Contact>,
    /// Whether they agree.
    pub fate: Fate,
}

impl Match {
    /// Whether it counts as a false switch.
    #[must_use]
    pub fn is_false(&self) -> bool {
        matches!(self.fate, Fate::False | Fate::Repeated)
    }
}

/// A switch's presses over a recording, where contact is known, and the contacts that it missed, in the order of time.
#[must_use]
pub fn matches(config: &SwitchConfig, trace: &Trace) -> Vec<Match> {
    let mut let_go = 0;
    let presses = presses(config, trace, &mut let_go);
    compare(&presses, &trace.contacts)
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
        let contacts = &trace.contacts;
        let mut tally = Self { seconds: contacts.seconds, unknown_s: contacts.unknown_s(), ..Self::default() };
        let presses = presses(config, trace, &mut tally.let_go);
        tally.presses = contacts.contacts.iter().filter(|one| one.start_known && one.end_known).count();
        tally.cut_off = contacts.contacts.len() - tally.presses;
        tally.decisions = presses.len();
        tally.not_judged = presses.iter().filter(|press| !contacts.knows(press[0])).count();
        let found = compare(&presses, contacts);
        tally.parts = vec![false_by_parts(contacts, &found)];
        for Match { press_s, release_s, contact, fate } in found {
            match fate {
                Fate::True => {
                    let start_s = contact.filter(|one| one.start_known).map(|one| one.start_s);
                    let end_s = contact.filter(|one| one.end_known && release_s.is_finite()).map(|one| one.end_s);
                    tally.delays_on_s.extend(start_s.map(|start_s| press_s - start_s));
                    tally.delays_off_s.extend(end_s.map(|end_s| release_s - end_s));
                }
                Fate::False => tally.false_switches += 1,
                Fate::Repeated => {
                    tally.false_switches += 1;
                    tally.repeated += 1;
                }
                Fate::Missed => tally.missed += 1,
            }
        }
        tally.recordings = vec![(tally.false_switches, tally.hours())];
        tally
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.seconds += other.seconds;
        self.unknown_s += other.unknown_s;
        self.recordings.extend(&other.recordings);
        self.parts.extend(&other.parts);
        self.presses += other.presses;
        self.decisions += other.decisions;
        self.false_switches += other.false_switches;
        self.repeated += other.repeated;
        self.not_judged += other.not_judged;
        self.cut_off += other.cut_off;
        self.missed += other.missed;
        self.let_go += other.let_go;
        self.delays_on_s.extend(&other.delays_on_s);
        self.delays_off_s.extend(&other.delays_off_s);
    }

    pub(super) fn hours(&self) -> f64 {
        self.seconds / 3600.0
    }

    /// How much more recordings, or parts of one, differ than by chance: of all false switches each recording's share
    /// is as heaped as it is.
    fn dispersion(&self) -> f64 {
        let heaped = |parts: &[u64; PARTS]| parts.iter().sum::<u64>() as f64 * heaping(parts, self.parts.len());
        let heaped = self.parts.iter().map(heaped).sum::<f64>() / (self.false_switches as f64).max(1.0);
        dispersion(&self.recordings).max(heaped)
    }

    pub(super) fn evaluation(&self) -> Evaluation {
        let dispersion = self.dispersion();
        Evaluation {
            hours: self.hours(),
            unknown_s: self.unknown_s,
            presses: self.presses,
            decisions: self.decisions,
            false_switches: self.false_switches,
            repeated: self.repeated,
            not_judged: self.not_judged,
            cut_off: self.cut_off,
            rate: rate_of(&self.recordings, dispersion).map(FalseRate::from),
            dispersion,
            missed: self.missed,
            delay_on_s: Quartiles::of(&self.delays_on_s),
            delay_off_s: Quartiles::of(&self.delays_off_s),
            let_go: self.let_go,
        }
    }
}

/// When the switch presses and releases, seconds (NaN where it does not release); counts the releases by faults.
fn presses(config: &SwitchConfig, trace: &Trace, let_go: &mut u64) -> Vec<[f64; 2]> {
    let mut presses: Vec<[f64; 2]> = Vec::new();
    let mut switch = Switch::new(config.clone());
    let mut begins = trace.begins.iter().peekable();
    for (row, (&t_s, &value)) in trace.time_s.iter().zip(&trace.value).enumerate() {
        let lost = begins.next_if(|&&begin| begin == row).and_then(|_| switch.lose(t_s, Reason::Lost));
        let event = lost.or(switch.sample(t_s, Reading { value, outside: trace.outside[row] }));
        let Some(event) = event else { continue };
        match event.turn {
            Turn::Press => presses.push([event.t_s, f64::NAN]),
            Turn::Release => {
                *let_go += u64::from(!matches!(event.reason, Reason::Value | Reason::Outside));
                if let Some(press) = presses.last_mut() {
                    press[1] = event.t_s;
                }
            }
        }
    }
    presses
}

/// How many of a recording's presses are false in each part of its time.
#[must_use]
pub fn false_by_parts(contacts: &Contacts, found: &[Match]) -> [u64; PARTS] {
    contacts.by_parts(found.iter().filter(|one| one.is_false()).map(|one| one.press_s))
}

/// Gives each press its contact, where contact is known.
fn compare(presses: &[[f64; 2]], known: &Contacts) -> Vec<Match> {
    let contacts = &known.contacts;
    let mut taken = vec![false; contacts.len()];
    let mut found: Vec<Match> = Vec::with_capacity(presses.len());
    // In the order of time: the contact that began last before the press.
    let mut after = 0;
    for &[press_s, release_s] in presses {
        // A clock that was set back begins again.
        if after > 0 && contacts[after - 1].start_s > press_s {
            after = 0;
        }
        while contacts.get(after).is_some_and(|one| one.start_s <= press_s) {
            after += 1;
        }
        let own = after.checked_sub(1).filter(|&own| press_s <= contacts[own].end_s + LATE_S);
        let again = own.is_some_and(|own| std::mem::replace(&mut taken[own], true));
        if !known.knows(press_s) {
            continue;
        }
        let fate = match own {
            None => Fate::False,
            Some(_) if again => Fate::Repeated,
            Some(_) => Fate::True,
        };
        found.push(Match { press_s, release_s, contact: own.map(|own| contacts[own]), fate });
    }
    let missed = contacts.iter().zip(taken).filter(|(one, taken)| one.start_known && one.end_known && !taken);
    let missed = missed.map(|(one, _)| Match {
        press_s: f64::NAN,
        release_s: f64::NAN,
        contact: Some(*one),
        fate: Fate::Missed,
    });
    found.extend(missed);
    found
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
        let mean = sorted.iter().sum::<f64>() / sorted.len() as f64;
        Some(Self { count: sorted.len(), low: at(0.25), median: at(0.5), high: at(0.75), mean })
    }
}
