//! A log's time as a whole: rows out of order, clocks that were reset, stamps that repeat, gaps.
//!
//! In: rows in the file's order. Out: a [`Log`] whose time ascends, and notes on what its time is like.
//!
//! A run of rows that are late (behind the latest stamp so far) is a small disorder, and sorted, where it has at most
//! [`LATE_ROWS`] rows, reaches back by at most as many steps, and takes a hole that is there for it: sorted, the rows
//! there are about as dense as everywhere, and those after them are where they would have been. Anything else that
//! falls back is a clock that was reset, and so is a leap of more than a day. Where 32 bits of microseconds begin again
//! time goes on.

use std::num::NonZeroUsize;

use crate::log::formats::raw::Raw;
use crate::log::lines::stamps::DAY_S;
use crate::log::{Channel, Log, LogError};
use crate::median::median_of;

/// The longest run of late rows that counts as a small disorder.
const LATE_ROWS: usize = 16;

/// A step of more than so many usual ones is a gap.
const GAP_STEPS: f64 = 5.0;

/// Rows that stay behind by so many steps, and standard errors of both sides (assumed: where stamps jitter, many a row
/// is late, and the latest of hundreds is looked at), were not late.
const STAYS: f64 = 0.75;
const STAYS_SES: f64 = 12.0;

/// After so many seconds 32 bits of microseconds begin again, as those of an Arduino do.
const TURN_S: f64 = 4_294.967_296;

/// Orders the rows by time.
pub(in crate::log) fn settle(mut raw: Raw, piece: Option<NonZeroUsize>) -> Result<Log, LogError> {
    let read = raw.time_s.len();
    let untimed = raw.time_s.iter().filter(|t| t.is_nan()).count();
    let known: Vec<bool> = match &raw.led {
        Some(led) => raw.time_s.iter().zip(led).map(|(t, led)| !t.is_nan() && led.is_some()).collect(),
        None => raw.time_s.iter().map(|t| !t.is_nan()).collect(),
    };
    let mut rows: Vec<usize> = (0..read).filter(|&row| known[row]).collect();
    let unlabelled = read - untimed - rows.len();
    for (count, what) in [(untimed, "have no time"), (unlabelled, "do not say whether the LED was on")] {
        if count > 0 {
            raw.notes.push(format!("{count} of {read} rows {what} and are left out"));
        }
    }
    if rows.is_empty() {
        return Err(raw.no_rows());
    }
    unwrap(&mut raw, &rows);
    rows = one_piece(&mut raw, rows, piece)?;
    sort(&mut raw, &mut rows);
    let time_s: Vec<f64> = rows.iter().map(|&row| raw.time_s[row]).collect();
    let step_s = median_step_s(&time_s);
    tell_repeats(&mut raw, &rows, &time_s, step_s);
    tell_gaps(&mut raw, &rows, &time_s, step_s);
    let midnight_s = raw.midnight_s.map(|midnight_s| midnight_s + ((time_s[0] - midnight_s) / DAY_S).floor() * DAY_S);
    let in_order = rows.len() == read && rows.iter().enumerate().all(|(k, &row)| k == row);
    let channels = |channels: Vec<Channel>| -> Vec<Channel> {
        let ordered = |channel: Channel| {
            let Channel { name, values } = channel;
            Channel { name, values: if in_order { values } else { rows.iter().map(|&row| values[row]).collect() } }
        };
        channels.into_iter().map(ordered).collect()
    };
    let (photodiodes, forces) = (channels(raw.photodiodes), channels(raw.forces));
    for Channel { name, values } in photodiodes.iter().chain(&forces) {
        let missing = values.iter().filter(|v| v.is_nan()).count();
        // Of a channel without any, `samples` warns.
        if (1..values.len()).contains(&missing) {
            raw.notes.push(format!("{name} has no value in {missing} of {} rows", values.len()));
        }
    }
    let led = raw.led.map(|led| rows.iter().map(|&row| led[row] == Some(true)).collect());
    Ok(Log { path: raw.path, time_s, midnight_s, led, photodiodes, forces, notes: raw.notes })
}

/// Lets time go on where 32 bits of microseconds begin again: it falls back by a turn, but for at most as many steps as
/// late rows reach back.
fn unwrap(raw: &mut Raw, rows: &[usize]) {
    if !rows.windows(2).any(|pair| raw.time_s[pair[1]] - raw.time_s[pair[0]] < -TURN_S / 2.0) {
        return;
    }
    let time_s: Vec<f64> = rows.iter().map(|&row| raw.time_s[row]).collect();
    let Some(step_s) = median_step_s(&time_s) else { return };
    let near_s = LATE_ROWS as f64 * step_s;
    let (mut turns, mut first) = (0.0, None);
    for k in 1..rows.len() {
        let on_s = time_s[k] - time_s[k - 1];
        if on_s < 0.0 && (on_s + TURN_S).abs() <= near_s {
            turns += 1.0;
            first.get_or_insert(rows[k]);
        } else if turns > 0.0 && (on_s - TURN_S).abs() <= near_s {
            turns -= 1.0;
        }
        raw.time_s[rows[k]] += turns * TURN_S;
    }
    if let Some(first) = first {
        raw.notes.push(format!(
            "the clock's 32 bits of microseconds began again after 71.6 minutes, at {}; time goes on from there",
            raw.word.at(raw.places[first])
        ));
    }
}

