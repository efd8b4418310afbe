//! Predictions of many rows: blocks of rows are turned so that each input's values lie side by side, and one operation
//! serves a whole block.
//!
//! A model says once how a row's numbers are added up, for a row and for a block; the order is the same, so row by row
//! and in batch the results are the same bits, whatever the vectors of the processor.

use ndarray::{Array2, ArrayView1, ArrayView2, ArrayViewMut2};

use crate::algebra::simd::{Simd, Wide, widest};

/// Rows in a block.
pub(super) const LANES: usize = 16;
/// Models of more inputs than this predict row by row, as blocks live on the stack.
const WIDEST: usize = 64;
/// Columns that are turned at once.
const QUAD: usize = 4;

/// A value of each row of a block.
pub(super) type Lanes = [f64; LANES];

/// How a model works out its targets, some at a time. All methods are `#[inline(always)]`, and none takes a closure,
/// which would not be compiled for the vectors in use.
pub(super) trait Kernel {
    /// Targets worked out at once, at most [`MOST`].
    const GROUP: usize;

    fn inputs(&self) -> usize;

    fn targets(&self) -> usize;

    /// Of a row: `out` takes the targets from the `first` on, a multiple of `GROUP`, at most `GROUP` of them.
    fn row(&self, x: &impl Volts, first: usize, out: &mut [f64]);

    /// Centres and scales a block, input by input.
    fn prepare<S: Simd>(&self, simd: S, x: &mut [Lanes]);

    /// As `row`, of a block that is prepared.
    fn block<S: Simd>(&self, simd: S, x: &[Lanes], first: usize, out: &mut [Lanes]);
}

/// Of [`Kernel::GROUP`].
pub(super) const MOST: usize = 8;

/// A row's voltages, however they lie.
pub(super) trait Volts {
    fn volt(&self, i: usize) -> f64;
}

impl Volts for &[f64] {
    #[inline(always)]
    fn volt(&self, i: usize) -> f64 {
        self[i]
    }
}

impl Volts for ArrayView1<'_, f64> {
    #[inline(always)]
    fn volt(&self, i: usize) -> f64 {
        self[i]
    }
}

/// One row in slices.
#[inline]
pub(super) fn predict_row(kernel: &impl Kernel, x: &[f64], out: &mut [f64]) {
    assert!(x.len() == kernel.inputs() && out.len() == kernel.targets(), "a row of the model's size");
    widest(Row { kernel, x, out });
}

/// Rows of `x` (rows x inputs) to rows of `out` (rows x targets), of any layout.
pub(super) fn predict_into(kernel: &impl Kernel, x: ArrayView2<'_, f64>, out: ArrayViewMut2<'_, f64>) {
    assert!(x.ncols() == kernel.inputs() && out.dim() == (x.nrows(), kernel.targets()), "rows of the model's size");
    if kernel.targets() > 0 {
        widest(Batch { kernel, x, out });
    }
}

struct Row<'a, K> {
    kernel: &'a K,
    x: &'a [f64],
    out: &'a mut [f64],
}

impl<K: Kernel> Wide for Row<'_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { kernel, x, out } = self;
        for (out, first) in out.chunks_mut(K::GROUP).zip((0..).step_by(K::GROUP)) {
            kernel.row(&x, first, out);
        }
    }
}

struct Batch<'a, K> {
    kernel: &'a K,
    x: ArrayView2<'a, f64>,
    out: ArrayViewMut2<'a, f64>,
}

