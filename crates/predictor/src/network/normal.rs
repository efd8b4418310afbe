//! The normal equations of a network's errors: J^T J and J^T e, without ever holding J.
//!
//! For node j with output h_j, slope g_j = 1 - h_j^2, input u_i (u_0 = 1) and output weights V_kj, a row's error of
//! target k has the derivatives V_kj g_j u_i (hidden weights) and h_j (the target's own output weights; 0 for
//! another's). So over all rows and targets
//!
//! - hidden with hidden:  (sum_k V_kj V_kl) sum g_j g_l u_i u_m
//! - hidden with output:  V_kj sum g_j h_l u_i
//! - output with output:  sum h_j h_l, the same for each target, and nothing between targets
//!
//! The sums hold no target: a network of 8 nodes, 8 inputs and 3 targets needs 2400 of them a row where J^T J as
//! written has 14 850. Most of them are two products of matrices, [g_j g_l]^T [u_i u_m] and [g_j h_l, g_j, d_j]^T [u_i]
//! with d_j = g_j sum_k e_k V_kj, summed over a block of rows and then over blocks.

use super::rows::{BLOCK, Column, Rows};
use super::weights::{Forward, Shape};
use crate::algebra::simd::{Simd, Wide, widest};

/// Columns of products are filled with zeros to a multiple of this, the length of most machines' vectors.
const PAD: usize = 4;
/// Left columns in a tile.
const BAND: usize = 6;
/// Parts of a plain sum.
const LANES: usize = 8;

/// J^T J and J^T e, each divided by the number of errors, and what is needed to work them out.
#[derive(Debug, Clone)]
pub(super) struct Normal {
    shape: Shape,
    /// J^T J, parameters x parameters; only what is right of the diagonal and on it.
    pub(super) matrix: Vec<f64>,
    /// J^T e.
    pub(super) gradient: Vec<f64>,
    forward: Forward,
    slopes: Vec<Column>,
    /// Of a block, row by row: first the inputs themselves, then products of pairs of inputs, placed by [`pair`].
    pairs: Vec<f64>,
    /// How many those are, with the filling.
    width: usize,
    curved: Product,
    mixed: Product,
    plain: Plain,
}

/// Sums over rows of the products of outputs and errors: h_j h_l (j <= l), h_j; then for each target e_k, e_k h_j. Each
/// in [`LANES`] parts.
#[derive(Debug, Clone)]
struct Plain {
    sums: Vec<[f64; LANES]>,
}

impl Plain {
    #[inline(always)]
    fn add(&mut self, hidden: &[Column], errors: &[Column], counts: &Column) {
        let mut sums = self.sums.iter_mut();
        for (j, h) in hidden.iter().enumerate() {
            add_times(&mut sums, h, &hidden[j..]);
        }
        add_times(&mut sums, counts, hidden);
        for error in errors {
            add_times(&mut sums, counts, std::slice::from_ref(error));
            add_times(&mut sums, error, hidden);
        }
    }

    fn sum(&self, place: usize) -> f64 {
        self.sums[place].iter().sum()
    }
}

/// Sums over rows of each left column times each of the first right columns.
#[derive(Debug, Clone)]
struct Product {
    left: Vec<Column>,
    /// Left x `width`.
    sums: Vec<f64>,
    width: usize,
}

impl Product {
    fn new(left: usize, width: usize) -> Self {
        Self { left: vec![[0.0; BLOCK]; left], sums: vec![0.0; left * width], width }
    }

    /// Adds a block; `right` holds `stride` columns for each row.
    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, right: &[f64], stride: usize) {
        let width = self.width;
        let mut rows = self.left.chunks_exact(BAND);
        let mut sums = self.sums.chunks_exact_mut(BAND * width);
        for (left, sums) in rows.by_ref().zip(sums.by_ref()) {
            band::<S, BAND>(simd, left, right, stride, sums, width);
        }
        for (left, sums) in rows.remainder().chunks_exact(1).zip(sums.into_remainder().chunks_exact_mut(width)) {
            band::<S, 1>(simd, left, right, stride, sums, width);
        }
    }
}

