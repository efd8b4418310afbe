//! Rows beside a switch of the LED that are not what `led` says: one that is written a row early or late, or light that
//! has not settled.
//!
//! In: when the LED was on, by row, and the photodiodes. Out: what to say where the first or the last row of the LED's
//! phases lies between the level of its own phase and that of the one beside it. A finger's movement cancels out over
//! many phases.
//!
//! Measured on phantom logs of ten rows a phase: `led` a row late took R2 of the forces from 0.97 to 0.63; of five rows
//! a phase, of which the first is settled by 80 %, Fy from 0.96 to 0.59. As they should be, first and last rows are
//! within 0.0001 of their phase in the median (12 logs of three persons, of 3, 5 and 10 rows a phase).

use crate::log::Channel;
use crate::median::median_of;

/// A phase has so many rows, or nothing is known of its ends; and so many phases are needed.
const ROWS: usize = 3;
const PHASES: usize = 10;
/// How far rows may be on the way to the other level (assumed: what forces do to a photodiode is a twentieth of that).
const SETTLED: f64 = 0.03;

/// What to say of them.
pub(super) fn unsettled(led: &[bool], photodiodes: &[Channel]) -> Option<String> {
    let level = |row: &usize| photodiodes.iter().map(|channel| channel.values[*row]).sum::<f64>();
    let rows: Vec<usize> = (0..led.len()).collect();
    let phases: Vec<&[usize]> = rows.chunk_by(|a, b| led[*a] == led[*b]).collect();
    let inner = |phase: &&[usize]| match phase {
        [_, inner @ .., _] if !inner.is_empty() => median_of(inner.iter().map(level)),
        short => median_of(short.iter().map(level)),
    };
    let levels: Vec<f64> = phases.iter().map(|phase| inner(phase).unwrap_or(f64::NAN)).collect();
    let share = |on: bool, is_first: bool| {
        let shares =
            (1..phases.len().saturating_sub(1)).filter(|&k| phases[k].len() >= ROWS && led[phases[k][0]] == on);
        let of = |k: usize| {
            let (row, beside) = if is_first { (phases[k].first(), k - 1) } else { (phases[k].last(), k + 1) };
            let level = row.map_or(f64::NAN, level);
            (level - levels[k]) / (levels[beside] - levels[k])
        };
        let shares: Vec<f64> = shares.map(of).filter(|share| share.is_finite()).collect();
        (shares.len() >= PHASES).then(|| median_of(shares)).flatten()
    };
    let ends = [(true, true), (true, false), (false, true), (false, false)];
    let all = ends.into_iter().filter_map(|end| Some((end, share(end.0, end.1)?)));
    let ((on, is_first), most) = all.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, most)| *most > SETTLED)?;
    let [own, other] = if on { ["on", "unlit"] } else { ["off", "lit"] };
    let (which, early) = if is_first { ("first", "early") } else { ("last", "late") };
    Some(format!(
        "the {which} row of each time that the LED is {own} is {:.0} % of the way at the level of the {other} ones: is \
         `led` a row {early}, or has the light not settled? Leave `led` empty in such rows, and they are passed over",
        100.0 * most
    ))
}
