//! Which recordings follow the same prompted path.
//!
//! In: a [`Dataset`]. Out: of each recording the first that follows the same path. A recording held out leaks nearly as
//! much as shuffled rows where one trained on repeats its path: the model has seen every force in its place.
//!
//! Two recordings follow the same path where their targets, evenly sampled in time and over the SD that each target has
//! in all rows, correlate at [`ALIKE`] or more with one shifted in time against the other; the shorter lies within the
//! longer for [`SHARED`] of its time at least.

use std::ops::Range;

use ndarray::Axis;

use crate::Dataset;

/// From this correlation on two recordings follow one path; assumed: a person follows a prompt at 0.97 and more.
const ALIKE: f64 = 0.95;
/// The part of the shorter one's time that has to be shared; assumed.
const SHARED: f64 = 0.8;
/// Less variance than this, over that of all rows, is no path; assumed.
const STILL: f64 = 1e-6;
/// Samples of the shorter one.
const SAMPLES: usize = 96;
/// Samples of the longer one at most.
const MOST: usize = 1920;

/// Of each recording the first that follows its path; itself where none before does.
#[must_use]
pub fn paths(data: &Dataset) -> Vec<usize> {
    let spread: Vec<f64> = data.y().axis_iter(Axis(1)).map(|column| column.std(0.0)).collect();
    let recordings = data.recordings();
    let mut first: Vec<usize> = (0..recordings.len()).collect();
    for b in 1..recordings.len() {
        let same = (0..b).find(|&a| {
            first[a] == a && follow_one_path([data; 2], [&recordings[a].rows, &recordings[b].rows], &spread)
        });
        first[b] = same.unwrap_or(b);
    }
    first
}

/// Recordings of a test that repeat the path of one trained on: test's and training's places.
///
/// # Panics
/// Where the sets have other targets than each other.
#[must_use]
pub fn repeated_paths(train: &Dataset, test: &Dataset) -> Vec<(usize, usize)> {
    assert_eq!(train.targets(), test.targets(), "sets of the same targets");
    let spread: Vec<f64> = train.y().axis_iter(Axis(1)).map(|column| column.std(0.0)).collect();
    let of = |b: usize| {
        let same = |a: &usize| {
            follow_one_path([train, test], [&train.recordings()[*a].rows, &test.recordings()[b].rows], &spread)
        };
        (0..train.recordings().len()).find(same).map(|a| (b, a))
    };
    (0..test.recordings().len()).filter_map(of).collect()
}

fn follow_one_path(data: [&Dataset; 2], rows: [&Range<usize>; 2], spread: &[f64]) -> bool {
    let lasts = [0, 1].map(|k| {
        let last = times(data[k], rows[k]).last().copied().unwrap_or(0.0);
        if rows[k].len() > 2 { last } else { 0.0 }
    });
    if lasts.iter().any(|last| *last <= 0.0) {
        return false;
    }
    let step = lasts[0].min(lasts[1]) / (SAMPLES - 1) as f64;
    let [short, long] = if lasts[0] <= lasts[1] { [0, 1] } else { [1, 0] };
    let (short, long) =
        (sampled(data[short], rows[short], step, spread), sampled(data[long], rows[long], step, spread));
    let least = (SHARED * short.len() as f64) as isize;
    let shifts = least - short.len() as isize..=long.len() as isize - least;
    shifts.into_iter().any(|shift| {
        let from = 0.max(-shift) as usize;
        let to = (short.len() as isize).min(long.len() as isize - shift).max(0) as usize;
        from < to && correlation(&short[from..to], &long[(from as isize + shift) as usize..]) >= ALIKE
    })
}

/// Seconds since a recording's first row; none where they are not known or do not ascend.
pub(super) fn seconds(data: &Dataset, rows: &Range<usize>) -> Option<Vec<f64>> {
    let all = &data.time_s()[rows.clone()];
    let ascending = all.windows(2).all(|pair| pair[0] <= pair[1]);
    (ascending && all.iter().all(|time| time.is_finite())).then(|| all.iter().map(|time| time - all[0]).collect())
}

/// A moment between two rows: the second of them, and how far it is on the way there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Between {
    next: usize,
    share: f64,
}