/// A few left columns with all right ones, by tiles that fit the registers.
#[inline(always)]
fn band<S: Simd, const M: usize>(
    simd: S,
    left: &[Column],
    right: &[f64],
    stride: usize,
    sums: &mut [f64],
    width: usize,
) {
    let left: &[Column; M] = left.try_into().expect("a band of M columns");
    let vectors = width / S::F64_LANES;
    let mut first = 0;
    while first + 2 <= vectors {
        tile::<S, M, 2>(simd, left, right, stride, sums, width, first);
        first += 2;
    }
    while first < vectors {
        tile::<S, M, 1>(simd, left, right, stride, sums, width, first);
        first += 1;
    }
    // Vectors longer than the filling.
    for column in vectors * S::F64_LANES..width {
        for (left, sums) in left.iter().zip(sums.chunks_exact_mut(width)) {
            let mut sum = 0.0;
            for (left, right) in left.iter().zip(right.chunks_exact(stride)) {
                sum = left.mul_add(right[column], sum);
            }
            sums[column] += sum;
        }
    }
}

/// M left columns with N vectors of right ones, from the `first` on.
#[inline(always)]
fn tile<S: Simd, const M: usize, const N: usize>(
    simd: S,
    left: &[Column; M],
    right: &[f64],
    stride: usize,
    sums: &mut [f64],
    width: usize,
    first: usize,
) {
    let mut tile = [[simd.splat_f64s(0.0); N]; M];
    for (row, right) in right.chunks_exact(stride).enumerate().take(BLOCK) {
        let (right, _) = S::as_simd_f64s(right);
        let right: &[S::f64s; N] = right[first..first + N].try_into().expect("N vectors");
        for m in 0..M {
            let left = simd.splat_f64s(left[m][row]);
            for n in 0..N {
                tile[m][n] = simd.mul_add_f64s(left, right[n], tile[m][n]);
            }
        }
    }
    for (sums, tile) in sums.chunks_exact_mut(width).zip(&tile) {
        let (sums, _) = S::as_mut_simd_f64s(sums);
        for (sum, tile) in sums[first..first + N].iter_mut().zip(tile) {
            *sum = simd.add_f64s(*sum, *tile);
        }
    }
}

impl Normal {
    pub(super) fn new(shape: Shape) -> Self {
        let (n, all) = (shape.hidden, 1 + shape.inputs);
        // What is written four at a time may run over the end by three.
        let width = (all * (all + 1) / 2 + PAD - 1).next_multiple_of(PAD);
        let parameters = shape.parameters();
        Self {
            shape,
            matrix: vec![0.0; parameters * parameters],
            gradient: vec![0.0; parameters],
            forward: Forward::new(shape),
            slopes: vec![[0.0; BLOCK]; n],
            pairs: vec![0.0; width * BLOCK],
            width,
            curved: Product::new(n * (n + 1) / 2, width),
            mixed: Product::new(n * (n + 2), all.next_multiple_of(PAD)),
            plain: Plain { sums: vec![[0.0; LANES]; n * (n + 1) / 2 + n + shape.targets * (n + 1)] },
        }
    }

    /// Works out both for `weights`.
    pub(super) fn accumulate(&mut self, weights: &[f64], rows: &Rows) {
        self.curved.sums.fill(0.0);
        self.mixed.sums.fill(0.0);
        self.plain.sums.fill([0.0; LANES]);
        widest(Sums { normal: self, weights, rows });
        self.assemble(weights, 1.0 / (rows.rows * rows.targets) as f64);
    }

    /// A block's left and right columns, and the plain sums.
    #[inline(always)]
    fn fill(&mut self, weights: &[f64], inputs: &[Column], by_row: &[f64], stride: usize) {
        let all = inputs.len();
        for (pairs, row) in self.pairs.chunks_exact_mut(self.width).zip(by_row.chunks_exact(stride)) {
            let mut place = 0;
            for i in 0..all {
                let one = row[i];
                // Beyond the last lie other rows' values: the next i writes over them, or nobody reads them.
                let (others, pairs) = (row[i..].chunks_exact(PAD), pairs[place..].chunks_exact_mut(PAD));
                for (pairs, others) in pairs.zip(others).take((all - i).div_ceil(PAD)) {
                    let others: &[f64; PAD] = others.try_into().expect("chunks of this");
                    let pairs: &mut [f64; PAD] = pairs.try_into().expect("chunks of this");
                    *pairs = others.map(|other| one * other);
                }
                place += all - i;
            }
        }
        let n = self.shape.hidden;
        let counts = &inputs[0];
        for h in &mut self.forward.hidden {
            for (h, counts) in h.iter_mut().zip(counts) {
                *h *= counts;
            }
        }
        let (hidden, errors) = (&self.forward.hidden, &self.forward.errors);
        self.plain.add(hidden, errors, counts);
        for (slope, h) in self.slopes.iter_mut().zip(hidden) {
            for (slope, h) in slope.iter_mut().zip(h) {
                *slope = (1.0 - h) * (1.0 + h);
            }
        }
        let mut curved = self.curved.left.iter_mut();
        for (j, slope) in self.slopes.iter().enumerate() {
            for (other, left) in self.slopes[j..].iter().zip(&mut curved) {
                times(left, slope, other);
            }
        }
        for ((j, left), slope) in self.mixed.left.chunks_exact_mut(n + 2).enumerate().zip(&self.slopes) {
            left[0] = *slope;
            for (left, h) in left[1..=n].iter_mut().zip(hidden) {
                times(left, slope, h);
            }
            let mut back = [0.0; BLOCK];
            for (error, weights) in errors.iter().zip(self.shape.outputs(weights)) {
                let weight = weights[1 + j];
                for (back, error) in back.iter_mut().zip(error) {
                    *back = weight.mul_add(*error, *back);
                }
            }
            times(&mut left[n + 1], slope, &back);
        }
    }

