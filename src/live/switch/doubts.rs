//! What makes it doubtful that a recording's contact is what the finger did: it is the other way round, of another
//! recording, on another clock, or its switch sticks.

use lunula_live::switch::{Contact, Fate, Lag, Match, Trace, any_contact, false_by_parts, heaping};

use crate::median::median_of;

/// By how much values follow contact at most, and come before it, seconds, and how much likeness a shift has to win
/// (assumed: `Lag` says what phantoms give; blood takes 0.1 to 0.3 s, 4.3). Values that are less like contact than the
/// second are those of a model that is slow itself, as one of spirals, and say nothing of clocks.
const LATE_S: f64 = 0.27;
const LIKE: f64 = 0.9;
const EARLY_S: f64 = 0.1;
const GAIN: f64 = 0.02;

/// That the model's values follow contact later than blood does, or come before it.
pub(super) fn on_another_clock(trace: &Trace) -> Option<String> {
    let Lag { by_s, shifted, recorded } = Lag::of(trace)?;
    let [side, than] = match by_s {
        late if late > LATE_S && shifted > LIKE => ["after", "a nail takes 0.1 to 0.3 s"],
        early if early < -EARLY_S - 1e-9 => ["before", "no finger does"],
        _ => return None,
    };
    (shifted - recorded >= GAIN).then(|| {
        format!(
            "what the model says comes {:.2} s {side} contact, and {than}: was contact logged on another clock? Delays \
             hold the difference (correlation {recorded:.2}, shifted so {shifted:.2})",
            by_s.abs()
        )
    })
}

/// Contact that changes so often, and only at rows that are a multiple of so many apart, or of so long, seconds, is
/// held (assumed; by chance ten changes are all a multiple of three rows apart once in 20,000 recordings).
const CHANGES: usize = 10;
const HELD_ROWS: usize = 3;
const HELD_S: f64 = 0.03;

/// That contact, as 0 and 1, is of a slower log, whose values stand in several rows each.
pub(super) fn held(times: &[f64], flags: &[f64]) -> Option<String> {
    let changes: Vec<usize> = (1..flags.len()).filter(|&k| (flags[k] - flags[k - 1]).abs() == 1.0).collect();
    let rows = changes.windows(2).map(|pair| pair[1] - pair[0]).reduce(common)?;
    let step_s = median_of(times.windows(2).map(|pair| pair[1] - pair[0]))?;
    let held_s = rows as f64 * step_s;
    (changes.len() >= CHANGES && rows >= HELD_ROWS && held_s >= HELD_S).then(|| {
        format!(
            "contact changes in each {rows}th row only, {held_s:.2} s apart, as that of a slower log does: it comes up \
             to so much late, and presses then seem to come before it; log it as often as the photodiodes"
        )
    })
}

/// The greatest number of which both are multiples.
fn common(one: usize, other: usize) -> usize {
    if other == 0 { one } else { common(other, one % other) }
}

/// A press that begins so long after its contact began, and after its end, is no press of it, seconds (assumed: blood
/// follows within 0.4 s, 4.3).
const LONG_S: f64 = 1.0;

/// Fewer contacts say nothing of that.
const FEWEST: usize = 3;

/// That what is called contact is not what a switch was pressed by, in all recordings or in some; `names` are theirs,
/// `found` what became of its presses there.
pub(super) fn elsewhere(names: &[String], traces: &[Trace], found: &[Vec<Match>]) -> Vec<String> {
    if let Err(why) = any_contact(traces) {
        return vec![why.to_string()];
    }
    let of = |((name, trace), found): ((&String, &Trace), &Vec<Match>)| {
        let what = ragged(trace)
            .or_else(|| elsewhere_in(found))
            .or_else(|| closed(trace, found))
            .or_else(|| open(trace, found))?;
        Some(format!("{name}: {what}"))
    };
    names.iter().zip(traces).zip(found).filter_map(of).collect()
}

/// More contacts than this share that last a row or two are made by noise (10 recordings of phantoms: 0.19 at most; of
/// forces with noise near the threshold 0.9).
const RAGGED: f64 = 0.5;
/// Of so many at least.
const CONTACTS: usize = 20;

/// That most contacts are too short for a finger.
fn ragged(trace: &Trace) -> Option<String> {
    let contacts = &trace.contacts.contacts;
    let step_s = median_of(trace.time_s.windows(2).map(|pair| pair[1] - pair[0]))?;
    let short = contacts.iter().filter(|one| one.end_s - one.start_s < 2.5 * step_s).count();
    (contacts.len() >= CONTACTS && short as f64 > RAGGED * contacts.len() as f64).then(|| {
        format!(
            "{short} of {} contacts last a row or two, which no finger does: is the threshold of contact within the \
             force's noise? False presses then pass for true ones, and presses for missed",
            contacts.len()
        )
    })
}

