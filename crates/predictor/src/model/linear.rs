//! Equation 9: y = y_m + J (P - m).

use ndarray::Array2;
use serde::Serialize;

use super::ModelFault;
use super::block::{
    GROUP, Kernel, LANES, Lanes, PAIR, Volts, add_term, add_terms, by_size, finish, turned, vectors_mut,
};
use crate::algebra::simd::Simd;

/// The linear model. It stays centred: m and y_m are the means of the training rows, and equation 9's offset F_0 = y_m
/// - J m is only worked out where it is printed, as it cancels digits where voltages have an offset.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Linear {
    centre: Vec<f64>,
    offset: Vec<f64>,
    #[serde(serialize_with = "crate::model::rows")]
    jacobian: Array2<f64>,
    #[serde(skip)]
    turned: Vec<[f64; GROUP]>,
}

impl Linear {
    /// `centre`: m, volts, an input each; `offset`: y_m, a target each; `jacobian`: J, targets x inputs.
    pub fn new(centre: Vec<f64>, offset: Vec<f64>, jacobian: Array2<f64>) -> Result<Self, ModelFault> {
        super::sizes(&[("offsets", offset.len(), jacobian.nrows()), ("centres", centre.len(), jacobian.ncols())])?;
        super::finite(&[("centre", &centre), ("offset", &offset)])?;
        super::finite_matrix("jacobian", &jacobian)?;
        let turned = turned(&jacobian);
        Ok(Self { centre, offset, jacobian: jacobian.as_standard_layout().into_owned(), turned })
    }

    /// y_m, a target each.
    #[must_use]
    pub fn offset(&self) -> &[f64] {
        &self.offset
    }

    /// J, targets x inputs, a target's unit a volt.
    #[must_use]
    pub fn jacobian(&self) -> &Array2<f64> {
        &self.jacobian
    }

    /// d target / d volt, targets x inputs: J wherever `x` is.
    ///
    /// # Panics
    /// Where the length is not the model's.
    #[must_use]
    pub fn jacobian_at(&self, x: &[f64]) -> Array2<f64> {
        assert_eq!(x.len(), self.inputs(), "a row of the model's size");
        self.jacobian.clone()
    }

    /// Of the targets from the `first` on.
    #[inline(always)]
    fn slopes(&self, first: usize) -> &[[f64; GROUP]] {
        let inputs = self.centre.len();
        &self.turned[first / GROUP * inputs..][..inputs]
    }

    /// N targets of a block of centred rows.
    #[inline(always)]
    fn group<S: Simd, const N: usize>(&self, simd: S, first: usize, x: &[Lanes], out: &mut [Lanes]) {
        for at in (0..LANES / S::F64_LANES).step_by(PAIR) {
            let mut sums = [[simd.splat_f64s(0.0); PAIR]; N];
            add_terms(simd, &mut sums, self.slopes(first), x, at);
            finish(simd, &sums, &self.offset[first..], out, at);
        }
    }
}

impl Kernel for Linear {
    const GROUP: usize = GROUP;

    fn inputs(&self) -> usize {
        self.centre.len()
    }

    fn targets(&self) -> usize {
        self.offset.len()
    }

    #[inline(always)]
    fn row(&self, x: &impl Volts, first: usize, out: &mut [f64]) {
        let mut sums = [0.0; GROUP];
        for (i, (slopes, centre)) in self.slopes(first).iter().zip(&self.centre).enumerate() {
            add_term(&mut sums, slopes, x.volt(i) - centre);
        }
        for ((out, offset), sum) in out.iter_mut().zip(&self.offset[first..]).zip(&sums) {
            *out = offset + sum;
        }
    }

    #[inline(always)]
    fn prepare<S: Simd>(&self, simd: S, x: &mut [Lanes]) {
        for (lanes, centre) in x.iter_mut().zip(&self.centre) {
            let centre = simd.splat_f64s(*centre);
            for value in vectors_mut::<S>(lanes) {
                *value = simd.sub_f64s(*value, centre);
            }
        }
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, x: &[Lanes], first: usize, out: &mut [Lanes]) {
        by_size!(out.len(), self.group(simd, first, x, out));
    }
}

super::predicting!(Linear);