/// The rows of the piece that is asked for; of all where the clock was not reset.
fn one_piece(raw: &mut Raw, rows: Vec<usize>, piece: Option<NonZeroUsize>) -> Result<Vec<usize>, LogError> {
    let time_s: Vec<f64> = rows.iter().map(|&row| raw.time_s[row]).collect();
    let error = |raw: &Raw, row: usize, what: String| LogError::Time { place: raw.place(rows[row]), what };
    let back = time_s.windows(2).filter(|pair| pair[1] < pair[0]).count();
    if let Some(first) = (1..time_s.len()).find(|&k| time_s[k] < time_s[k - 1])
        && 2 * back > time_s.len() - 1
    {
        let what = "time runs backwards from here on; sort the rows by time".to_owned();
        return Err(error(raw, first, what));
    }
    let breaks = breaks(&time_s);
    let pieces = breaks.len() + 1;
    let Some(piece) = piece else {
        let Some(&at) = breaks.first() else { return Ok(rows) };
        let (before, after) = (time_s[at - 1], time_s[at]);
        let does = if after < before { "falls back" } else { "leaps" };
        let which = if pieces > 2 { format!(" (the first of {} such places)", pieces - 1) } else { String::new() };
        let what = format!(
            "time {does} from {before} s to {after} s here{which}, as where a clock is set; cut the file there, or \
             choose one of the {pieces} pieces with --piece"
        );
        return Err(error(raw, at, what));
    };
    if piece.get() > pieces {
        let what = format!("has {pieces} piece(s) between resets of its clock, so there is no --piece {piece}");
        return Err(LogError::File { path: raw.path.clone(), what });
    }
    let begin = if piece.get() == 1 { 0 } else { breaks[piece.get() - 2] };
    let end = breaks.get(piece.get() - 1).copied().unwrap_or(rows.len());
    if pieces > 1 {
        let (first, last) = (raw.word.at(raw.places[rows[begin]]), raw.word.at(raw.places[rows[end - 1]]));
        raw.notes.push(format!("piece {piece} of {pieces} is taken, from {first} to {last}"));
    }
    Ok(rows[begin..end].to_vec())
}

/// Where the clock was reset: the rows at which time starts again.
fn breaks(time_s: &[f64]) -> Vec<usize> {
    let step_s = median_step_s(time_s).unwrap_or(0.0);
    let mut breaks = Vec::new();
    let mut latest = time_s[0];
    let mut begin = 0;
    let mut k = 1;
    while k < time_s.len() {
        if time_s[k] >= latest {
            if time_s[k] - latest > DAY_S {
                breaks.push(k);
                begin = k;
            }
            latest = time_s[k];
            k += 1;
            continue;
        }
        let run = time_s[k..].iter().take(LATE_ROWS + 1).take_while(|&&t| t < latest).count();
        if is_small(&time_s[begin..], k - begin, run, latest, step_s) {
            k += run;
        } else {
            breaks.push(k);
            begin = k;
            latest = time_s[k];
            k += 1;
        }
    }
    breaks
}

/// Whether the `run` rows from `k` on, all before `latest`, are a small disorder.
fn is_small(time_s: &[f64], k: usize, run: usize, latest: f64, step_s: f64) -> bool {
    let earliest = time_s[k..k + run].iter().copied().fold(f64::INFINITY, f64::min);
    let steps = (latest - earliest) / step_s;
    let there = time_s[k.saturating_sub(4 * LATE_ROWS)..k + run].iter().filter(|&&t| t >= earliest).count() as f64;
    run <= LATE_ROWS.min((time_s.len() / 4).max(1))
        && time_s.len() > 2
        && steps <= LATE_ROWS as f64
        && (0.6 * steps - 1.0..=1.5 * steps + 2.0).contains(&there)
        && !stays_behind(time_s, k, run, earliest, step_s)
}

/// Whether rows that come evenly stay behind from there on, as where a clock was set back by little: late rows leave
/// those after them where they would have been.
fn stays_behind(time_s: &[f64], k: usize, run: usize, earliest: f64, step_s: f64) -> bool {
    // Those before the hole that the late rows leave.
    let hole = (k.saturating_sub(2 * LATE_ROWS)..k).find(|&row| time_s[row] >= earliest).unwrap_or(k);
    let before = time_s[hole.saturating_sub(LATE_ROWS)..hole].iter().rev();
    let after = time_s[k + run..(k + run + LATE_ROWS).min(time_s.len())].iter();
    let sides = [Side::of(before.map(|t| -t), step_s), Side::of(after.copied(), step_s)];
    let [Some(before), Some(after)] = sides else { return false };
    // Between the two lie the rows that are late and those that they are behind of.
    let between = (k + run - hole + 1) as f64 * 0.5 * (before.step_s + after.step_s);
    let behind_s = between - (after.from_s + before.from_s);
    behind_s > (STAYS * step_s).max(STAYS_SES * before.se_s.hypot(after.se_s))
}

