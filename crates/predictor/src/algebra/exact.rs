//! Numbers of twice the length: a sum of two `f64` that do not overlap (Dekker, doi:10.1007/BF01397083; Ogita, Rump and
//! Oishi, doi:10.1137/030601818). A product's rounding error comes from a fused multiplication where the machine has
//! one, else from Dekker's split: the same bits either way, as both are exact.

use pulp::Simd;

/// An unevaluated sum, high part first.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Long(pub(crate) f64, pub(crate) f64);

/// a + b exactly.
#[inline(always)]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The rounding error of `product` = a b.
#[inline(always)]
pub(crate) fn product_error<const FUSED: bool>(a: f64, b: f64, product: f64) -> f64 {
    if FUSED {
        a.mul_add(b, -product)
    } else {
        let (ah, al) = split(a);
        let (bh, bl) = split(b);
        ((ah * bh - product) + ah * bl + al * bh) + al * bl
    }
}

#[inline(always)]
pub(crate) fn two_sums<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> (S::f64s, S::f64s) {
    let sum = simd.add_f64s(a, b);
    let part = simd.sub_f64s(sum, a);
    (sum, simd.add_f64s(simd.sub_f64s(a, simd.sub_f64s(sum, part)), simd.sub_f64s(b, part)))
}

/// [`product_error`] of vectors, which have a fused multiplication, or of single numbers.
#[inline(always)]
pub(crate) fn product_errors<S: Simd, const FUSED: bool>(simd: S, a: S::f64s, b: S::f64s, product: S::f64s) -> S::f64s {
    if FUSED {
        return simd.mul_add_f64s(a, b, simd.neg_f64s(product));
    }
    let half = |a| {
        let c = simd.mul_f64s(simd.splat_f64s(SPLITTER), a);
        let high = simd.sub_f64s(c, simd.sub_f64s(c, a));
        (high, simd.sub_f64s(a, high))
    };
    let ((ah, al), (bh, bl)) = (half(a), half(b));
    let times = |a, b| simd.mul_f64s(a, b);
    let error = simd.sub_f64s(times(ah, bh), product);
    simd.add_f64s(simd.add_f64s(simd.add_f64s(error, times(ah, bl)), times(al, bh)), times(al, bl))
}

/// 2^27 + 1.
const SPLITTER: f64 = 134_217_729.0;

/// Halves of 26 bits.
#[inline(always)]
fn split(a: f64) -> (f64, f64) {
    let c = SPLITTER * a;
    let high = c - (c - a);
    (high, a - high)
}

impl Long {
    pub(crate) const ZERO: Self = Self(0.0, 0.0);

    /// a + b exactly.
    pub(crate) fn of(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, b);
        Self(high, low)
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        let (sum, error) = two_sum(self.0, other.0);
        let (high, low) = two_sum(self.1, other.1);
        let (sum, error) = two_sum(sum, error + high);
        let (sum, error) = two_sum(sum, error + low);
        Self(sum, error)
    }

    pub(crate) fn times(self, other: Self) -> Self {
        let product = self.0 * other.0;
        let error = self.0.mul_add(other.0, -product) + (self.0 * other.1 + self.1 * other.0);
        Self::of(product, error)
    }

    pub(crate) fn negative(self) -> Self {
        Self(-self.0, -self.1)
    }

    /// Over a plain number.
    pub(crate) fn over(self, by: f64) -> Self {
        let first = self.0 / by;
        let rest = (-first).mul_add(by, self.0) + self.1;
        Self::of(first, rest / by)
    }

    /// The nearest `f64`.
    pub(crate) fn rounded(self) -> f64 {
        self.0 + self.1
    }
}

impl From<f64> for Long {
    fn from(x: f64) -> Self {
        Self(x, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn split_and_fused_products_are_the_same_bits(a in -1e100..1e100f64, b in -1e100..1e100f64) {
            let p = a * b;
            prop_assert_eq!(product_error::<true>(a, b, p).to_bits(), product_error::<false>(a, b, p).to_bits());
        }

        #[test]
        fn a_quotient_times_its_divisor_comes_back(a in -1e3..1e3f64, b in 1e-3..1e3f64) {
            let back = Long::from(a).over(b).times(b.into()).plus(Long::from(-a));
            // Measured at most 2e-29.
            prop_assert!(back.rounded().abs() <= 1e-27);
        }
    }

    #[test]
    fn what_cancels_is_kept() {
        let sum = [1e16, 1.0, -1e16, 2f64.powi(-60)].into_iter().fold(Long::ZERO, |s, x| s.plus(x.into()));
        assert_eq!(sum.rounded(), 1.0 + 2f64.powi(-60));
        assert_eq!(sum, Long(1.0, 2f64.powi(-60)));
    }
}
