//! Tall matrices in blocks of [`BLOCK`] rows, column by column within a block: all that the factorization and the
//! refinement look at lies side by side in the first-level cache, in loops of fixed length. Rows that a last block
//! lacks are zeros, which change neither a sum nor a reflection.

use pulp::Simd;

use crate::algebra::exact::{Long, two_sum};

/// Rows of a block: 48 columns of it fit a first-level cache of 32 KiB.
pub(super) const BLOCK: usize = 64;

/// A column's part in one block.
pub(super) type Part = [f64; BLOCK];

/// Sums over rows are kept in so many lanes and added up in a fixed order, whatever the machine's width.
pub(super) const LANES: usize = 8;

/// A sum of twice the length, lane by lane: high parts, low parts.
pub(super) type Lanes = ([f64; LANES], [f64; LANES]);

/// Where a sum begins.
pub(super) const NOTHING: Lanes = ([0.0; LANES], [0.0; LANES]);

/// Copies rows `start ..` of a matrix in standard layout, `columns` wide, into the first parts; returns how many rows
/// there were.
#[inline(always)]
pub(super) fn transpose(from: &[f64], columns: usize, start: usize, into: &mut [Part]) -> usize {
    if columns == 0 {
        return 0;
    }
    let rest = &from[start * columns..];
    let rows = &rest[..rest.len().min(BLOCK * columns)];
    let count = rows.len() / columns;
    for (j, part) in into.iter_mut().enumerate().take(columns) {
        for (to, &value) in part.iter_mut().zip(rows[j..].iter().step_by(columns)) {
            *to = value;
        }
        part[count..].fill(0.0);
    }
    count
}

/// Adds a part's values.
#[inline(always)]
pub(super) fn add(sums: &mut Lanes, part: &Part) {
    for chunk in part.as_chunks::<LANES>().0 {
        for ((high, low), &value) in sums.0.iter_mut().zip(&mut sums.1).zip(chunk) {
            let (sum, error) = two_sum(*high, value);
            *high = sum;
            *low += error;
        }
    }
}

/// All lanes together.
pub(super) fn total(sums: &Lanes) -> Long {
    (0..LANES).fold(Long::ZERO, |sum, lane| sum.plus(Long::of(sums.0[lane], sums.1[lane])))
}

#[inline(always)]
pub(super) fn vectors<S: Simd>(part: &Part) -> &[S::f64s] {
    S::as_simd_f64s(part).0
}

/// How many of the machine's vectors hold [`LANES`] numbers.
pub(super) const fn registers<S: Simd>() -> usize {
    LANES / S::F64_LANES
}

/// The first [`registers`] vectors' numbers.
#[inline(always)]
pub(super) fn spill<S: Simd>(vectors: &[S::f64s; LANES]) -> [f64; LANES] {
    let mut out = [0.0; LANES];
    S::as_mut_simd_f64s(&mut out).0.copy_from_slice(&vectors[..registers::<S>()]);
    out
}
