//! A nail's picture in sixteen blocks, so that files of cells are compared as those of photodiodes are.
//!
//! In: a [`Dataset`] of cells. Out: the same moments with the averages of 4 x 4 blocks of the cells on the nail, and
//! the orders in which the blocks of a mirrored or turned picture come. A block counts where its mirror
//! images lie on the nail as well; a moment, where all their cells are known.
//!
//! Of 16 blocks a linear model leaves 0.03 to 0.44 of the forces' variance in other recordings unexplained where 16
//! modes of all 256 cells leave 0.02 to 0.42 (six phantom nail videos of one person, nine pairs of parts): little is
//! lost, there are no modes to work out, and a picture turned over is its blocks in another order. Of 36 files changed
//! beside one to three others of the person (mirrored, turned, two forces exchanged, one negated) 30 are named, of 6
//! with a doubled force one, none by another name; of 106 sets of two to six files of seven persons as they are none.

use std::cmp::Ordering;
use std::ops::Range;

use lunula_predictor::Dataset;
use ndarray::{Array2, Axis};

use super::columns::cell;

const SIDE: usize = 4;
/// The share of each recording's rows in which a cell on the nail is known, at least (assumed).
const KNOWN: f64 = 0.5;

/// What a picture drawn or filmed the other way round is, by its orders.
pub(super) const TURNED: [&str; 3] = ["mirrored left to right", "mirrored from tip to base", "turned by 180 degrees"];

/// The block of a row or column of cells, of so many; alike from both ends, so that the middle one is in none.
fn along(k: usize, of: usize) -> Option<usize> {
    match (2 * k + 1).cmp(&of) {
        Ordering::Less => Some(k * SIDE / of),
        Ordering::Equal => None,
        Ordering::Greater => Some(SIDE - 1 - (of - 1 - k) * SIDE / of),
    }
}

/// Blocks of a dataset.
pub(super) struct Blocks {
    pub(super) data: Dataset,
    rows: Vec<usize>,
    /// Of each of [`TURNED`], which block comes in each one's place.
    pub(super) orders: [Vec<usize>; 3],
}

impl Blocks {
    /// None where no input is a cell, or no moments are left.
    pub(super) fn of(data: &Dataset) -> Option<Self> {
        let rows = data.rows();
        let is_known = |k: usize| {
            let column = data.x().column(k);
            data.recordings().iter().all(|one| {
                let known = one.rows.clone().filter(|&row| !column[row].is_nan()).count();
                known as f64 >= KNOWN * one.rows.len() as f64
            })
        };
        let places = data.inputs().iter().enumerate().filter_map(|(k, name)| Some((k, cell(name)?)));
        let cells: Vec<(usize, [usize; 2])> = places.filter(|(k, _)| is_known(*k)).collect();
        let side = |axis: usize| -> Option<Range<usize>> {
            let all = || cells.iter().map(|(_, at)| at[axis]);
            Some(all().min()?..all().max()? + 1)
        };
        let sides = [side(0)?, side(1)?];
        let block = |at: &[usize; 2]| {
            let [row, column] = [0, 1].map(|k| along(at[k] - sides[k].start, sides[k].len()));
            Some(row? * SIDE + column?)
        };
        let mut within = vec![Vec::new(); SIDE * SIDE];
        for (k, at) in &cells {
            if let Some(block) = block(at) {
                within[block].push(*k);
            }
        }
        let turned = |block: usize| {
            let [row, column] = [block / SIDE, block % SIDE];
            let [up, left] = [SIDE - 1 - row, SIDE - 1 - column];
            [row * SIDE + left, up * SIDE + column, up * SIDE + left]
        };
        let on_nail = |block: usize| !within[block].is_empty();
        let kept: Vec<usize> =
            (0..SIDE * SIDE).filter(|&block| on_nail(block) && turned(block).into_iter().all(on_nail)).collect();
        let place = |block: usize| kept.iter().position(|&other| other == block).expect("a block's mirror image");
        let orders = [0, 1, 2].map(|how| kept.iter().map(|&block| place(turned(block)[how])).collect());
        let mean = |row: usize, block: usize| {
            let cells = &within[block];
            cells.iter().map(|&k| data.x()[[row, k]]).sum::<f64>() / cells.len() as f64
        };
        let all = Array2::from_shape_fn((rows, kept.len()), |(row, k)| mean(row, kept[k]));
        let whole: Vec<usize> =
            all.outer_iter().enumerate().filter(|(_, row)| row.iter().all(|v| v.is_finite())).map(|(k, _)| k).collect();
        let name = |&block: &usize| {
            let name = |k: Option<&usize>| k.map_or("", |&k| data.inputs()[k].as_str());
            format!("{} to {}", name(within[block].first()), name(within[block].last()))
        };
        let some = data.only_rows(&whole);
        let data = Dataset::new(
            kept.iter().map(name).collect(),
            data.targets().to_vec(),
            some.time_s().to_vec(),
            all.select(Axis(0), &whole),
            some.y().clone(),
            some.recordings().to_vec(),
        );
        data.ok().filter(|data| data.rows() > 0).map(|data| Self { data, rows: whole, orders })
    }

    /// Where rows of the dataset are among the blocks'.
    pub(super) fn part(&self, rows: &Range<usize>) -> Range<usize> {
        let place = |row: usize| self.rows.partition_point(|&own| own < row);
        place(rows.start)..place(rows.end)
    }
}
