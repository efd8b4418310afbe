//! The linear model of some columns of a small triangle: Householder's QR with column pivoting (Golub and Van Loan,
//! Matrix Computations, 4th edition, 5.4.2).
//!
//! Rank: as least squares decides it, each column measured by how much of it may be rounding.

use crate::algebra::small::{back, norm, pivot, triangulate};

/// What came of some columns.
pub(super) struct Solved {
    /// The columns in the order in which they were taken; those after the first `rank` depend on these.
    pub(super) order: Vec<usize>,
    /// How many of them are independent.
    pub(super) rank: usize,
    /// Where all are: a coefficient a column, for each target.
    pub(super) coefficients: Vec<Vec<f64>>,
    /// Where all are: the norm of what is left of each target.
    pub(super) left: Vec<f64>,
}

/// Solves for each of `targets` in terms of `columns`, all of one length and norms near 1. `limits`: how long a part of
/// each may be rounding.
pub(super) fn solve(columns: &[&[f64]], targets: &[&[f64]], limits: &[f64]) -> Solved {
    let count = columns.len();
    let mut pivoted: Vec<Vec<f64>> = columns.iter().map(|column| column.to_vec()).collect();
    let (order, rank) = pivot(&mut pivoted, limits);
    let mut solved = Solved { order, rank, coefficients: Vec::new(), left: Vec::new() };
    if rank < count {
        return solved;
    }
    let mut all: Vec<Vec<f64>> = solved.order.iter().map(|&k| columns[k].to_vec()).collect();
    all.extend(targets.iter().map(|target| target.to_vec()));
    triangulate(&mut all, count);
    let (triangle, targets) = all.split_at(count);
    for target in targets {
        let mut coefficients = vec![0.0; count];
        solved.order.iter().zip(back(triangle, target)).for_each(|(&column, value)| coefficients[column] = value);
        solved.coefficients.push(coefficients);
        solved.left.push(norm(&target[count..]));
    }
    solved
}
