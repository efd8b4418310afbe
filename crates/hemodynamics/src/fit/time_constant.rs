//! The time constant of a step's response, as the thesis reads it off Figures 80 and 82.

/// The time from `from_s` until a response has gone 1 - 1/e (63 %) of its way from its value there to its value at
/// `to_s`, s; straight between samples. For loading `to_s` is the end of the load, for unloading the end of the
/// recording.
///
/// In: times (s, growing) and values of any unit, NaN where missing. `None` where the two ends are outside of the
/// samples or equal, or where the response does not get there.
pub fn time_constant(times_s: &[f64], values: &[f64], from_s: f64, to_s: f64) -> Option<f64> {
    let samples: Vec<(f64, f64)> = times_s
        .iter()
        .zip(values)
        .filter(|(time, value)| time.is_finite() && value.is_finite())
        .map(|(time, value)| (*time, *value))
        .collect();
    if from_s.is_nan() || to_s.is_nan() || from_s >= to_s {
        return None;
    }
    let (first, last) = (at(&samples, from_s)?, at(&samples, to_s)?);
    let target = first + (last - first) * (1.0 - 1.0 / std::f64::consts::E);
    if first == last {
        return None;
    }
    let mut before = (from_s, first);
    let inside = samples.iter().filter(|(time, _)| *time > from_s && *time < to_s).copied();
    for (time, value) in inside.chain([(to_s, last)]) {
        if (value - target) * (last - first) >= 0.0 {
            let part = (target - before.1) / (value - before.1);
            return Some(before.0 + part * (time - before.0) - from_s);
        }
        before = (time, value);
    }
    None
}

/// The value at a time, straight between samples.
fn at(samples: &[(f64, f64)], time_s: f64) -> Option<f64> {
    let after = samples.partition_point(|(time, _)| *time < time_s);
    let (time, value) = *samples.get(after)?;
    if time == time_s {
        return Some(value);
    }
    let (earlier, from) = *samples.get(after.checked_sub(1)?)?;
    Some(from + (value - from) * ((time_s - earlier) / (time - earlier)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times() -> Vec<f64> {
        (0..=400).map(|k| 0.01 * k as f64).collect()
    }

    #[test]
    fn is_that_of_an_exponential_up_and_down() {
        let curve = |t: f64| if t < 2.0 { 1.0 - (-t / 0.16).exp() } else { (-(t - 2.0) / 0.12).exp() };
        let values: Vec<f64> = times().into_iter().map(curve).collect();
        let up = time_constant(&times(), &values, 0.0, 1.99).unwrap();
        let down = time_constant(&times(), &values, 2.0, 4.0).unwrap();
        // Straight lines between samples, and an end that is not quite reached: measured at most 1.1e-6.
        assert!((up - 0.16).abs() <= 5e-6 && (down - 0.12).abs() <= 5e-6, "{up} {down}");
    }

    #[test]
    fn missing_samples_are_stepped_over() {
        let values: Vec<f64> =
            times().iter().enumerate().map(|(k, t)| if k % 3 == 1 { f64::NAN } else { 3.0 - t }).collect();
        let found = time_constant(&times(), &values, 1.0, 2.0).unwrap();
        assert!((found - (1.0 - 1.0 / std::f64::consts::E)).abs() <= 1e-12);
    }

    #[test]
    fn a_response_that_goes_nowhere_has_none() {
        assert_eq!(time_constant(&times(), &vec![2.5; 401], 0.0, 2.0), None);
        assert_eq!(time_constant(&times(), &vec![f64::NAN; 401], 0.0, 2.0), None);
        assert_eq!(time_constant(&times(), &times(), 0.0, 9.0), None);
        assert_eq!(time_constant(&times(), &times(), 2.0, 1.0), None);
        assert_eq!(time_constant(&[], &[], 0.0, 1.0), None);
    }
}
