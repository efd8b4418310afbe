//! Whether photodiodes and what was measured beside them are on one clock.
//!
//! In: a [`Dataset`]. Out: of each recording by how much its targets come after the photodiodes that answer to them:
//! the delay at which a linear model (equations 10 to 13) leaves the least of their variance unexplained, among those
//! of up to five seconds or a quarter of the recording, the shortest of those as good. Blood answers to a press within
//! tenths of a second (4.3), so that a delay above 0 is none of the finger's.

use std::ops::Range;

use ndarray::Array2;
use rayon::prelude::*;

use super::path::{Between, seconds};
use crate::Dataset;
use crate::algebra::small::{Column, dot, triangulate};

/// The longest delay that is looked for, seconds and as a share of the recording, and how finely.
const LONGEST_S: f64 = 5.0;
const SHARE: f64 = 0.25;
const STEPS: i32 = 50;
/// Moments of a recording that are looked at.
const MOMENTS: usize = 400;
/// Rows for each unknown, at least, and inputs, at most: more of them explain much by chance.
const ROWS: usize = 20;
const INPUTS: usize = 16;
/// So many times the least that is left unexplained is as good: of these the least delay is taken.
const PERIODS: f64 = 1.25;
/// A target whose variance is no more of its mean square does not change but for rounding.
const STILL: f64 = 1e-20;

/// Photodiodes and targets of a recording, one shifted in time against the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay {
    /// The targets come so many seconds after what the photodiodes answer to; below 0, before it.
    pub by_s: f64,
    /// The share of the targets' variance that is left unexplained as they were recorded.
    pub recorded: f64,
    /// The same once the delay is taken away.
    pub without: f64,
}

/// Each recording's delay; none where it is not known: times that are missing or do not ascend, few rows, many or
/// hidden inputs, targets that do not change.
#[must_use]
pub fn delays(data: &Dataset) -> Vec<Option<Delay>> {
    data.recordings().par_iter().map(|one| delay(data, &one.rows)).collect()
}

