//! The problem as it is solved: a column of ones, the columns and the targets, scaled by powers of two and centred,
//! nothing rounded away. It is made block by block of rows whenever it is walked over, and never stored.
//!
//! A column's value is (high + low + centre) 2^exponent. The centre is the mean rounded to a number, so high is a
//! difference of two numbers and low what rounding it took away (mostly nothing: voltages about an offset subtract
//! exactly). As the ones stay among the columns, the rest of the mean does no harm. Products of columns (equation 16)
//! have what rounding took away as low, too.

use ndarray::{Array2, ArrayView2, CowArray, Ix2};
use pulp::{Arch, Simd, WithSimd};

use super::LeastSquaresFault;
use super::blocks::{BLOCK, NOTHING, Part, add, total, transpose};
use super::reflect::Triangle;
use super::survey::{Survey, survey};
use crate::algebra::exact::{Long, product_error, two_sum};
use crate::algebra::scale::{exponent, factors, ldexp};

pub(crate) struct Problem<'a> {
    pub(super) rows: usize,
    /// Inputs and products.
    pub(super) columns: usize,
    pub(super) targets: usize,
    /// Of columns, then targets.
    pub(super) exponents: Vec<i32>,
    /// Of columns, then targets, in units of 2^exponent.
    pub(super) centres: Vec<f64>,
    /// Largest value before centring of each column, in units of 2^exponent: what its values were rounded at.
    pub(super) rough: Vec<f64>,
    /// Ones, columns, targets: whether low is not zero throughout. All true until [`Problem::triangle`].
    pub(super) inexact: Vec<bool>,
    from: CowArray<'a, f64, Ix2>,
    to: CowArray<'a, f64, Ix2>,
    pairs: &'a [(usize, usize)],
    /// Of inputs, then targets: 2^-exponent in two factors, and the centre.
    shifts: Vec<Shift>,
}

#[derive(Debug, Clone, Copy)]
struct Shift {
    factors: (f64, f64),
    centre: f64,
}

impl<'a> Problem<'a> {
    /// Rows x columns, rows x targets.
    pub(super) fn new(design: ArrayView2<'a, f64>, targets: ArrayView2<'a, f64>) -> Result<Self, LeastSquaresFault> {
        let (rows, columns) = design.dim();
        check_rows(design, targets)?;
        let (from, to) = (standard(design), standard(targets));
        let mut problem = Self {
            rows,
            columns,
            targets: targets.ncols(),
            exponents: Vec::new(),
            centres: Vec::new(),
            rough: Vec::new(),
            inexact: vec![true; 1 + columns + targets.ncols()],
            from,
            to,
            pairs: &[],
            shifts: Vec::new(),
        };
        let Survey { largest, mut sums } = Arch::new().dispatch(Look(&problem));
        for &most in &largest {
            let e = exponent(most);
            problem.exponents.push(e);
            problem.shifts.push(Shift { factors: factors(-e), centre: 0.0 });
        }
        problem.rough = largest[..columns].iter().zip(&problem.exponents).map(|(&most, &e)| ldexp(most, -e)).collect();
        if sums.iter().all(|sum| sum.rounded().is_finite()) {
            for (sum, &e) in sums.iter_mut().zip(&problem.exponents) {
                *sum = Long(ldexp(sum.0, -e), ldexp(sum.1, -e));
            }
        } else {
            // Values near the end of the range are scaled before they are added.
            sums = Arch::new().dispatch(Sums(&problem));
        }
        for (sum, shift) in sums.iter().zip(&mut problem.shifts) {
            // Rows all alike have their value as mean, to the last bit.
            let mean = sum.over(rows as f64).rounded();
            shift.centre = mean;
            problem.centres.push(mean);
        }
        if problem.centres.iter().any(|centre| !centre.is_finite()) {
            check_finite(design, targets)?;
            unreachable!("the mean of finite numbers below 1 is finite");
        }
        Ok(problem)
    }

