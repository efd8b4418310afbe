//! Multiples of a step: the times and loads at which a job reports values.

/// `k` times the step: of a step that is a decimal fraction the nearest number to that fraction's multiple, so that a
/// row stands at 0.07 and not at 0.07 and a last bit.
pub(super) fn multiple(k: usize, step: f64) -> f64 {
    let scales = (0..=9).map(|digits| 10_u64.pow(digits) as f64);
    let whole = scales
        .map(|scale| ((step * scale).round(), scale))
        .find(|&(counted, scale)| (1.0..1e9).contains(&counted.abs()) && counted / scale == step);
    match whole {
        Some((counted, scale)) => k as f64 * counted / scale,
        None => k as f64 * step,
    }
}

/// How many multiples of the step, 0 among them, lie within a length.
pub(super) fn multiples_within(length: f64, step: f64) -> f64 {
    // 4 / 0.01 may be a little less than 400 in floating point.
    (length / step * (1.0 + 1e-12)).floor() + 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_are_the_nearest_numbers_to_the_decimal_ones() {
        assert_eq!(multiples_within(4.0, 0.01), 401.0);
        for k in 0..=400 {
            assert_eq!(multiple(k, 0.01), format!("{}.{:02}", k / 100, k % 100).parse::<f64>().unwrap());
        }
        assert_eq!(multiple(3, 1.0 / 3.0), 1.0);
        assert_eq!(multiple(121, 100.0), 12_100.0);
        assert_eq!(multiple(2, -0.1), -0.2);
    }
}
