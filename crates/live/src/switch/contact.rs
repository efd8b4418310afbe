//! When the finger truly touched: what a switch's presses are held against.
//!
//! In: rows with a time and whether the finger touches, of a contact switch or of a measured force below a threshold.
//! Out: the contacts, with the time that was looked at. Two contacts closer than [`MERGED_S`] are one: a force that
//! hovers at its threshold is no second touch. Rows further apart than [`LONGEST_GAP_S`] have a gap between them, in
//! which nothing is known: a contact that reaches one has no known end there. Between two rows contact is known where
//! both say it, or where less than [`MERGED_S`] is missing between them and they say the same, the first one known.

use serde::Serialize;

use super::poisson::PARTS;

/// Contacts closer than this are one, seconds: assumed, less than a finger takes to let go and touch again.
const MERGED_S: f64 = 0.1;
/// Rows further apart have a gap between them, seconds: assumed.
pub const LONGEST_GAP_S: f64 = 0.5;

/// A touch of the finger.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Contact {
    /// Its first row's time.
    pub start_s: f64,
    /// The time of the first row after it.
    pub end_s: f64,
    /// Whether a row without contact is known before it.
    pub start_known: bool,
    /// Whether one is known after it.
    pub end_known: bool,
}

/// The contacts of a recording.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Contacts {
    /// The contacts, in the order of time within each recording.
    pub contacts: Vec<Contact>,
    /// From when to when contact is known, seconds, ascending.
    known: Vec<[f64; 2]>,
    /// The time between rows of which contact is known, seconds.
    pub seconds: f64,
    /// The time of which contact isn't known, but for that since the last row that says it, seconds; and that.
    unknown_s: f64,
    open_s: f64,
    last: Option<(f64, Option<bool>)>,
    /// The last row that says it, where none but rows that don't has come since.
    said: Option<(f64, bool)>,
}

impl Contacts {
    /// The next row; `touches` is none where it is not known, `begins` where a recording begins.
    pub fn push(&mut self, time_s: f64, touches: Option<bool>, begins: bool) {
        if !time_s.is_finite() {
            return;
        }
        let row_before = self.last.filter(|(last_s, _)| !begins && (0.0..=LONGEST_GAP_S).contains(&(time_s - last_s)));
        let says_the_same = |(said_s, said): &(f64, bool)| {
            let is_known = self.known.last().is_some_and(|known| known[1] == *said_s);
            is_known && touches == Some(*said) && time_s - said_s < MERGED_S
        };
        let said = self.said.filter(|said| row_before.is_some() && says_the_same(said));
        let before = said.map(|(said_s, said)| (said_s, Some(said))).or(row_before);
        let known_before = before.and_then(|(_, touched)| touched);
        if let Some((last_s, _)) = before {
            if touches.is_some() && known_before.is_some() {
                self.open_s = 0.0;
                self.seconds += time_s - last_s;
                match self.known.last_mut().filter(|known| known[1] == last_s) {
                    Some(known) => known[1] = time_s,
                    None => self.known.push([last_s, time_s]),
                }
            } else {
                self.open_s += time_s - last_s;
            }
        }
        if touches.is_some() || row_before.is_none() {
            self.unknown_s += std::mem::take(&mut self.open_s);
            self.said = touches.map(|touches| (time_s, touches));
        }
        match (known_before, touches) {
            (Some(true), Some(_)) => {
                if let Some(contact) = self.contacts.last_mut() {
                    contact.end_s = time_s;
                    contact.end_known = touches == Some(false);
                }
            }
            (_, Some(true)) => match self.contacts.last_mut() {
                Some(contact) if known_before.is_some() && contact.end_known && time_s - contact.end_s < MERGED_S => {
                    (contact.end_s, contact.end_known) = (time_s, false);
                }
                _ => self.contacts.push(Contact {
                    start_s: time_s,
                    end_s: time_s,
                    start_known: known_before == Some(false),
                    end_known: false,
                }),
            },
            _ => {}
        }
        self.last = Some((time_s, touches));
    }

    /// The time between rows of which one does not say whether the finger touches, seconds; gaps are not counted.
    #[must_use]
    pub(crate) fn unknown_s(&self) -> f64 {
        self.unknown_s + self.open_s
    }

    /// Whether contact is known at a time, of rows whose times ascend as a stream's do.
    #[must_use]
    pub fn knows(&self, time_s: f64) -> bool {
        let after = self.known.partition_point(|known| known[0] <= time_s);
        after > 0 && time_s <= self.known[after - 1][1]
    }

    /// How many of `times_s`, ascending, are in each of equal parts of the time of which contact is known.
    #[must_use]
    pub fn by_parts(&self, times_s: impl IntoIterator<Item = f64>) -> [u64; PARTS] {
        let mut parts = [0; PARTS];
        let (mut known, mut before_s) = (self.known.iter().peekable(), 0.0);
        for time_s in times_s {
            while let Some([from_s, to_s]) = known.next_if(|known| known[1] < time_s) {
                before_s += to_s - from_s;
            }
            let since_s = known.peek().map_or(0.0, |known| (time_s - known[0]).max(0.0));
            let part = ((before_s + since_s) / self.seconds * PARTS as f64) as usize;
            parts[part.min(PARTS - 1)] += 1;
        }
        parts
    }

    /// Whether the finger touches at a time; none where it is not known.
    #[must_use]
    pub fn touches(&self, time_s: f64) -> Option<bool> {
        let begun = self.contacts.partition_point(|one| one.start_s <= time_s);
        self.knows(time_s).then(|| begun > 0 && time_s < self.contacts[begun - 1].end_s)
    }
}