    /// Equation 16's terms of u = (P - m) / s: returns the problem, m and s. s is the power of two about the column's
    /// SD, 1 where there is none.
    pub(crate) fn quadratic(
        inputs: ArrayView2<'a, f64>,
        targets: ArrayView2<'a, f64>,
        pairs: &'a [(usize, usize)],
    ) -> Result<(Self, Vec<f64>, Vec<f64>), LeastSquaresFault> {
        let mut problem = Self::new(inputs, targets)?;
        let count = problem.columns;
        let (squares, mut spread) = Arch::new().dispatch(Spread(&problem));
        let (mut centre, mut scale) = (Vec::new(), Vec::new());
        for (j, sum) in squares.into_iter().enumerate() {
            let sd = (sum / problem.rows as f64).sqrt();
            let e = if sd > 0.0 { exponent(sd) } else { -problem.exponents[j] };
            centre.push(ldexp(problem.centres[j], problem.exponents[j]));
            problem.exponents[j] += e;
            scale.push(ldexp(1.0, problem.exponents[j]));
            problem.shifts[j] =
                Shift { factors: factors(-problem.exponents[j]), centre: ldexp(problem.centres[j], -e) };
            problem.rough[j] = ldexp(problem.rough[j], -e);
            spread[j] = ldexp(spread[j], -e);
            // What follows is in u, which has neither.
            problem.exponents[j] = 0;
            problem.centres[j] = 0.0;
        }
        // A value's rounding moves a product by as much times the other factor.
        let rough = pairs.iter().map(|&(i, j)| problem.rough[i] * spread[j] + problem.rough[j] * spread[i]);
        let rough: Vec<f64> = rough.collect();
        problem.rough.extend(rough);
        problem.exponents.splice(count..count, pairs.iter().map(|_| 0));
        problem.centres.splice(count..count, pairs.iter().map(|_| 0.0));
        problem.inexact.extend(pairs.iter().map(|_| true));
        problem.columns += pairs.len();
        problem.pairs = pairs;
        Ok((problem, centre, scale))
    }

    /// The triangle of [ones, columns, targets]. Finds out what is exact on the way.
    pub(super) fn triangle(&mut self) -> Array2<f64> {
        let (r, inexact) = Arch::new().dispatch(Walk(self));
        self.inexact = inexact;
        r.into_array()
    }

    /// Room for a block.
    pub(super) fn block(&self) -> Vec<Part> {
        vec![[0.0; BLOCK]; 1 + self.columns + self.targets]
    }

    /// Rows `start ..` of ones, columns and targets. To be called where vector instructions are allowed.
    #[inline(always)]
    pub(super) fn load<const FUSED: bool>(&self, start: usize, high: &mut [Part], low: &mut [Part]) {
        let inputs = self.columns - self.pairs.len();
        let rows = (self.rows - start).min(BLOCK);
        high[0][..rows].fill(1.0);
        high[0][rows..].fill(0.0);
        let (head, tail) = high.split_at_mut(1 + self.columns);
        transpose(self.from.as_slice().unwrap_or(&[]), inputs, start, &mut head[1..]);
        transpose(self.to.as_slice().unwrap_or(&[]), self.targets, start, tail);
        let (low_head, low_tail) = low.split_at_mut(1 + self.columns);
        let parts = head[1..=inputs].iter_mut().zip(&mut low_head[1..=inputs]).chain(tail.iter_mut().zip(low_tail));
        for ((high, low), shift) in parts.zip(&self.shifts) {
            centre(high, low, *shift, rows);
        }
        let (high_in, high_out) = head.split_at_mut(1 + inputs);
        let (low_in, low_out) = low_head.split_at_mut(1 + inputs);
        for ((&(i, j), high), low) in self.pairs.iter().zip(high_out).zip(low_out) {
            let (a, b, al, bl) = (&high_in[1 + i], &high_in[1 + j], &low_in[1 + i], &low_in[1 + j]);
            for k in 0..BLOCK {
                let product = a[k] * b[k];
                high[k] = product;
                low[k] = product_error::<FUSED>(a[k], b[k], product) + (a[k] * bl[k] + al[k] * b[k]);
            }
        }
    }
}

