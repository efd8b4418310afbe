//! Roots by additions, multiplications and divisions alone: the same bytes on every machine, which the library's `powf`
//! does not promise.

/// `x^(1/n)` of a positive, normal `x`; infinity of infinity, 0 of what is below.
pub(crate) fn root(x: f64, n: u32) -> f64 {
    newton(x, n, 5)
}

/// [`root`] to a thousandth, for what chooses a step.
pub(crate) fn rough_root(x: f64, n: u32) -> f64 {
    newton(x, n, 2)
}

/// By Newton's iterations: the first guess is within 7 %, and each squares the error.
fn newton(x: f64, n: u32, iterations: usize) -> f64 {
    if x < f64::MIN_POSITIVE {
        return 0.0;
    }
    if !x.is_finite() {
        return x;
    }
    // The exponent is the greater part of the logarithm.
    const ONE: u64 = 1.0f64.to_bits();
    let guess =
        if x >= 1.0 { ONE + (x.to_bits() - ONE) / u64::from(n) } else { ONE - (ONE - x.to_bits()) / u64::from(n) };
    let (mut y, n_f) = (f64::from_bits(guess), f64::from(n));
    for _ in 0..iterations {
        let power = (1..n).fold(1.0, |power, _| power * y);
        y += (x / power - y) / n_f;
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative; measured 4e-16.
    const TOLERANCE: f64 = 2e-15;

    #[test]
    fn powers_of_roots_are_the_number() {
        for n in [4, 5, 6, 7, 8, 9] {
            for x in [1e-300, 3e-17, 1e-12, 0.01, 0.99, 1.0, 1.5, 40.0, 1e13, 1e200] {
                let exact = f64::powf(x, 1.0 / f64::from(n));
                assert!((root(x, n) - exact).abs() <= TOLERANCE * exact * (1.0 + f64::ln(x).abs()), "{x}^(1/{n})");
                assert!((rough_root(x, n) - exact).abs() <= 2e-3 * exact);
            }
        }
        assert_eq!([root(0.0, 6), root(f64::INFINITY, 6)], [0.0, f64::INFINITY]);
        assert!(root(f64::NAN, 6).is_nan());
    }
}
