//! The lag to a fraction of an interval, how surely, and whether another peak might be the right one.
//!
//! Both sides are looked at at the times of the sparser; the denser one's means over an interval of the sparser are
//! taken there. Drift is taken off what overlaps. The sums of the regression are kept in blocks of time: blocks drawn
//! with replacement give other peaks, whose scatter is the standard error and which vote for the peak (block
//! bootstrap).

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::basis::Model;
use super::drift::Drift;
use super::line::Sums;
use super::memory::Judge;
use super::series::Series;

/// Draws of blocks.
const DRAWN: usize = 200;
/// Rows that are looked at.
const MOST_ROWS: usize = 20_000;
/// Lags that are looked at, for a step of the coarse grid.
const FINER: usize = 12;
/// Half of the lags that a parabola is laid through.
const ARM: usize = 3;
/// How often the middle goes on to a peak that lies beyond what is looked at.
const CLIMBS: usize = 12;

/// What is compared.
#[derive(Clone, Copy)]
pub(super) struct Pair<'a> {
    pub(super) video: &'a Series,
    pub(super) log: &'a Series,
    /// Length of the blocks, seconds.
    pub(super) block_s: f64,
    pub(super) seed: u64,
}

/// Where a peak is looked for, and by what.
#[derive(Clone, Copy)]
pub(super) struct Spot<'a> {
    /// Log time less video time, seconds.
    pub(super) offset_s: f64,
    pub(super) model: &'a Model,
    pub(super) judge: Judge,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    /// Which of the spots it was found from.
    pub(super) spot: usize,
    /// Log time less video time, seconds.
    pub(super) offset_s: f64,
    pub(super) offset_sd_s: f64,
    /// See [`super::line::left`].
    pub(super) left: f64,
    /// How much overlaps, seconds.
    pub(super) overlap_s: f64,
    /// See [`Judge::gain`].
    pub(super) gain: f64,
    /// Share of the draws in which it is the highest.
    pub(super) votes: f64,
}

/// What is left over at one lag, over what overlaps.
#[derive(Debug, Clone, Copy)]
struct At {
    left: f64,
    overlap_s: f64,
    gain: f64,
}

/// Sums of each block at each lag around a spot.
type Curve = Vec<Vec<Sums>>;

/// Looks closely around each of `spots`, `around_s` to both sides and on to where it rises, but not beyond `range_s`.
pub(super) fn peaks(pair: Pair<'_>, spots: &[Spot<'_>], around_s: f64, range_s: [f64; 2]) -> Vec<Peak> {
    let half = 3 * FINER / 2;
    let step_s = around_s / half as f64;
    let blocks = (pair.video.span_s() / pair.block_s).ceil().max(1.0) as usize;
    let all: Vec<usize> = (0..blocks).collect();
    let row_s = pair.video.interval_s.max(pair.log.interval_s) * stride(&pair) as f64;
    let peak = |curve: &Curve, spot: &Spot<'_>, drawn: &[usize]| {
        let mut sums = Sums::new(spot.model.columns(), pair.log.columns.len());
        let at = |blocks: &Vec<Sums>| {
            sums.clear();
            drawn.iter().for_each(|&block| sums.add(&blocks[block]));
            let (left, overlap_s) = (sums.left(), row_s * sums.count());
            At { left, overlap_s, gain: spot.judge.gain(overlap_s, left) }
        };
        top(&curve.iter().map(at).collect::<Vec<At>>())
    };
    let climb = |spot: &Spot<'_>| {
        let mut middle_s = spot.offset_s;
        let mut curve = Curve::new();
        for _ in 0..CLIMBS {
            let at = |k| in_blocks(pair, spot.model, middle_s + step_s * (k as f64 - half as f64), blocks);
            curve = (0..=2 * half).into_par_iter().map(at).collect();
            let place = peak(&curve, spot, &all).0;
            let next_s = (middle_s + step_s * (place - half as f64)).clamp(range_s[0], range_s[1]);
            let inside = place > ARM as f64 && place < (2 * half - ARM) as f64;
            if inside || (next_s - middle_s).abs() < step_s {
                break;
            }
            middle_s = next_s;
        }
        (middle_s, curve)
    };
    let curves: Vec<(f64, Curve)> = spots.iter().map(climb).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(pair.seed);
    let draws: Vec<Vec<usize>> =
        (0..DRAWN).map(|_| (0..blocks).map(|_| rng.random_range(0..blocks)).collect()).collect();
    let tops = |draw: &Vec<usize>| {
        curves.iter().zip(spots).map(|((_, curve), spot)| peak(curve, spot, draw)).collect::<Vec<(f64, At)>>()
    };
    let drawn: Vec<Vec<(f64, At)>> = draws.par_iter().map(tops).collect();
    let best = |tops: &Vec<(f64, At)>| {
        (0..tops.len()).max_by(|&a, &b| tops[a].1.gain.total_cmp(&tops[b].1.gain).then(b.cmp(&a))).unwrap_or(0)
    };
    let votes: Vec<usize> = drawn.iter().map(best).collect();
    (0..curves.len())
        .map(|k| {
            let (middle_s, curve) = &curves[k];
            let (place, at) = peak(curve, &spots[k], &all);
            let squares: f64 = drawn.iter().map(|tops| (tops[k].0 - place).powi(2)).sum();
            Peak {
                spot: k,
                offset_s: middle_s + step_s * (place - half as f64),
                offset_sd_s: step_s * (squares / DRAWN as f64).sqrt(),
                left: at.left,
                overlap_s: at.overlap_s,
                gain: at.gain,
                votes: votes.iter().filter(|&&vote| vote == k).count() as f64 / DRAWN as f64,
            }
        })
        .collect()
}