/// Copied where rows don't lie one after the other.
fn standard(values: ArrayView2<'_, f64>) -> CowArray<'_, f64, Ix2> {
    if values.is_standard_layout() { values.into() } else { values.as_standard_layout().into_owned().into() }
}

#[inline(always)]
fn centre(high: &mut Part, low: &mut Part, shift: Shift, rows: usize) {
    for k in 0..BLOCK {
        let value = high[k] * shift.factors.0 * shift.factors.1;
        (high[k], low[k]) = two_sum(value, -shift.centre);
    }
    high[rows..].fill(0.0);
    low[rows..].fill(0.0);
}

/// Whether there are rows, as many of both.
pub(super) fn check_rows(design: ArrayView2<'_, f64>, targets: ArrayView2<'_, f64>) -> Result<(), LeastSquaresFault> {
    match (design.nrows(), targets.nrows()) {
        (design, targets) if design != targets => Err(LeastSquaresFault::Rows { design, targets }),
        (0, _) => Err(LeastSquaresFault::NoRows),
        _ => Ok(()),
    }
}

/// Which value is not finite, if any.
pub(super) fn check_finite(design: ArrayView2<'_, f64>, targets: ArrayView2<'_, f64>) -> Result<(), LeastSquaresFault> {
    for (values, target) in [(design, false), (targets, true)] {
        if let Some(((row, column), _)) = values.indexed_iter().find(|(_, v)| !v.is_finite()) {
            return Err(LeastSquaresFault::NotFinite { target, row, column });
        }
    }
    Ok(())
}

/// Largest magnitudes and sums of inputs and targets.
struct Look<'a, 'b>(&'a Problem<'b>);

impl WithSimd for Look<'_, '_> {
    type Output = Survey;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Survey {
        let mut all = survey(self.0.from.as_slice().unwrap_or(&[]), self.0.columns);
        let targets = survey(self.0.to.as_slice().unwrap_or(&[]), self.0.targets);
        all.largest.extend(targets.largest);
        all.sums.extend(targets.sums);
        all
    }
}

/// Sums of inputs and targets (before any product), scaled.
struct Sums<'a, 'b>(&'a Problem<'b>);

impl WithSimd for Sums<'_, '_> {
    type Output = Vec<Long>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<Long> {
        let mut sums = vec![NOTHING; self.0.shifts.len()];
        let (mut high, mut low) = (self.0.block(), self.0.block());
        for start in (0..self.0.rows).step_by(BLOCK) {
            self.0.load::<true>(start, &mut high, &mut low);
            for (sums, part) in sums.iter_mut().zip(&high[1..]) {
                add(sums, part);
            }
        }
        sums.iter().map(total).collect()
    }
}

/// Sums of squares of the inputs, and largest magnitudes, about their centres.
struct Spread<'a, 'b>(&'a Problem<'b>);

impl WithSimd for Spread<'_, '_> {
    type Output = (Vec<f64>, Vec<f64>);

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let mut squares = vec![0.0; self.0.columns];
        let mut most = vec![0.0; self.0.columns];
        let (mut high, mut low) = (self.0.block(), self.0.block());
        for start in (0..self.0.rows).step_by(BLOCK) {
            self.0.load::<true>(start, &mut high, &mut low);
            for ((square, most), part) in squares.iter_mut().zip(&mut most).zip(&high[1..]) {
                *square += part.iter().map(|value| value * value).sum::<f64>();
                *most = part.iter().fold(*most, |most, value| if value.abs() > most { value.abs() } else { most });
            }
        }
        (squares, most)
    }
}

struct Walk<'a, 'b>(&'a Problem<'b>);

impl WithSimd for Walk<'_, '_> {
    type Output = (Triangle, Vec<bool>);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        // Every machine that pulp knows with lanes has a fused multiplication.
        if S::F64_LANES > 1 { self.run::<S, true>(simd) } else { self.run::<S, false>(simd) }
    }
}

impl Walk<'_, '_> {
    #[inline(always)]
    fn run<S: Simd, const FUSED: bool>(self, simd: S) -> (Triangle, Vec<bool>) {
        let (mut high, mut low) = (self.0.block(), self.0.block());
        let mut r = Triangle::new(high.len());
        // Bits of all low parts together, without sign: zero where all are.
        let mut bits = vec![0; high.len()];
        for start in (0..self.0.rows).step_by(BLOCK) {
            self.0.load::<FUSED>(start, &mut high, &mut low);
            for (bits, part) in bits.iter_mut().zip(&low) {
                *bits |= part.iter().fold(0, |bits, value| bits | value.to_bits() << 1);
            }
            r.fold(simd, &mut high);
        }
        (r, bits.into_iter().map(|bits| bits != 0).collect())
    }
}