impl<K: Kernel> Wide for Batch<'_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { kernel, x, mut out } = self;
        let (inputs, targets) = (kernel.inputs(), kernel.targets());
        if inputs > WIDEST {
            for (x, mut out) in x.rows().into_iter().zip(out.rows_mut()) {
                for first in (0..targets).step_by(K::GROUP) {
                    let mut values = [0.0; MOST];
                    let values = &mut values[..K::GROUP.min(targets - first)];
                    kernel.row(&x, first, values);
                    for (k, value) in values.iter().enumerate() {
                        out[first + k] = *value;
                    }
                }
            }
            return;
        }
        let mut block = [[0.0; LANES]; WIDEST];
        let block = &mut block[..inputs];
        let mut lanes = [[0.0; LANES]; MOST];
        // Where all lies row by row, whole blocks are turned by the vectors' own operations.
        let mut done = 0;
        if let (Some(x), Some(out), 1..) = (x.as_slice(), out.as_slice_mut(), inputs) {
            for (x, out) in x.chunks_exact(LANES * inputs).zip(out.chunks_exact_mut(LANES * targets)) {
                // Common sizes: known at compile time, they run faster.
                match <&mut [Lanes; 8]>::try_from(&mut *block) {
                    Ok(block) => turn(simd, x, 8, block),
                    Err(_) => turn(simd, x, inputs, block),
                }
                kernel.prepare(simd, block);
                for first in (0..targets).step_by(K::GROUP) {
                    let lanes = &mut lanes[..K::GROUP.min(targets - first)];
                    kernel.block(simd, block, first, lanes);
                    match <&[Lanes; 3]>::try_from(&*lanes) {
                        Ok(lanes) if targets == 3 => turn_back(simd, lanes, out, 3, 0),
                        _ => turn_back(simd, lanes, out, targets, first),
                    }
                }
                done += LANES;
            }
        }
        for start in (done..x.nrows()).step_by(LANES) {
            // In the last block the lanes beyond the end keep older values, which nobody reads.
            let rows = LANES.min(x.nrows() - start);
            for (i, lanes) in block.iter_mut().enumerate() {
                for row in 0..rows {
                    lanes[row] = x[[start + row, i]];
                }
            }
            kernel.prepare(simd, block);
            for first in (0..targets).step_by(K::GROUP) {
                let lanes = &mut lanes[..K::GROUP.min(targets - first)];
                kernel.block(simd, block, first, lanes);
                for (k, lanes) in lanes.iter().enumerate() {
                    for row in 0..rows {
                        out[[start + row, first + k]] = lanes[row];
                    }
                }
            }
        }
    }
}

#[inline(always)]
pub(super) fn vectors<S: Simd>(lanes: &Lanes) -> &[S::f64s] {
    S::as_simd_f64s(lanes).0
}

/// The same, to write to.
#[inline(always)]
pub(super) fn vectors_mut<S: Simd>(lanes: &mut Lanes) -> &mut [S::f64s] {
    S::as_mut_simd_f64s(lanes).0
}

/// [`LANES`] rows, one after the other, to lanes. Vectors hold at most [`QUAD`] numbers (with longer ones, columns
/// would share a vector).
#[inline(always)]
fn turn<S: Simd>(simd: S, rows: &[f64], inputs: usize, block: &mut [Lanes]) {
    let (width, rows) = (S::F64_LANES, &rows[..LANES * inputs]);
    let quads = inputs / QUAD;
    for first in (0..QUAD * quads).step_by(QUAD) {
        let block: &mut [Lanes; QUAD] = (&mut block[first..first + QUAD]).try_into().expect("a quad");
        for part in 0..LANES / width {
            let mut quad = [simd.splat_f64s(0.0); QUAD];
            for (k, vector) in quad.iter_mut().enumerate() {
                let at = (part * width + k * width / QUAD) * inputs + first + k * width % QUAD;
                *vector = S::as_simd_f64s(&rows[at..at + width]).0[0];
            }
            let quad = simd.deinterleave_shfl_f64s(quad);
            for (lanes, vector) in block.iter_mut().zip(quad) {
                vectors_mut::<S>(lanes)[part] = vector;
            }
        }
    }
    for i in QUAD * quads..inputs {
        for row in 0..LANES {
            block[i][row] = rows[row * inputs + i];
        }
    }
}

/// Lanes of some targets, from the `first` on, to [`LANES`] rows of all `targets`.
#[inline(always)]
fn turn_back<S: Simd>(simd: S, lanes: &[Lanes], rows: &mut [f64], targets: usize, first: usize) {
    let rows = &mut rows[..LANES * targets];
    for (lanes, first) in lanes.chunks(QUAD).zip((first..).step_by(QUAD)) {
        match lanes.len() {
            1 => quad_back::<S, 1>(simd, lanes, rows, targets, first),
            2 => quad_back::<S, 2>(simd, lanes, rows, targets, first),
            3 => quad_back::<S, 3>(simd, lanes, rows, targets, first),
            _ => quad_back::<S, 4>(simd, lanes, rows, targets, first),
        }
    }
}