    /// The sums to their places in the matrix and the gradient.
    fn assemble(&mut self, weights: &[f64], share: f64) {
        let Shape { inputs, hidden: n, targets } = self.shape;
        let (all, size, first) = (1 + inputs, self.shape.parameters(), self.shape.first());
        let (matrix, gradient) = (&mut self.matrix, &mut self.gradient);
        let mut place = 0;
        for j in 0..n {
            for l in j..n {
                let both: f64 = self.shape.outputs(weights).map(|weights| weights[1 + j] * weights[1 + l]).sum();
                let sums = &self.curved.sums[place * self.width..][..self.width];
                for i in 0..all {
                    for m in if j == l { i } else { 0 }..all {
                        matrix[(j * all + i) * size + l * all + m] = share * both * sums[pair(i, m, all)];
                    }
                }
                place += 1;
            }
        }
        let width = self.mixed.width;
        for j in 0..n {
            let sums = &self.mixed.sums[j * (n + 2) * width..][..(n + 2) * width];
            for i in 0..all {
                let row = j * all + i;
                for (k, weights) in self.shape.outputs(weights).enumerate() {
                    for l in 0..=n {
                        matrix[row * size + first + k * (n + 1) + l] = share * weights[1 + j] * sums[l * width + i];
                    }
                }
                gradient[row] = share * sums[(n + 1) * width + i];
            }
        }
        let sum = |place: usize| share * self.plain.sum(place);
        let pairs = n * (n + 1) / 2;
        for k in 0..targets {
            let corner = first + k * (n + 1);
            let errors = pairs + n + k * (n + 1);
            matrix[corner * size + corner] = 1.0 / targets as f64;
            gradient[corner] = sum(errors);
            let mut place = 0;
            for j in 0..n {
                let row = corner + 1 + j;
                matrix[corner * size + row] = sum(pairs + j);
                gradient[row] = sum(errors + 1 + j);
                for l in j..n {
                    matrix[row * size + corner + 1 + l] = sum(place);
                    place += 1;
                }
            }
        }
    }
}

struct Sums<'a> {
    normal: &'a mut Normal,
    weights: &'a [f64],
    rows: &'a Rows,
}

impl Wide for Sums<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { normal, weights, rows } = self;
        for ((inputs, targets), by_row) in rows.blocks().zip(rows.blocks_by_row()) {
            normal.forward.block(weights, inputs, targets);
            normal.fill(weights, inputs, by_row, rows.stride());
            for product in [&mut normal.curved, &mut normal.mixed] {
                product.add(simd, &normal.pairs, normal.width);
            }
        }
    }
}

/// Where the product of inputs `i` and `m` lies, of `all` with the bias'.
fn pair(i: usize, m: usize, all: usize) -> usize {
    let (i, m) = (i.min(m), i.max(m));
    i * all - i * (i + 1) / 2 + m
}

/// Adds one column times each of the others to the next sums.
#[inline(always)]
fn add_times(sums: &mut std::slice::IterMut<'_, [f64; LANES]>, one: &Column, others: &[Column]) {
    for (other, sum) in others.iter().zip(sums) {
        for (one, other) in one.chunks_exact(LANES).zip(other.chunks_exact(LANES)) {
            for (sum, (one, other)) in sum.iter_mut().zip(one.iter().zip(other)) {
                *sum = one.mul_add(*other, *sum);
            }
        }
    }
}

#[inline(always)]
fn times(out: &mut Column, one: &Column, other: &Column) {
    for (out, (one, other)) in out.iter_mut().zip(one.iter().zip(other)) {
        *out = one * other;
    }
}