/// Rows on one side of a hole, from it on: where their line begins, and how surely.
struct Side {
    from_s: f64,
    se_s: f64,
    step_s: f64,
}

impl Side {
    /// Of stamps that ascend; none of few, or of such as repeat or do not come evenly.
    fn of(time_s: impl Iterator<Item = f64>, usual_s: f64) -> Option<Self> {
        let time_s: Vec<f64> = time_s.collect();
        let is_even = |step_s: &f64| (0.5 * usual_s..=1.5 * usual_s).contains(step_s);
        let steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let even: Vec<f64> = steps.iter().copied().filter(is_even).collect();
        if steps.len() < LATE_ROWS / 2 || 5 * even.len() < 4 * steps.len() || steps.contains(&0.0) {
            return None;
        }
        let step_s = even.iter().sum::<f64>() / even.len() as f64;
        let on_line = |(row, t): (usize, &f64)| t - row as f64 * step_s;
        let from_s = median_of(time_s.iter().enumerate().map(on_line))?;
        let off_s2 = time_s.iter().enumerate().map(|row| (on_line(row) - from_s).powi(2)).sum::<f64>();
        // The middle of white numbers is known 1.25 times worse than their mean.
        let se_s = 1.25 * off_s2.sqrt() / time_s.len() as f64;
        Some(Self { from_s, se_s, step_s })
    }
}

/// Sorts rows that are out of order, and notes it.
fn sort(raw: &mut Raw, rows: &mut [usize]) {
    let time = |row: usize| raw.time_s[row];
    let mut latest = rows[0];
    let (mut late, mut first, mut by_s) = (0, None, 0.0_f64);
    for &row in rows.iter() {
        if time(row) < time(latest) {
            late += 1;
            first.get_or_insert(row);
            by_s = by_s.max(time(latest) - time(row));
        } else {
            latest = row;
        }
    }
    if let Some(first) = first {
        rows.sort_by(|&a, &b| raw.time_s[a].total_cmp(&raw.time_s[b]));
        let place = raw.word.at(raw.places[first]);
        raw.notes.push(format!(
            "{late} row(s) stood behind later ones, by up to {} s (the first: {place}); rows are sorted by time",
            short(by_s)
        ));
    }
}

fn tell_repeats(raw: &mut Raw, rows: &[usize], time_s: &[f64], step_s: Option<f64>) {
    let repeats = |k: &usize| time_s[*k] == time_s[k - 1];
    let count = (1..time_s.len()).filter(repeats).count();
    let Some(first) = (1..time_s.len()).find(repeats) else { return };
    let distinct = time_s.len() - count;
    // More than half of the rows stand in blocks of their stamp.
    if 2 * count >= time_s.len() / 2 && count >= distinct / 2 {
        let rows_a_block = time_s.len() as f64 / distinct as f64;
        let apart = step_s.map(|s| format!(", {} s apart", short(s))).unwrap_or_default();
        raw.notes.push(format!(
            "rows come in blocks of one time stamp (about {rows_a_block:.1} rows each{apart}); when a row was taken \
             is known only to the block"
        ));
    } else {
        let place = raw.word.at(raw.places[rows[first]]);
        raw.notes.push(format!(
            "{count} row(s) have the same time stamp as the row before (the first: {place}); all are kept"
        ));
    }
}

fn tell_gaps(raw: &mut Raw, rows: &[usize], time_s: &[f64], step_s: Option<f64>) {
    let Some(step_s) = step_s else { return };
    let step = |k: usize| time_s[k] - time_s[k - 1];
    let gaps: Vec<usize> = (1..time_s.len()).filter(|&k| step(k) > GAP_STEPS * step_s).collect();
    // The first of equals.
    let Some(&longest) = gaps.iter().rev().max_by(|&&a, &&b| step(a).total_cmp(&step(b))) else { return };
    raw.notes.push(format!(
        "{} gap(s) of more than {GAP_STEPS} steps of {} s; the longest, {} s, ends at {}",
        gaps.len(),
        short(step_s),
        short(step(longest)),
        raw.word.at(raw.places[rows[longest]])
    ));
}

/// The usual step between different stamps, seconds.
pub(in crate::log) fn median_step_s(time_s: &[f64]) -> Option<f64> {
    median_of(time_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|&step| step > 0.0))
}

/// A number with three digits, for a message.
pub(in crate::log) fn short(number: f64) -> String {
    let decimals = (2.0 - number.abs().max(1e-9).log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{number:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