fn elsewhere_in(found: &[Match]) -> Option<String> {
    let of = |fate| found.iter().filter(move |one| one.fate == fate);
    let (own, missed) = (of(Fate::True).count(), of(Fate::Missed).count());
    let contacts = own + missed;
    if contacts < FEWEST {
        return None;
    }
    let judged = found.len() - missed;
    let wrong = judged - own;
    if 2 * missed > contacts && 2 * wrong > judged {
        return Some(format!(
            "{missed} of {contacts} contacts are missed and {wrong} of {judged} presses are false: is contact that of \
             this recording, on its clock, and the right way round?",
        ));
    }
    let behind = |one: &&Match| {
        one.contact.is_some_and(|contact| one.press_s >= contact.end_s && one.press_s > contact.start_s + LONG_S)
    };
    let behind = of(Fate::True).filter(behind).count();
    (2 * behind > own)
        .then(|| format!("{behind} of {own} presses begin when their contact is over: is contact the right way round?"))
}

/// So many presses within a contact, or without any, ...
const PRESSES: usize = 5;
/// ... in so many times as long as contacts usually are, are those of a contact that does not follow the finger.
const LONG: f64 = 10.0;

/// That a contact lasts on while the finger presses again and again.
fn closed(trace: &Trace, found: &[Match]) -> Option<String> {
    let length_s = |one: &Contact| one.end_s - one.start_s;
    let contacts = &trace.contacts.contacts;
    let usual_s = median_of(contacts.iter().map(length_s)).filter(|_| contacts.len() >= FEWEST)?;
    let longest = contacts.iter().max_by(|a, b| length_s(a).total_cmp(&length_s(b)))?;
    let again = found.iter().filter(|one| one.fate == Fate::Repeated && one.contact == Some(*longest)).count();
    (again >= PRESSES && length_s(longest) >= LONG * usual_s).then(|| {
        format!(
            "contact lasts from {:.1} to {:.1} s, {usual_s:.1} s in the median, and the finger presses {} times \
             within: does what measures contact stick, or does the finger stay on? Where it sticks, leave it empty",
            longest.start_s,
            longest.end_s,
            again + 1
        )
    })
}

/// That there is none for long while the finger presses as often as where there is.
fn open(trace: &Trace, found: &[Match]) -> Option<String> {
    let contacts = &trace.contacts.contacts;
    let (first, last) = (contacts.first()?, contacts.last()?);
    let ends = [*trace.time_s.first()?, *trace.time_s.last()?];
    let touched_s = last.end_s - first.start_s;
    let without = [[ends[0], first.start_s], [last.end_s, ends[1]]];
    let between = contacts.windows(2).map(|pair| [pair[0].end_s, pair[1].start_s]);
    let [from_s, to_s] = without.into_iter().chain(between).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
    let is_within = |one: &&Match| one.fate == Fate::False && (from_s..=to_s).contains(&one.press_s);
    let presses = found.iter().filter(is_within).count();
    // Half as often.
    let is_as_often = 2.0 * presses as f64 * touched_s >= contacts.len() as f64 * (to_s - from_s);
    (contacts.len() >= FEWEST && presses >= PRESSES && is_as_often).then(|| {
        format!(
            "there is no contact from {from_s:.1} to {to_s:.1} s, and the finger presses {presses} times there: did \
             what measures contact work? Where it did not, leave contact empty"
        )
    })
}

/// That false switches of a recording come in heaps.
pub(super) fn heaped(names: &[String], traces: &[Trace], found: &[Vec<Match>]) -> Vec<String> {
    let of = |((name, trace), found): ((&String, &Trace), &Vec<Match>)| {
        let parts = false_by_parts(&trace.contacts, found);
        let wider = heaping(&parts, traces.len());
        let (at, &most) = parts.iter().enumerate().max_by_key(|(_, count)| **count).filter(|_| wider > 1.0)?;
        let before: u64 = parts[..at].iter().sum();
        let all: Vec<f64> = found.iter().filter(|one| one.is_false()).map(|one| one.press_s).collect();
        let within = &all[before as usize..(before + most) as usize];
        Some(format!(
            "{name}: {most} of {} false switches come from {:.1} to {:.1} s, more than by chance (dispersion over time \
             {wider:.1}): they are no independent events, and the interval is wider for it; look at what happened \
             there, and record longer",
            all.len(),
            within.first()?,
            within.last()?
        ))
    };
    names.iter().zip(traces).zip(found).filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contact_of_a_slower_log_is_seen() {
        let said = |step_s: f64, every: usize, changes: usize| {
            let times: Vec<f64> = (0..6000).map(|k| step_s * f64::from(k)).collect();
            // Each is down for 0.4 s, about, and up for as long and some more.
            let mut rows = Vec::new();
            (0..changes).fold(0, |at, k| {
                rows.push(at + 30 + 7 * (k * k % 11));
                rows[k]
            });
            let down = |k: usize| rows.iter().filter(|&&row| row <= k / every * every).count() % 2 == 1;
            let flags: Vec<f64> = (0..6000).map(|k| f64::from(u8::from(down(k)))).collect();
            held(&times, &flags).unwrap_or_default()
        };
        let ten = said(0.01, 10, 40);
        assert!(ten.contains("in each 10th row only, 0.10 s apart"), "{ten}");
        assert!(said(0.01, 4, 12).contains("each 4th row only"));
        for fine in [said(0.01, 1, 40), said(0.01, 2, 40), said(0.001, 10, 40), said(0.01, 10, 8)] {
            assert_eq!(fine, "");
        }
    }
}
