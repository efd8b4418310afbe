//! Singular values and modes of a small dense matrix, as of a Jacobian (section 5.1.3, Fig. 98).
//!
//! In: a matrix, targets x inputs. Out: A = sum of sigma_k left_k right_k^T, largest sigma first. One-sided Jacobi
//! rotations (Hestenes 1958, doi:10.1137/0106005; Demmel and Veselic 1992, doi:10.1137/0613074), which keep small
//! singular values accurate where others lose them next to large ones.
//!
//! Signs, which a decomposition leaves open: the largest component of each left vector (the force or angle) is
//! positive, of equal ones the first.

use ndarray::{Array2, ArrayView2};

use super::scale::{exponent, ldexp};

/// A sweep that finds nothing more than this to rotate ends the work.
const ORTHOGONAL: f64 = f64::EPSILON;

/// Beyond this, z^2 + 1 is z^2 to the last bit.
const FAR: f64 = 1e100;

/// Sweeps needed are 4 to 10; this many means a NaN.
const SWEEPS: usize = 60;

/// Singular values with their vectors, as many as the shorter side of the matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// Singular values, descending, in the matrix' unit.
    pub sigma: Vec<f64>,
    /// targets x modes: columns of length 1.
    pub left: Array2<f64>,
    /// inputs x modes: columns of length 1.
    pub right: Array2<f64>,
}

/// The modes of a matrix, targets x inputs, of finite values. Where a singular value is zero its vectors are any that
/// are at right angles to the others, the same ones every time.
#[must_use]
pub fn modes(matrix: ArrayView2<'_, f64>) -> Modes {
    let (targets, inputs) = matrix.dim();
    let wide = targets <= inputs;
    let tall = if wide { matrix.t() } else { matrix };
    let e = exponent(tall.iter().fold(0.0, |most: f64, value| most.max(value.abs())));
    let mut columns: Vec<Vec<f64>> =
        tall.columns().into_iter().map(|column| column.iter().map(|&value| ldexp(value, -e)).collect()).collect();
    let mut turned: Vec<Vec<f64>> = (0..columns.len()).map(|k| unit(columns.len(), k)).collect();
    rotate(&mut columns, &mut turned);
    let lengths: Vec<f64> = columns.iter().map(|column| length(column)).collect();
    let mut order: Vec<usize> = (0..columns.len()).collect();
    order.sort_by(|&a, &b| lengths[b].total_cmp(&lengths[a]));
    // Of the long side: columns over their lengths, filled up where that is zero.
    let mut long: Vec<Vec<f64>> = Vec::new();
    for &k in &order {
        let vector = if lengths[k] > 0.0 {
            columns[k].iter().map(|value| value / lengths[k]).collect()
        } else {
            another(&long, tall.nrows())
        };
        long.push(vector);
    }
    let mut short: Vec<Vec<f64>> = order.iter().map(|&k| turned[k].clone()).collect();
    let (left, right) = if wide { (&mut short, &mut long) } else { (&mut long, &mut short) };
    for (left, right) in left.iter_mut().zip(right.iter_mut()) {
        if largest(left) < 0.0 {
            left.iter_mut().chain(right).for_each(|value| *value = -*value);
        }
    }
    let matrix =
        |rows: usize, columns: &[Vec<f64>]| Array2::from_shape_fn((rows, columns.len()), |(i, k)| columns[k][i]);
    Modes {
        sigma: order.iter().map(|&k| ldexp(lengths[k], e)).collect(),
        left: matrix(targets, left),
        right: matrix(inputs, right),
    }
}

/// Turns pairs of columns until all are at right angles; `turned` goes along.
fn rotate(columns: &mut [Vec<f64>], turned: &mut [Vec<f64>]) {
    for _ in 0..SWEEPS {
        let mut done = true;
        for q in 1..columns.len() {
            for p in 0..q {
                let (a, b) = pair(columns, p, q);
                let (pp, qq, pq) = (dot(a, a), dot(b, b), dot(a, b));
                if pq == 0.0 || pq.abs() <= ORTHOGONAL * (pp * qq).sqrt() {
                    continue;
                }
                done = false;
                let zeta = (qq - pp) / (2.0 * pq);
                // No `hypot`: it is not the same on every machine.
                let tangent = if zeta.abs() > FAR {
                    0.5 / zeta
                } else {
                    zeta.signum() / (zeta.abs() + (zeta * zeta + 1.0).sqrt())
                };
                let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
                turn(a, b, cosine, cosine * tangent);
                let (a, b) = pair(turned, p, q);
                turn(a, b, cosine, cosine * tangent);
            }
        }
        if done {
            return;
        }
    }
}

fn pair(columns: &mut [Vec<f64>], p: usize, q: usize) -> (&mut [f64], &mut [f64]) {
    let (head, tail) = columns.split_at_mut(q);
    (&mut head[p], &mut tail[0])
}

fn turn(a: &mut [f64], b: &mut [f64], cosine: f64, sine: f64) {
    for (a, b) in a.iter_mut().zip(b) {
        (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
    }
}

/// A unit vector at right angles to `those`: what is left of the first axis that has enough left.
fn another(those: &[Vec<f64>], size: usize) -> Vec<f64> {
    let mut best = (0.0, unit(size, 0));
    for k in 0..size {
        let mut v = unit(size, k);
        for _ in 0..2 {
            for q in those {
                let w = dot(q, &v);
                v.iter_mut().zip(q).for_each(|(v, q)| *v -= w * q);
            }
        }
        let rest = length(&v);
        if rest > best.0 + 0.01 {
            v.iter_mut().for_each(|value| *value /= rest);
            best = (rest, v);
        }
    }
    best.1
}

fn unit(size: usize, k: usize) -> Vec<f64> {
    (0..size).map(|i| f64::from(u8::from(i == k))).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 4];
    let (a, a_rest) = a.as_chunks::<4>();
    let (b, b_rest) = b.as_chunks::<4>();
    for (a, b) in a.iter().zip(b) {
        for k in 0..4 {
            lanes[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]) + rest
}

/// Without underflow of what is small throughout.
fn length(a: &[f64]) -> f64 {
    let e = exponent(a.iter().fold(0.0, |most: f64, value| most.max(value.abs())));
    if e.abs() < 400 {
        return dot(a, a).sqrt();
    }
    let a: Vec<f64> = a.iter().map(|&value| ldexp(value, -e)).collect();
    ldexp(dot(&a, &a).sqrt(), e)
}

/// The component of largest magnitude, of equals the first.
fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |most: f64, &value| if value.abs() > most.abs() { value } else { most })
}