/// Every so many rows of the sparser side are looked at.
fn stride(pair: &Pair<'_>) -> usize {
    let sparse = if pair.video.interval_s >= pair.log.interval_s { pair.video } else { pair.log };
    sparse.time_s.len().div_ceil(MOST_ROWS)
}

/// The sums at one offset, for each block of the video's time.
fn in_blocks(pair: Pair<'_>, model: &Model, offset_s: f64, blocks: usize) -> Vec<Sums> {
    let Pair { video, log, .. } = pair;
    let row = |series: &Series, k: usize| series.columns.iter().map(|column| column[k]).collect::<Vec<f64>>();
    let video_is_sparser = video.interval_s >= log.interval_s;
    let (sparse, dense, shift_s) = if video_is_sparser { (video, log, offset_s) } else { (log, video, -offset_s) };
    let rows: Vec<usize> = (0..sparse.time_s.len()).step_by(stride(&pair)).collect();
    let width_s = if dense.interval_s < 0.75 * sparse.interval_s { sparse.interval_s } else { 0.0 };
    let (p, q) = (model.columns(), log.columns.len());
    let mut columns = vec![Vec::with_capacity(rows.len()); p + q];
    let mut time_s = Vec::with_capacity(rows.len());
    let mut both = Vec::with_capacity(p + q);
    dense.means(rows.iter().map(|&k| sparse.time_s[k] + shift_s), width_s, |k, means| {
        let Some(means) = means else { return };
        let own = row(sparse, rows[k]);
        let at_s = sparse.time_s[rows[k]];
        let (x, y) = if video_is_sparser { (own.as_slice(), means) } else { (means, own.as_slice()) };
        time_s.push(if video_is_sparser { at_s } else { at_s + shift_s });
        both.clear();
        model.row(x, &mut both);
        both.extend_from_slice(y);
        columns.iter_mut().zip(&both).for_each(|(column, v)| column.push(*v));
    });
    let drift = Drift::new(&time_s);
    columns.iter_mut().for_each(|column| drift.take_off(column));
    let mut sums = vec![Sums::new(p, q); blocks];
    for (k, at_s) in time_s.iter().enumerate() {
        let block = (((at_s - video.first_s()) / pair.block_s) as usize).min(blocks - 1);
        both.clear();
        both.extend(columns.iter().map(|column| column[k]));
        sums[block].add_row(&both[..p], &both[p..]);
    }
    sums
}

/// The top of a curve, by a parabola through the highest and its neighbours: its place, and what is there.
fn top(curve: &[At]) -> (f64, At) {
    let gains: Vec<f64> = curve.iter().map(|at| at.gain).collect();
    let highest = (0..gains.len()).max_by(|&a, &b| gains[a].total_cmp(&gains[b]).then(b.cmp(&a))).unwrap_or(0);
    let arm = ARM.min(highest).min(gains.len() - 1 - highest);
    let mut place = highest as f64;
    if arm > 0 {
        // Least squares of a parabola on -arm..=arm.
        let [mut slope, mut bend, mut squares, mut fourths, mut sum] = [0.0; 5];
        for k in 0..=2 * arm {
            let x = k as f64 - arm as f64;
            let y = gains[highest + k - arm] - gains[highest];
            slope += x * y;
            bend += x * x * y;
            sum += y;
            squares += x * x;
            fourths += x.powi(4);
        }
        let n = (2 * arm + 1) as f64;
        let curvature = (bend - squares * sum / n) / (fourths - squares * squares / n);
        if curvature < 0.0 {
            place += (-0.5 * slope / squares / curvature).clamp(-(arm as f64), arm as f64);
        }
    }
    (place, curve[highest])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_of_a_parabola_is_found() {
        let at = |k: u32| At { left: 0.0, overlap_s: 1.0, gain: 5.0 - (f64::from(k) - 6.3).powi(2) };
        let (place, _) = top(&(0..15).map(at).collect::<Vec<At>>());
        assert!((place - 6.3).abs() < 1e-6, "{place}");
    }
}
