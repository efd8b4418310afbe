//! Equation 16: y = y_m + J T(u), u = (P - m) / s.
//!
//! Worked out as y_m + sum_i u_i (J_i + sum_{j >= i} J_ij u_j), which is the same sum with half the multiplications.

use ndarray::Array2;
use serde::Serialize;

use super::ModelFault;
use super::block::{
    GROUP, Kernel, LANES, Lanes, PAIR, Volts, add_term, add_terms, by_size, finish, scale, turned, vectors,
};
use crate::algebra::simd::Simd;

/// The pairs (i, j), i <= j, of the quadratic terms u_i u_j in equation 16's order: (0, 0), (0, 1), ..
#[must_use]
pub fn quadratic_terms(inputs: usize) -> Vec<(usize, usize)> {
    (0..inputs).flat_map(|i| (i..inputs).map(move |j| (i, j))).collect()
}

/// The quadratic model: inputs first, then their products in [`quadratic_terms`]' order, of centred and scaled
/// voltages.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quadratic {
    centre: Vec<f64>,
    scale: Vec<f64>,
    offset: Vec<f64>,
    #[serde(serialize_with = "crate::model::rows")]
    jacobian: Array2<f64>,
    /// 1 / s.
    #[serde(skip)]
    inverse: Vec<f64>,
    #[serde(skip)]
    turned: Vec<[f64; GROUP]>,
}

impl Quadratic {
    /// `centre`: m, volts; `scale`: s, volts, powers of two; `offset`: y at the centre; `jacobian`: J, targets x terms.
    pub fn new(centre: Vec<f64>, scale: Vec<f64>, offset: Vec<f64>, jacobian: Array2<f64>) -> Result<Self, ModelFault> {
        let inputs = centre.len();
        let terms = inputs + inputs * (inputs + 1) / 2;
        super::sizes(&[
            ("scales", scale.len(), inputs),
            ("terms", jacobian.ncols(), terms),
            ("offsets", offset.len(), jacobian.nrows()),
        ])?;
        super::finite(&[("centre", &centre), ("offset", &offset)])?;
        super::finite_matrix("jacobian", &jacobian)?;
        let inverse = super::inverses("scale", &scale)?;
        let turned = turned(&jacobian);
        Ok(Self { centre, scale, offset, jacobian: jacobian.as_standard_layout().into_owned(), inverse, turned })
    }

    /// s, volts, an input each.
    #[must_use]
    pub fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// y at the centre, a target each.
    #[must_use]
    pub fn offset(&self) -> &[f64] {
        &self.offset
    }

    /// J, targets x terms.
    #[must_use]
    pub fn jacobian(&self) -> &Array2<f64> {
        &self.jacobian
    }

    /// d target / d volt at `x` volts, targets x inputs.
    ///
    /// # Panics
    /// Where the length is not the model's.
    #[must_use]
    pub fn jacobian_at(&self, x: &[f64]) -> Array2<f64> {
        let inputs = self.inputs();
        assert_eq!(x.len(), inputs, "a row of the model's size");
        let u: Vec<f64> = (0..inputs).map(|i| (x[i] - self.centre[i]) * self.inverse[i]).collect();
        let mut slopes = Array2::zeros((self.targets(), inputs));
        for (mut slopes, row) in slopes.rows_mut().into_iter().zip(self.jacobian.rows()) {
            for i in 0..inputs {
                slopes[i] = row[i];
            }
            for ((i, j), q) in quadratic_terms(inputs).into_iter().zip(row.iter().skip(inputs)) {
                slopes[i] += q * u[j];
                slopes[j] += q * u[i];
            }
            for (slope, inverse) in slopes.iter_mut().zip(&self.inverse) {
                *slope *= inverse;
            }
        }
        slopes
    }

    /// Slopes and curvatures of the targets from the `first` on.
    #[inline(always)]
    fn coefficients(&self, first: usize) -> (&[[f64; GROUP]], &[[f64; GROUP]]) {
        let terms = self.jacobian.ncols();
        self.turned[first / GROUP * terms..][..terms].split_at(self.centre.len())
    }

    /// N targets of a block of centred and scaled rows.
    #[inline(always)]
    fn group<S: Simd, const N: usize>(&self, simd: S, first: usize, x: &[Lanes], out: &mut [Lanes]) {
        let (slopes, all) = self.coefficients(first);
        for at in (0..LANES / S::F64_LANES).step_by(PAIR) {
            let mut curvatures = all;
            let mut sums = [[simd.splat_f64s(0.0); PAIR]; N];
            for (i, slopes) in slopes.iter().enumerate() {
                let (these, rest) = curvatures.split_at(x.len() - i);
                curvatures = rest;
                let mut inner = [[simd.splat_f64s(0.0); PAIR]; N];
                for (inner, slope) in inner.iter_mut().zip(slopes) {
                    *inner = [simd.splat_f64s(*slope); PAIR];
                }
                add_terms(simd, &mut inner, these, &x[i..], at);
                let u: &[S::f64s; PAIR] = vectors::<S>(&x[i])[at..at + PAIR].try_into().expect("a pair");
                for (sums, inner) in sums.iter_mut().zip(&inner) {
                    for k in 0..PAIR {
                        sums[k] = simd.mul_add_f64s(inner[k], u[k], sums[k]);
                    }
                }
            }
            finish(simd, &sums, &self.offset[first..], out, at);
        }
    }
}

impl Kernel for Quadratic {
    const GROUP: usize = GROUP;

    fn inputs(&self) -> usize {
        self.centre.len()
    }

    fn targets(&self) -> usize {
        self.offset.len()
    }

    #[inline(always)]
    fn row(&self, x: &impl Volts, first: usize, out: &mut [f64]) {
        let u = |i: usize| (x.volt(i) - self.centre[i]) * self.inverse[i];
        let (slopes, mut curvatures) = self.coefficients(first);
        let mut sums = [0.0; GROUP];
        for (i, slopes) in slopes.iter().enumerate() {
            let (these, rest) = curvatures.split_at(self.centre.len() - i);
            curvatures = rest;
            let mut inner = *slopes;
            for (j, q) in these.iter().enumerate() {
                add_term(&mut inner, q, u(i + j));
            }
            add_term(&mut sums, &inner, u(i));
        }
        for ((out, offset), sum) in out.iter_mut().zip(&self.offset[first..]).zip(&sums) {
            *out = offset + sum;
        }
    }

    #[inline(always)]
    fn prepare<S: Simd>(&self, simd: S, x: &mut [Lanes]) {
        scale(simd, x, &self.centre, &self.inverse);
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, x: &[Lanes], first: usize, out: &mut [Lanes]) {
        by_size!(out.len(), self.group(simd, first, x, out));
    }
}

super::predicting!(Quadratic);
