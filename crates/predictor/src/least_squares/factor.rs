//! The triangle's columns, and the factors of their normal equations.

use std::ops::Range;

use ndarray::Array2;

use super::Deficient;
use super::problem::Problem;
use crate::algebra::scale::{exponent, ldexp};
use crate::algebra::small::{Column, back, dot, orthonormal, triangulate};

/// What the triangle of [ones, columns, targets] reveals about the columns, each scaled by a power of two to a length
/// in [0.5, 1).
pub(super) struct Centred {
    /// Exponents taken out.
    pub(super) exponents: Vec<i32>,
    /// Lengths after that.
    pub(super) lengths: Vec<f64>,
    /// Lengths below which a column is nothing but rounding.
    pub(super) limits: Vec<f64>,
    /// Ones' part of each column, and of ones themselves.
    pub(super) ones: Vec<f64>,
    pub(super) first: f64,
    pub(super) columns: Vec<Column>,
}

/// A basis of the coefficients' space with the triangle that belongs to it.
pub(super) struct Factor {
    /// Coefficients of all columns, for each unknown.
    pub(super) basis: Vec<Column>,
    /// Triangle of the unknowns.
    pub(super) f: Vec<Column>,
    /// Ones' part of each unknown.
    pub(super) ones: Vec<f64>,
    /// Right-hand sides, a target each.
    pub(super) sides: Vec<Column>,
}

pub(super) fn part(r: &Array2<f64>, rows: Range<usize>, column: usize) -> Column {
    rows.map(|i| r[[i, column]]).collect()
}

impl Centred {
    pub(super) fn new(problem: &Problem<'_>, r: &Array2<f64>) -> Self {
        let count = problem.columns;
        let rounding = rounding(problem.rows);
        let mut out = Self {
            exponents: Vec::new(),
            lengths: Vec::new(),
            limits: Vec::new(),
            ones: Vec::new(),
            first: r[[0, 0]],
            columns: Vec::new(),
        };
        for j in 0..count {
            let mut column = part(r, 1..1 + count, 1 + j);
            let e = exponent(dot(&column, &column).sqrt());
            column.iter_mut().for_each(|value| *value = ldexp(*value, -e));
            out.exponents.push(e);
            out.lengths.push(dot(&column, &column).sqrt());
            out.limits.push(ldexp(rounding * problem.rough[j], -e));
            out.ones.push(ldexp(r[[0, 1 + j]], -e));
            out.columns.push(column);
        }
        out
    }

    pub(super) fn constant(&self, j: usize) -> bool {
        self.lengths[j] <= self.limits[j]
    }
}

/// What rounding does to the norm of a column of so many rows, relative to its largest value: to the values, and in as
/// many blocks as are folded one into the other.
pub(crate) fn rounding(rows: usize) -> f64 {
    (rows as f64).sqrt() * f64::EPSILON * (8.0 + (rows as f64 / 64.0).sqrt())
}

impl Factor {
    pub(super) fn new(
        centred: &Centred,
        pivoted: &[Column],
        taken: &[usize],
        sides: &[Column],
        how: Deficient,
    ) -> Self {
        let count = centred.columns.len();
        let axis = |j: usize| (0..count).map(|i| f64::from(u8::from(i == j))).collect::<Column>();
        let basis: Vec<Column> = match how {
            Deficient::MinimumNorm if taken.len() < count => minimum_norm(centred, pivoted, taken),
            Deficient::Ridge(_) => (0..count).filter(|&j| !centred.constant(j)).map(axis).collect(),
            _ => taken.iter().map(|&j| axis(j)).collect(),
        };
        let lambda = if let Deficient::Ridge(lambda) = how { lambda.sqrt() } else { 0.0 };
        let mut f: Vec<Column> = basis
            .iter()
            .map(|weights| {
                let mut column = vec![0.0; count];
                for (weight, from) in weights.iter().zip(&centred.columns).filter(|(weight, _)| **weight != 0.0) {
                    column.iter_mut().zip(from).for_each(|(value, from)| *value += weight * from);
                }
                if lambda > 0.0 {
                    column
                        .extend(weights.iter().zip(&centred.lengths).map(|(weight, length)| lambda * weight * length));
                }
                column
            })
            .collect();
        let unknowns = f.len();
        let height = if lambda > 0.0 { 2 * count } else { count };
        f.extend(sides.iter().map(|side| {
            let mut side = side.clone();
            side.resize(height, 0.0);
            side
        }));
        triangulate(&mut f, unknowns);
        let sides = f.split_off(unknowns);
        let ones = basis.iter().map(|weights| dot(weights, &centred.ones)).collect();
        Self { basis, f, ones, sides }
    }

    /// From ones' and the unknowns' right-hand sides to coefficients of ones and columns, in the problem's units.
    pub(super) fn step(&self, centred: &Centred, first: f64, side: &[f64]) -> Vec<f64> {
        let unknowns = back(&self.f, side);
        let mut out = vec![0.0; 1 + centred.columns.len()];
        out[0] = (first - dot(&self.ones, &unknowns)) / centred.first;
        for (weights, by) in self.basis.iter().zip(&unknowns) {
            out[1..].iter_mut().zip(weights).for_each(|(out, weight)| *out += weight * by);
        }
        out[1..].iter_mut().zip(&centred.exponents).for_each(|(out, &e)| *out = ldexp(*out, -e));
        out
    }
}

/// Coefficients that lie in the space of the rows, of columns over their lengths.
fn minimum_norm(centred: &Centred, pivoted: &[Column], taken: &[usize]) -> Vec<Column> {
    let count = centred.columns.len();
    let rank = taken.len();
    // Rows of the pivoted triangle, their columns back in order. Constant columns take no part.
    let mut order: Vec<usize> = taken.to_vec();
    order.extend((0..count).filter(|j| !taken.contains(j)));
    let rows: Vec<Column> = (0..rank)
        .map(|i| {
            let mut row = vec![0.0; count];
            for (place, &j) in order.iter().enumerate().filter(|(_, j)| !centred.constant(**j)) {
                row[j] = pivoted[place][i] / centred.lengths[j];
            }
            row
        })
        .collect();
    let mut basis = orthonormal(&rows);
    for vector in &mut basis {
        for (j, value) in vector.iter_mut().enumerate() {
            *value = if centred.constant(j) { 0.0 } else { *value / centred.lengths[j] };
        }
    }
    basis
}