impl Between {
    /// Of moments that ascend, in a recording of two rows or more.
    pub(super) fn rows<'a>(
        times: &'a [f64],
        moments: impl Iterator<Item = f64> + 'a,
    ) -> impl Iterator<Item = Self> + 'a {
        let mut next = 1;
        moments.map(move |moment| {
            next += times[next..times.len() - 1].iter().take_while(|time| **time < moment).count();
            let gap = times[next] - times[next - 1];
            Self { next, share: if gap > 0.0 { ((moment - times[next - 1]) / gap).min(1.0) } else { 0.0 } }
        })
    }

    /// What a column has there.
    pub(super) fn value(self, of: impl Fn(usize) -> f64) -> f64 {
        let [low, high] = [self.next - 1, self.next].map(of);
        low + self.share * (high - low)
    }
}

/// Seconds since a recording's first row; numbers of rows where they are not known.
fn times(data: &Dataset, rows: &Range<usize>) -> Vec<f64> {
    seconds(data, rows).unwrap_or_else(|| (0..rows.len()).map(|k| k as f64).collect())
}

/// Targets at even times, linear in between, each over its spread; 0 of a target that does not change.
fn sampled(data: &Dataset, rows: &Range<usize>, step: f64, spread: &[f64]) -> Vec<Vec<f64>> {
    let times = times(data, rows);
    let last = times[times.len() - 1];
    let count = ((last / step + 1e-9) as usize + 1).min(MOST);
    let moments = (0..count).map(|k| k as f64 * step);
    let row = |at: Between| {
        let value = |(target, spread): (usize, &f64)| {
            let own = at.value(|row| data.y()[[rows.start + row, target]]);
            if *spread > 0.0 { own / spread } else { 0.0 }
        };
        spread.iter().enumerate().map(value).collect()
    };
    Between::rows(&times, moments).map(row).collect()
}

/// Of all targets together, each about its own mean; 0 where nothing moves.
fn correlation(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let count = a.len();
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for target in 0..a.first().map_or(0, Vec::len) {
        let mean = |all: &[Vec<f64>]| all[..count].iter().map(|row| row[target]).sum::<f64>() / count as f64;
        let (a_mean, b_mean) = (mean(a), mean(b));
        for (a, b) in a.iter().zip(b) {
            let (a, b) = (a[target] - a_mean, b[target] - b_mean);
            (ab, aa, bb) = (ab + a * b, aa + a * a, bb + b * b);
        }
    }
    if aa.min(bb) > STILL * count as f64 { ab / (aa.sqrt() * bb.sqrt()) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Recording;
    use ndarray::Array2;

    type Forces<'a> = &'a dyn Fn(f64) -> [f64; 3];

    fn set(all: &[(usize, Forces<'_>)]) -> Dataset {
        let n: usize = all.iter().map(|one| one.0).sum();
        let (mut y, mut time, mut recordings) = (Array2::zeros((n, 3)), Vec::new(), Vec::new());
        let mut start = 0;
        for (rows, path) in all {
            for k in 0..*rows {
                let t = 0.04 * k as f64;
                (0..3).for_each(|target| y[[start + k, target]] = path(t)[target]);
                time.push(t);
            }
            recordings.push(Recording::of(format!("r{}", recordings.len()), start..start + rows));
            start += rows;
        }
        let names = ["Fx_N", "Fy_N", "Fz_N"].map(str::to_owned).to_vec();
        Dataset::new(vec!["P1".into()], names, time, Array2::zeros((n, 1)), y, recordings).unwrap()
    }

    fn spiral(t: f64) -> [f64; 3] {
        let r = 0.1 * t;
        [r * (2.1 * t).sin(), r * (2.1 * t).cos(), -2.0 - 0.05 * t]
    }

    #[test]
    fn a_repeated_prompt_is_found_and_others_are_not() {
        // Followed late and inexactly, as a person does; shorter; another path in the same range of forces.
        let late = |t: f64| spiral((t - 1.3).max(0.0)).map(|f| f + 0.15 * (7.7 * t).sin());
        let short = |t: f64| spiral(t + 8.0);
        let other = |t: f64| [(0.7 * t).sin(), (1.9 * t).sin() * (0.3 * t).cos(), -2.5 + (1.1 * t).sin()];
        let back = |t: f64| spiral(40.0 - t);
        let data = set(&[(1000, &spiral), (1000, &late), (600, &short), (1000, &other), (1000, &back)]);
        assert_eq!(paths(&data), [0, 0, 0, 3, 4]);
    }

    #[test]
    fn targets_that_do_not_change_and_short_recordings_are_no_path() {
        let still = |_: f64| [0.0, 0.0, -1.0];
        let data = set(&[(100, &still), (100, &still), (1, &spiral), (2, &spiral)]);
        assert_eq!(paths(&data), [0, 1, 2, 3]);
    }
}
