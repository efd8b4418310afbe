//! Scaling by powers of two, which rounds nothing as long as results stay normal.

/// 2^e, for -1022 <= e <= 1023.
fn power(e: i32) -> f64 {
    f64::from_bits(u64::try_from(e + 1023).expect("an exponent of a normal number") << 52)
}

/// e such that |x| = f 2^e with f in [0.5, 1); 0 for 0, infinity and NaN.
pub(crate) fn exponent(x: f64) -> i32 {
    if x == 0.0 || !x.is_finite() {
        return 0;
    }
    // Subnormal numbers are lifted first.
    let (x, lift) = if x.abs() < f64::MIN_POSITIVE { (x * power(60), 60) } else { (x, 0) };
    (x.to_bits() >> 52 & 0x7ff) as i32 - 1022 - lift
}

/// x 2^e, for any e; infinite or zero where no number is that large or small.
pub(crate) fn ldexp(mut x: f64, mut e: i32) -> f64 {
    while e > 1023 {
        x *= power(1023);
        e -= 1023;
    }
    // The steps down stop above the subnormal range, so that rounding happens once.
    while e < -1022 {
        if x == 0.0 {
            return x;
        }
        let step = (e + 1022).max(-900);
        x *= power(step);
        e -= step;
    }
    x * power(e)
}

/// 2^e as two factors, each a normal number, for -2044 <= e <= 2046: what no single number may hold.
pub(crate) fn factors(e: i32) -> (f64, f64) {
    let first = e.clamp(-1022, 1023);
    (power(first), power(e - first))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_put_a_number_below_one() {
        for x in [1.0, 0.75, -3.0, 1e300, 1e-300, f64::MAX, f64::MIN_POSITIVE, 5e-324, 1e-310] {
            let f = ldexp(x, -exponent(x));
            assert!((0.5..1.0).contains(&f.abs()), "{x} gave {f}");
            assert_eq!(ldexp(f, exponent(x)), x);
        }
        assert_eq!((exponent(0.0), exponent(f64::INFINITY), ldexp(0.0, -5000)), (0, 0, 0.0));
    }

    #[test]
    fn two_factors_reach_from_end_to_end() {
        let (a, b) = factors(-exponent(5e-324));
        assert_eq!(5e-324 * a * b, 0.5);
        let (a, b) = factors(-exponent(f64::MAX));
        assert!((0.5..1.0).contains(&(f64::MAX * a * b)));
    }

    #[test]
    fn out_of_range_is_infinite_or_zero() {
        assert_eq!(ldexp(1.0, 1024), f64::INFINITY);
        assert_eq!(ldexp(1.0, 5000), f64::INFINITY);
        assert_eq!(ldexp(1.0, -5000), 0.0);
        assert_eq!(ldexp(1.0, -1074), 5e-324);
    }
}