/// N targets' lanes.
#[inline(always)]
fn quad_back<S: Simd, const N: usize>(simd: S, lanes: &[Lanes], rows: &mut [f64], targets: usize, first: usize) {
    let width = S::F64_LANES;
    let lanes: &[Lanes; N] = lanes.try_into().expect("N targets");
    for part in 0..LANES / width {
        let mut quad = [simd.splat_f64s(0.0); QUAD];
        for (vector, lanes) in quad.iter_mut().zip(lanes) {
            *vector = vectors::<S>(lanes)[part];
        }
        let quad = simd.interleave_shfl_f64s(quad);
        let mut values = [0.0; LANES * QUAD];
        S::as_mut_simd_f64s(&mut values).0[..QUAD].copy_from_slice(&quad);
        for (row, values) in values.chunks_exact(QUAD).take(width).enumerate() {
            let at = (part * width + row) * targets + first;
            rows[at..at + N].copy_from_slice(&values[..N]);
        }
    }
}

/// (x - centre) * inverse, input by input.
#[inline(always)]
pub(super) fn scale<S: Simd>(simd: S, x: &mut [Lanes], centre: &[f64], inverse: &[f64]) {
    for ((lanes, centre), inverse) in x.iter_mut().zip(centre).zip(inverse) {
        let (centre, inverse) = (simd.splat_f64s(*centre), simd.splat_f64s(*inverse));
        for value in vectors_mut::<S>(lanes) {
            *value = simd.mul_f64s(simd.sub_f64s(*value, centre), inverse);
        }
    }
}

/// Targets that are worked out at once.
pub(super) const GROUP: usize = 4;

/// A matrix of targets x terms with [`GROUP`] targets side by side: target / GROUP, then term, then target % GROUP;
/// missing targets are zero.
pub(super) fn turned(matrix: &Array2<f64>) -> Vec<[f64; GROUP]> {
    let terms = matrix.ncols();
    let mut turned = vec![[0.0; GROUP]; matrix.nrows().div_ceil(GROUP) * terms];
    for ((target, term), value) in matrix.indexed_iter() {
        turned[target / GROUP * terms + term][target % GROUP] = *value;
    }
    turned
}

/// Adds a term times each target's coefficient of it.
#[inline(always)]
pub(super) fn add_term(sums: &mut [f64; GROUP], coefficients: &[f64; GROUP], term: f64) {
    for (sum, coefficient) in sums.iter_mut().zip(coefficients) {
        *sum = coefficient.mul_add(term, *sum);
    }
}

/// Vectors of a block's rows that are worked on at once.
pub(super) const PAIR: usize = 2;

/// Adds terms times N targets' coefficients of them, for the [`PAIR`] of vectors from `at` on.
#[inline(always)]
pub(super) fn add_terms<S: Simd, const N: usize>(
    simd: S,
    sums: &mut [[S::f64s; PAIR]; N],
    coefficients: &[[f64; GROUP]],
    terms: &[Lanes],
    at: usize,
) {
    for (coefficients, terms) in coefficients.iter().zip(terms) {
        let terms: &[S::f64s; PAIR] = vectors::<S>(terms)[at..at + PAIR].try_into().expect("a pair");
        for (sums, coefficient) in sums.iter_mut().zip(coefficients) {
            let coefficient = simd.splat_f64s(*coefficient);
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum = simd.mul_add_f64s(coefficient, *term, *sum);
            }
        }
    }
}

/// `offset + sum` of N targets to their lanes.
#[inline(always)]
pub(super) fn finish<S: Simd, const N: usize>(
    simd: S,
    sums: &[[S::f64s; PAIR]; N],
    offsets: &[f64],
    lanes: &mut [Lanes],
    at: usize,
) {
    for ((sums, offset), lanes) in sums.iter().zip(offsets).zip(lanes) {
        for (sum, lanes) in sums.iter().zip(&mut vectors_mut::<S>(lanes)[at..at + PAIR]) {
            *lanes = simd.add_f64s(simd.splat_f64s(*offset), *sum);
        }
    }
}

/// Calls `$work::<S, N>` with N the targets of a group.
macro_rules! by_size {
    ($size:expr, $one:ident.$work:ident($($argument:expr),*)) => {
        match $size {
            1 => $one.$work::<S, 1>($($argument),*),
            2 => $one.$work::<S, 2>($($argument),*),
            3 => $one.$work::<S, 3>($($argument),*),
            _ => $one.$work::<S, 4>($($argument),*),
        }
    };
}
pub(super) use by_size;
