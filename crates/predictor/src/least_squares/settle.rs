//! The solution of the triangle, and its refinement.

use super::factor::{Centred, Factor};
use super::problem::Problem;
use super::refine::{Products, products};
use crate::algebra::exact::Long;
use crate::algebra::scale::ldexp;
use crate::algebra::small::{Column, dot, forward};

/// A step of refinement that moves no coefficient by more than this share: the next would move them by its square,
/// 2^-52.
const SETTLED: f64 = 1.0 / 67_108_864.0;

/// Coefficients in the problem's units (ones first) with the sums of squares of their residuals.
pub(super) struct Solution {
    pub(super) coefficients: Vec<Vec<Long>>,
    pub(super) squares: Vec<f64>,
    pub(super) refined: usize,
}

pub(super) fn settle(
    problem: &Problem<'_>,
    centred: &Centred,
    factor: &Factor,
    ridge: f64,
    first: &[f64],
    left: Vec<f64>,
    refinements: usize,
) -> Solution {
    let count = problem.columns;
    let unknowns = factor.f.len();
    let mut solution = Solution {
        coefficients: vec![vec![Long::ZERO; 1 + count]; problem.targets],
        squares: left
            .iter()
            .zip(&factor.sides)
            .map(|(left, side)| left + dot(&side[unknowns..], &side[unknowns..]))
            .collect(),
        refined: 0,
    };
    for (k, side) in factor.sides.iter().enumerate() {
        let step = factor.step(centred, first[k], &side[..unknowns]);
        add(&mut solution.coefficients[k], &step);
    }
    let mut sizes = vec![f64::INFINITY; problem.targets];
    for _ in 0..refinements {
        let mut settled = true;
        let products = products(problem, &solution.coefficients);
        for (k, Products { gradient, squares }) in products.into_iter().enumerate() {
            let x = &mut solution.coefficients[k];
            let pulled: Column = (0..count)
                .map(|j| {
                    let size = ldexp(x[1 + j].rounded(), centred.exponents[j]);
                    ldexp(gradient[1 + j].rounded(), -centred.exponents[j]) - ridge * centred.lengths[j].powi(2) * size
                })
                .collect();
            let top = gradient[0].rounded() / centred.first;
            let side: Column = factor
                .basis
                .iter()
                .zip(&factor.ones)
                .map(|(weights, ones)| dot(weights, &pulled) - ones * top)
                .collect();
            let side = forward(&factor.f, &side);
            let step = factor.step(centred, top, &side);
            // A step that is not much smaller than the one before is rounding.
            let size =
                step[1..].iter().zip(&centred.exponents).fold(0.0, |most: f64, (d, &e)| most.max(ldexp(d.abs(), e)));
            if size > 0.5 * sizes[k] {
                solution.squares[k] = squares;
                continue;
            }
            sizes[k] = size;
            let largest = (0..count).fold(0.0, |most: f64, j| most.max(ldexp(x[1 + j].0.abs(), centred.exponents[j])));
            settled &= (0..count).all(|j| {
                let floor = ldexp(SETTLED * largest, -centred.exponents[j]);
                step[1 + j].abs() <= SETTLED * x[1 + j].0.abs().max(floor)
            });
            add(x, &step);
            solution.squares[k] =
                if ridge > 0.0 { squares } else { (squares - dot(&side, &side) - top * top).max(0.0) };
        }
        solution.refined += 1;
        if settled {
            break;
        }
    }
    solution
}

fn add(x: &mut [Long], step: &[f64]) {
    x.iter_mut().zip(step).for_each(|(x, &d)| *x = x.plus(d.into()));
}
