//! Intervals with outward rounding.
//!
//! Every operation is done in the nearest `f64` and its result moved outward by one step, so that the exact result of
//! any numbers out of the operands lies in it. Nothing depends on the rounding mode or the processor. An interval that
//! is not finite at both ends says nothing, and whoever meets one has to give up on it.

use std::ops::{Add, Mul, Neg, Sub};

/// The numbers from `lo` to `hi`, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub(super) lo: f64,
    pub(super) hi: f64,
}

impl Interval {
    pub(super) fn new(lo: f64, hi: f64) -> Interval {
        Interval { lo, hi }
    }

    pub(super) fn point(value: f64) -> Interval {
        Interval { lo: value, hi: value }
    }

    /// A point within, as near to the middle as rounding gets.
    pub(super) fn middle(self) -> f64 {
        let middle = 0.5 * (self.lo + self.hi);
        middle.clamp(self.lo, self.hi)
    }

    pub(super) fn width(self) -> f64 {
        self.hi - self.lo
    }

    /// The greatest magnitude in it.
    pub(super) fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    pub(super) fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    pub(super) fn within(self, other: Interval) -> bool {
        other.lo <= self.lo && self.hi <= other.hi
    }

    /// What both have, `None` where that is nothing.
    pub(super) fn meet(self, other: Interval) -> Option<Interval> {
        let both = Interval { lo: self.lo.max(other.lo), hi: self.hi.min(other.hi) };
        (both.lo <= both.hi).then_some(both)
    }

    /// The least interval that holds both.
    pub(super) fn hull(self, other: Interval) -> Interval {
        Interval { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Wider by `by` at both ends.
    pub(super) fn wider(self, by: f64) -> Interval {
        Interval { lo: (self.lo - by).next_down(), hi: (self.hi + by).next_up() }
    }

    /// The third power where nothing is negative.
    pub(super) fn cube(self) -> Interval {
        let lo = ((self.lo * self.lo).next_down() * self.lo).next_down();
        let hi = ((self.hi * self.hi).next_up() * self.hi).next_up();
        Interval { lo, hi }
    }

    /// The fourth power where nothing is negative.
    pub(super) fn fourth(self) -> Interval {
        let (lo, hi) = ((self.lo * self.lo).next_down(), (self.hi * self.hi).next_up());
        Interval { lo: (lo * lo).next_down(), hi: (hi * hi).next_up() }
    }

    /// The quotient; `None` where the divisor holds 0.
    pub(super) fn over(self, divisor: Interval) -> Option<Interval> {
        if divisor.lo <= 0.0 && divisor.hi >= 0.0 {
            return None;
        }
        Some(outward([self.lo / divisor.lo, self.lo / divisor.hi, self.hi / divisor.lo, self.hi / divisor.hi]))
    }
}

/// The hull of rounded numbers, moved outward.
fn outward([a, b, c, d]: [f64; 4]) -> Interval {
    Interval { lo: a.min(b).min(c.min(d)).next_down(), hi: a.max(b).max(c.max(d)).next_up() }
}

impl Add for Interval {
    type Output = Interval;
    fn add(self, other: Interval) -> Interval {
        Interval { lo: (self.lo + other.lo).next_down(), hi: (self.hi + other.hi).next_up() }
    }
}

impl Sub for Interval {
    type Output = Interval;
    fn sub(self, other: Interval) -> Interval {
        Interval { lo: (self.lo - other.hi).next_down(), hi: (self.hi - other.lo).next_up() }
    }
}

impl Neg for Interval {
    type Output = Interval;
    fn neg(self) -> Interval {
        Interval { lo: -self.hi, hi: -self.lo }
    }
}

impl Mul for Interval {
    type Output = Interval;
    fn mul(self, other: Interval) -> Interval {
        outward([self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi])
    }
}

impl Mul<Interval> for f64 {
    type Output = Interval;
    fn mul(self, other: Interval) -> Interval {
        let (a, b) = (self * other.lo, self * other.hi);
        Interval { lo: a.min(b).next_down(), hi: a.max(b).next_up() }
    }
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;
    use num_traits::FromPrimitive;

    use super::*;

    fn exact(value: f64) -> BigRational {
        BigRational::from_f64(value).expect("a finite number")
    }

    fn holds(interval: Interval, value: &BigRational) -> bool {
        exact(interval.lo) <= *value && *value <= exact(interval.hi)
    }

    #[test]
    fn every_operation_holds_the_exact_result_of_its_ends() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 10.0
        };
        for _ in 0..300 {
            let mut pair = [random(), random()];
            pair.sort_by(f64::total_cmp);
            let a = Interval::new(pair[0], pair[1]);
            let mut pair = [random(), random()];
            pair.sort_by(f64::total_cmp);
            let b = Interval::new(pair[0], pair[1]);
            let positive = Interval::new(0.1, 0.1 + a.width());
            for x in [a.lo, a.middle(), a.hi] {
                for y in [b.lo, b.middle(), b.hi] {
                    assert!(holds(a + b, &(exact(x) + exact(y))));
                    assert!(holds(a - b, &(exact(x) - exact(y))));
                    assert!(holds(a * b, &(exact(x) * exact(y))));
                    assert!(holds(x * b, &(exact(x) * exact(y))));
                    match a.over(b) {
                        Some(quotient) => assert!(holds(quotient, &(exact(x) / exact(y)))),
                        None => assert!(b.contains(0.0)),
                    }
                }
            }
            for x in [positive.lo, positive.middle(), positive.hi] {
                let square = exact(x) * exact(x);
                assert!(holds(positive.cube(), &(&square * exact(x))));
                assert!(holds(positive.fourth(), &(&square * &square)));
            }
        }
    }
}
