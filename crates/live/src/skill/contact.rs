//! When a finger touches: two thresholds and a hold.
//!
//! A contact begins where the force comes up to the touch threshold, and ends where it falls below the release
//! threshold, both on the straight line between two rows. Then breaks shorter than the hold are closed, and contacts
//! shorter than the hold are dropped, where both of their ends were seen.

use std::ops::Range;

use super::force::{Force, Row};

/// What counts as a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thresholds {
    /// A contact begins at this pressing force, newtons.
    pub touch_n: f64,
    /// It ends below this one, newtons.
    pub release_n: f64,
    /// Shorter contacts and breaks are none, seconds.
    pub hold_s: f64,
}

/// A finger on the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// The moment at which it begins, seconds.
    pub from_s: f64,
    /// The moment at which it ends, seconds.
    pub to_s: f64,
    /// The rows within it.
    pub rows: Range<usize>,
    /// Whether its beginning was seen; else it was there when the force came to be known.
    pub begin_seen: bool,
    /// Whether its end was seen.
    pub end_seen: bool,
}

/// All contacts of a finger, in the order of time.
#[must_use]
pub fn contacts(force: &Force, thresholds: &Thresholds) -> Vec<Contact> {
    let held = |from_s: f64, to_s: f64| to_s - from_s >= thresholds.hold_s;
    let mut closed: Vec<Contact> = Vec::new();
    for next in all(force, thresholds) {
        match closed.last_mut() {
            Some(last) if last.end_seen && next.begin_seen && !held(last.to_s, next.from_s) => {
                last.rows.end = next.rows.end;
                (last.to_s, last.end_seen) = (next.to_s, next.end_seen);
            }
            _ => closed.push(next),
        }
    }
    closed.retain(|one| !(one.begin_seen && one.end_seen) || held(one.from_s, one.to_s));
    closed
}

/// Contacts by the two thresholds alone.
fn all(force: &Force, thresholds: &Thresholds) -> Vec<Contact> {
    let &Thresholds { touch_n, release_n, .. } = thresholds;
    let time_s = &force.time_s;
    let longest_s = force.longest_step_s();
    let (mut found, mut open): (Vec<Contact>, Option<Contact>) = (Vec::new(), None);
    let mut before = Row::Unknown;
    for row in 0..time_s.len() {
        if row > 0 && time_s[row] - time_s[row - 1] > longest_s {
            before = Row::Unknown;
        }
        if before == Row::Unknown {
            found.extend(open.take());
        }
        let now = force.row(row);
        // Where the line from the row before crosses a threshold; the row's own time where there is no such line.
        let crossed = |level_n: f64| match (before, now) {
            (Row::Known(from_n), Row::Known(to_n)) => {
                time_s[row - 1] + (level_n - from_n) / (to_n - from_n) * (time_s[row] - time_s[row - 1])
            }
            _ => time_s[row],
        };
        match (now, &mut open) {
            (Row::Known(now_n), Some(contact)) if now_n >= release_n => {
                (contact.to_s, contact.rows.end) = (time_s[row], row + 1);
            }
            (Row::Known(_), Some(contact)) => {
                (contact.to_s, contact.end_seen) = (crossed(release_n), true);
                found.extend(open.take());
            }
            (Row::Lifted, Some(contact)) => {
                contact.end_seen = true;
                found.extend(open.take());
            }
            (Row::Known(now_n), None) if now_n >= touch_n => {
                let (from_s, begin_seen) = (crossed(touch_n), before != Row::Unknown);
                open = Some(Contact { from_s, to_s: time_s[row], rows: row..row + 1, begin_seen, end_seen: false });
            }
            _ => {}
        }
        before = now;
    }
    found.extend(open);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const THRESHOLDS: Thresholds = Thresholds { touch_n: 0.2, release_n: 0.1, hold_s: 0.0 };

    fn force(force_n: &[f64]) -> Force {
        let time_s = (0..force_n.len()).map(|row| 0.1 * row as f64).collect();
        Force { time_s, force_n: force_n.to_vec(), lifted: Vec::new() }
    }

    fn times(found: &[Contact]) -> Vec<[f64; 2]> {
        found.iter().map(|one| [one.from_s, one.to_s].map(|time_s| (time_s * 1e9).round() / 1e9)).collect()
    }

    #[test]
    fn ends_are_where_the_line_crosses_the_thresholds() {
        // Up at 2 N a row from 0.1, down at 0.4 N in a row from 0.3.
        let found = contacts(&force(&[0.0, 0.0, 2.0, 0.4, 0.0, 0.0]), &THRESHOLDS);
        assert_eq!(times(&found), [[0.11, 0.375]]);
        assert!(found[0].begin_seen && found[0].end_seen && found[0].rows == (2..4));
    }

    #[test]
    fn between_the_thresholds_nothing_changes() {
        let found = contacts(&force(&[0.0, 0.19, 0.0, 1.0, 0.11, 1.0, 0.0, 0.15]), &THRESHOLDS);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].rows, 3..6);
    }

    #[test]
    fn short_contacts_and_breaks_are_none() {
        let wave = force(&[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
        assert_eq!(contacts(&wave, &THRESHOLDS).len(), 3);
        let held = contacts(&wave, &Thresholds { hold_s: 0.18, ..THRESHOLDS });
        assert_eq!(held.len(), 1);
        assert_eq!(held[0].rows, 5..10);
    }

    #[test]
    fn what_is_not_known_ends_a_contact_and_hides_its_ends() {
        let found = contacts(&force(&[1.0, 1.0, f64::NAN, 1.0, 0.0, 0.0]), &Thresholds { hold_s: 0.5, ..THRESHOLDS });
        assert_eq!(times(&found), [[0.0, 0.1], [0.3, 0.39]]);
        assert_eq!(
            found.iter().map(|one| (one.begin_seen, one.end_seen)).collect::<Vec<_>>(),
            [(false, false), (false, true)]
        );
        let mut gap = force(&[0.0, 1.0, 1.0, 1.0, 1.0, 0.0]);
        gap.time_s[3..].iter_mut().for_each(|time_s| *time_s += 1.0);
        let found = contacts(&gap, &THRESHOLDS);
        assert_eq!(times(&found), [[0.02, 0.2], [1.3, 1.49]]);
        assert_eq!([found[0].begin_seen, found[0].end_seen, found[1].begin_seen], [true, false, false]);
    }

    #[test]
    fn a_gate_ends_a_contact_whatever_the_force() {
        let mut gated = force(&[5.0, 1.0, 1.0, 1.0, 5.0]);
        gated.lifted = vec![true, false, false, false, true];
        let found = contacts(&gated, &THRESHOLDS);
        assert_eq!(times(&found), [[0.1, 0.3]]);
        assert!(found[0].begin_seen && found[0].end_seen);
    }
}