fn delay(data: &Dataset, rows: &Range<usize>) -> Option<Delay> {
    let inputs = data.inputs().len();
    if inputs == 0 || inputs > INPUTS || rows.len() < ROWS * (1 + inputs) {
        return None;
    }
    let times = seconds(data, rows)?;
    let last = times.last().copied().filter(|last| *last > 0.0)?;
    let longest = LONGEST_S.min(SHARE * last);
    let moments = MOMENTS.min(rows.len());
    let moment = |k: usize| longest + (last - 2.0 * longest) * k as f64 / (moments - 1) as f64;
    let shifts: Vec<f64> = (-STEPS..=STEPS).map(|k| longest * f64::from(k) / f64::from(STEPS)).collect();
    // Ones, photodiodes, and every target at every shift.
    let mut columns: Vec<Column> = vec![vec![1.0; moments]];
    let places =
        |shift: f64| -> Vec<Between> { Between::rows(&times, (0..moments).map(|k| moment(k) + shift)).collect() };
    let sampled = |places: &[Between], of: &Array2<f64>, column: usize| -> Column {
        places.iter().map(|place| place.value(|row| of[[rows.start + row, column]])).collect()
    };
    let recorded = places(0.0);
    columns.extend((0..inputs).map(|input| sampled(&recorded, data.x(), input)));
    for &shift in &shifts {
        let shifted = places(shift);
        columns.extend((0..data.targets().len()).map(|target| sampled(&shifted, data.y(), target)));
    }
    triangulate(&mut columns, 1 + inputs);
    // The first reflection takes the mean away, the others what photodiodes explain.
    let squares = |column: &Column, from: usize| dot(&column[from..], &column[from..]);
    let unexplained: Vec<f64> = columns[1 + inputs..]
        .chunks(data.targets().len())
        .map(|targets| {
            let shares = targets.iter().map(|target| {
                let (all, about_mean) = (squares(target, 0), squares(target, 1));
                if about_mean > STILL * all { squares(target, 1 + inputs) / about_mean } else { f64::NAN }
            });
            shares.sum::<f64>() / targets.len() as f64
        })
        .collect();
    if unexplained.iter().any(|share| share.is_nan()) {
        return None;
    }
    // A movement that repeats fits nearly as well a period away.
    let least = unexplained.iter().copied().fold(f64::INFINITY, f64::min);
    let near = |k: &usize| unexplained[k.saturating_sub(1)..unexplained.len().min(k + 2)].iter();
    let is_low = |k: &usize| unexplained[*k] <= PERIODS * least && near(k).all(|other| unexplained[*k] <= *other);
    let best = (0..shifts.len()).filter(is_low).min_by(|&a, &b| shifts[a].abs().total_cmp(&shifts[b].abs()))?;
    Some(Delay { by_s: shifts[best], recorded: unexplained[STEPS as usize], without: unexplained[best] })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A movement that never repeats.
    fn moved(t: f64) -> [f64; 2] {
        [(0.9 * t).sin() + (0.37 * t + 1.0).sin(), (0.53 * t).cos() + 0.5 * (1.31 * t).sin()]
    }

    /// Of `seconds` at 25 rows a second: photodiodes that answer 0.2 s late to targets that are measured `late` s late.
    fn recorded(seconds: usize, late: f64) -> Dataset {
        let rows = 25 * seconds;
        let time = |row: usize| 0.04 * row as f64;
        let x = Array2::from_shape_fn((rows, 3), |(row, input)| {
            let [a, b] = moved(time(row) - 0.2);
            [2.0 + 0.1 * a, 1.0 - 0.2 * b, 3.0 + 0.1 * (a - b)][input] + 0.01 * ((row * (7 + input)) % 5) as f64
        });
        let y = Array2::from_shape_fn((rows, 2), |(row, target)| moved(time(row) - late)[target]);
        let names = |all: &[&str]| all.iter().map(|&name| name.to_owned()).collect();
        Dataset::plain(names(&["P1", "P2", "P3"]), names(&["Fx_N", "Fz_N"]), x, y, 0.04).unwrap()
    }

    #[test]
    fn a_delay_is_found_to_a_tenth_of_a_second() {
        for late in [0.0, 0.2, 1.0, 3.4, -1.6, -4.0] {
            let found = delays(&recorded(60, late))[0].unwrap();
            assert!((found.by_s - (late - 0.2)).abs() <= 0.1 + 1e-9, "{late}: {found:?}");
            assert!(found.without < 0.03 && found.without <= found.recorded, "{late}: {found:?}");
        }
    }

    #[test]
    fn of_a_movement_that_repeats_the_shortest_delay_is_found() {
        let data = recorded(60, 0.0);
        let swing = |t: f64| (std::f64::consts::TAU * t / 4.0).sin();
        let time = |row: usize| 0.04 * row as f64;
        // The later, the more alike are two swings: the last period within reach fits best.
        let grown = |t: f64| swing(t) * (1.0 + 0.002 * t);
        let x = Array2::from_shape_fn((data.rows(), 3), |(row, input)| match input {
            0 => swing(time(row) - 0.2),
            k => 0.01 * ((row * (7 + k)) % 5) as f64,
        });
        let y = Array2::from_shape_fn((data.rows(), 1), |(row, _)| grown(time(row) - 1.0));
        let names = |all: &[&str]| all.iter().map(|&name| name.to_owned()).collect();
        let data = Dataset::plain(names(&["P1", "P2", "P3"]), names(&["J2_deg"]), x, y, 0.04).unwrap();
        let found = delays(&data)[0].unwrap();
        assert!((found.by_s - 0.8).abs() <= 0.1 + 1e-9, "{found:?}");
    }

    #[test]
    fn what_cannot_be_known_is_missing() {
        assert_eq!(delays(&recorded(3, 1.0)), [None], "75 rows for four unknowns");
        let data = recorded(60, 1.0);
        let with = |time_s: Vec<f64>, y: Array2<f64>| {
            let recordings = data.recordings().to_vec();
            Dataset::new(data.inputs().to_vec(), data.targets().to_vec(), time_s, data.x().clone(), y, recordings)
        };
        let still = with(data.time_s().to_vec(), Array2::from_elem(data.y().dim(), 0.1)).unwrap();
        let untimed = with(vec![f64::NAN; data.rows()], data.y().clone()).unwrap();
        let at_once = with(vec![7.0; data.rows()], data.y().clone()).unwrap();
        for missing in [still, untimed, at_once] {
            assert_eq!(delays(&missing), [None]);
        }
    }
}
