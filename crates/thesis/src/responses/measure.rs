//! What the words of 3.3 speak of, as numbers: sensitivity, direction, hysteresis, repeatability, phase, symmetry,
//! range of sensitivity.
//!
//! All of it is measured on the averaged [`Curve`] of a photodiode; `middle` is halfway between rising and falling.
//!
//! - `range_V`: greatest less least of the middle. `sensitivity_share`: that over the greatest of all photodiodes.
//! - `slope_V_per_N` or `_per_deg`: of the straight line through the middle; `slope_low`, `slope_high` of its parts
//!   below and above zero, or below and above the middle of the range where zero is not within.
//! - `change_V`: at the range's upper end less at its lower one. `from_zero_to_low_V`, `from_zero_to_high_V`: from
//!   zero, or the end next to it, to the ends.
//! - `hysteresis`: the largest gap between rising and falling over `range_V`; only where the range stands out from the
//!   cycles' spread.
//! - `sd_V`: the mean of the SD over cycles; `sd_share`: over `range_V`.
//! - `phase_deg`: of the first harmonic against the driving signal's, positive where the output is late;
//!   `first_harmonic`: its share of the variance.
//! - `symmetry`: range of the even part over the sum of the ranges of even and odd part, about zero.
//! - `lowest_at`, `dip_V`, `recovery_V`: from rest to the lowest value as the finger presses, and from there to the
//!   end.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::curve::Curve;
use crate::Numbers;

/// A range stands out where it is this many times the spread over cycles.
const STANDS_OUT: f64 = 2.0;
/// Moments of a cycle at which harmonics are computed.
const MOMENTS: usize = 128;
/// Bending has hardly any effect where what is left of the range is less than this share.
const FLAT: f64 = 0.1;

/// Numbers of one output (or of a force that is to be held).
pub(super) fn of_output(curve: &Curve, drive: &str) -> Numbers {
    let mut numbers = Numbers::default();
    let middle = curve.middle();
    let spread = mean(curve.rising.iter().chain(&curve.falling).filter_map(|point| (*point)?.sd));
    numbers.set("sd_V", spread);
    let Some(range) = width(&middle) else { return numbers };
    numbers.set("range_V", range);
    numbers.set("sd_share", spread.map(|sd| sd / range));
    let unit = drive.rsplit('_').next().unwrap_or_default();
    numbers.set(format!("slope_V_per_{unit}"), slope(&middle));
    let (low, high) = (middle[0][0], middle[middle.len() - 1][0]);
    let middle_of_range = 0.5 * (low + high);
    let zero = if low < 0.0 && high > 0.0 { 0.0 } else { middle_of_range };
    let part = |within: &dyn Fn(f64) -> bool| -> Vec<[f64; 2]> {
        middle.iter().copied().filter(|point| within(point[0])).collect()
    };
    numbers.set("slope_low", slope(&part(&|at| at <= zero)));
    numbers.set("slope_high", slope(&part(&|at| at >= zero)));
    let rest = 0.0_f64.clamp(low, high);
    let at = |place: f64| value_at(&middle, place);
    numbers.set("change_V", at(high) - at(low));
    numbers.set("from_zero_to_low_V", at(low) - at(rest));
    numbers.set("from_zero_to_high_V", at(high) - at(rest));
    if spread.is_none_or(|sd| range > STANDS_OUT * sd) {
        numbers.set("hysteresis", gap(curve).map(|gap| gap / range));
    }
    if let Some([phase, share, second]) = harmonics(curve) {
        numbers.set("phase_deg", phase.to_degrees());
        numbers.set("first_harmonic", share);
        numbers.set("second_over_first", second);
    }
    if low < 0.0 && high > 0.0 {
        numbers.set("symmetry", symmetry(&middle, (-low).min(high)));
    }
    if drive == "Fz_N" {
        let lowest = middle.iter().min_by(|a, b| a[1].total_cmp(&b[1])).copied().unwrap_or(middle[0]);
        numbers.set("lowest_at_N", lowest[0]);
        numbers.set("dip_V", at(high) - lowest[1]);
        numbers.set("recovery_V", at(low) - lowest[1]);
    }
    if drive.ends_with("_deg") {
        numbers.set("beyond_30_share", beyond(&middle, 30.0).map(|left| left / range));
        numbers.set("up_to_25_share", width(&part(&|at| at <= 25.0)).map(|own| own / range));
        let end = at(high);
        let last = middle.iter().rev().find(|point| (point[1] - end).abs() > FLAT * range);
        numbers.set("flat_beyond_deg", last.map(|point| point[0]));
    }
    numbers
}

/// The largest gap between rising and falling.
fn gap(curve: &Curve) -> Option<f64> {
    let gaps =
        curve.rising.iter().zip(&curve.falling).filter_map(|(up, down)| Some(((*up)?.mean - (*down)?.mean).abs()));
    gaps.reduce(f64::max)
}

pub(super) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (n, sum) = values.fold((0.0, 0.0), |(n, sum), value| (n + 1.0, sum + value));
    (n > 0.0).then(|| sum / n)
}

/// Greatest less least value, of two points or more.
fn width(points: &[[f64; 2]]) -> Option<f64> {
    let ends = points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], p| [l.min(p[1]), h.max(p[1])]);
    (points.len() > 1).then(|| ends[1] - ends[0])
}

/// What changes beyond a place; zero where the points end before it, none where they all lie beyond.
fn beyond(points: &[[f64; 2]], place: f64) -> Option<f64> {
    let from = points.iter().position(|point| point[0] >= place)?;
    (from > 0).then(|| width(&points[from..]).unwrap_or(0.0))
}

/// Of the straight line through the points.
pub(super) fn slope(points: &[[f64; 2]]) -> Option<f64> {
    let n = points.len() as f64;
    let [x, y] = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / n);
    let square: f64 = points.iter().map(|p| (p[0] - x).powi(2)).sum();
    let product: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    (points.len() > 1 && square > 0.0).then(|| product / square)
}

/// On the way from point to point; the ends' values outside.
fn value_at(points: &[[f64; 2]], place: f64) -> f64 {
    let after = points.partition_point(|point| point[0] < place);
    if after == 0 {
        return points[0][1];
    }
    let Some([x1, y1]) = points.get(after).copied() else { return points[points.len() - 1][1] };
    let [x0, y0] = points[after - 1];
    y0 + (place - x0) * (y1 - y0) / (x1 - x0)
}

/// The even part's share of even and odd about zero, over what both sides have.
fn symmetry(middle: &[[f64; 2]], reach: f64) -> Option<f64> {
    let places = (0..=20).map(|k| reach * f64::from(k) / 20.0);
    let parts: Vec<[f64; 2]> = places
        .map(|place| {
            let (right, left) = (value_at(middle, place), value_at(middle, -place));
            [0.5 * (right + left), right - left]
        })
        .collect();
    let even = width(&parts.iter().map(|part| [0.0, part[0]]).collect::<Vec<_>>())?;
    // The odd part goes from minus to plus: its range is twice that of one side.
    let odd = parts.iter().map(|part| part[1].abs()).reduce(f64::max)?;
    (even + odd > 0.0).then(|| even / (even + odd))
}

/// Phase of the first harmonic behind the driving signal's (radians), its share of the variance, and the second's
/// amplitude over the first's. A cycle is taken to go as a sine: the driving signal's value says how far it is.
fn harmonics(curve: &Curve) -> Option<[f64; 3]> {
    let line = |points: &[Option<super::curve::Point>]| -> Vec<[f64; 2]> {
        curve.at.iter().zip(points).filter_map(|(&at, point)| Some([at, (*point)?.mean])).collect()
    };
    let (rising, falling) = (line(&curve.rising), line(&curve.falling));
    if rising.len() < 3 || falling.len() < 3 {
        return None;
    }
    let half = 0.5 * (curve.at[1] - curve.at[0]);
    let (low, high) = (curve.at[0] - half, curve.at[curve.at.len() - 1] + half);
    let (centre, reach) = (0.5 * (low + high), 0.5 * (high - low));
    let values: Vec<f64> = (0..MOMENTS)
        .map(|k| {
            let angle = -FRAC_PI_2 + TAU * (k as f64 + 0.5) / MOMENTS as f64;
            value_at(if angle < FRAC_PI_2 { &rising } else { &falling }, centre + reach * angle.sin())
        })
        .collect();
    let n = MOMENTS as f64;
    let average = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - average).powi(2)).sum::<f64>() / n;
    let part = |order: f64| {
        let angles = (0..MOMENTS).map(|k| order * (-FRAC_PI_2 + TAU * (k as f64 + 0.5) / n));
        let sums = angles.zip(&values).fold([0.0; 2], |[s, c], (angle, value)| {
            [s + 2.0 / n * angle.sin() * (value - average), c + 2.0 / n * angle.cos() * (value - average)]
        });
        (sums, sums[0].hypot(sums[1]))
    };
    let ([sine, cosine], first) = part(1.0);
    let (_, second) = part(2.0);
    // A output that is late is sin(angle - late): its cosine part is negative.
    let mut late = (-cosine).atan2(sine);
    if late <= -PI {
        late += TAU;
    }
    (variance > 0.0 && first > 0.0).then(|| [late, 0.5 * first * first / variance, second / first])
}

#[cfg(test)]
mod tests {
    use super::super::curve::Source;
    use super::super::cycles::Cycles;
    use super::*;

    /// Numbers of a response over five cycles between `low` and `high`.
    fn numbers(drive_name: &str, [low, high]: [f64; 2], response: impl Fn(f64, f64) -> f64) -> Numbers {
        let time_s: Vec<f64> = (0..5000).map(|k| f64::from(k) / 50.0).collect();
        let drive: Vec<f64> =
            time_s.iter().map(|t| 0.5 * (low + high) - 0.5 * (high - low) * (TAU * 0.05 * t).cos()).collect();
        let output: Vec<f64> = time_s.iter().zip(&drive).map(|(&t, &drive)| response(drive, t)).collect();
        let cycles = Cycles::of(&time_s, &drive);
        assert_eq!(cycles.count(), 5);
        let source = Source { legs: &cycles.legs, drive: &drive, output: &output };
        of_output(&Curve::of(&[source], [low, high], 40), drive_name)
    }

    #[test]
    fn a_late_response_has_its_phase_and_hysteresis() {
        // sin(angle - 20 degrees): the loop's widest gap is 2 sin(20 degrees) of an amplitude of 1.
        let late = 20_f64.to_radians();
        let found = numbers("Fx_N", [-2.0, 2.0], |_, t| (TAU * 0.05 * t - FRAC_PI_2 - late).sin());
        assert!((found.get("phase_deg").unwrap() - 20.0).abs() < 0.5, "{found:?}");
        let expected = late.sin() / late.cos();
        assert!((found.get("hysteresis").unwrap() - expected).abs() < 0.03 * expected, "{found:?}");
        let opposite = numbers("Fx_N", [-2.0, 2.0], |force, _| -0.2 * force);
        assert!((opposite.get("phase_deg").unwrap().abs() - 180.0).abs() < 1.0, "{opposite:?}");
        assert!(opposite.get("hysteresis").unwrap() < 0.01);
        assert!((opposite.get("slope_V_per_N").unwrap() + 0.2).abs() < 1e-3);
    }

    #[test]
    fn what_is_the_same_to_both_sides_is_symmetric() {
        let even = numbers("Fx_N", [-2.0, 2.0], |force, _| 0.1 * force * force);
        assert!(even.get("symmetry").unwrap() > 0.98, "{even:?}");
        assert!(even.get("from_zero_to_low_V").unwrap() > 0.3 && even.get("from_zero_to_high_V").unwrap() > 0.3);
        let odd = numbers("Fx_N", [-2.0, 2.0], |force, _| 0.1 * force);
        assert!(odd.get("symmetry").unwrap() < 0.02, "{odd:?}");
        let one_sided = numbers("Fy_N", [-2.0, 2.0], |force, _| force.max(0.0));
        assert!(one_sided.get("slope_high").unwrap() > 0.9 && one_sided.get("slope_low").unwrap().abs() < 0.1);
    }

    #[test]
    fn the_range_of_sensitivity_is_found() {
        let bent = numbers("J2_deg", [-10.0, 75.0], |angle, _| (1.0 - (angle + 10.0) / 38.0).max(0.0).powi(2));
        assert!(bent.get("beyond_30_share").unwrap() < 0.01, "{bent:?}");
        assert!(bent.get("up_to_25_share").unwrap() > 0.95);
        let flat = bent.get("flat_beyond_deg").unwrap();
        // A tenth is left at 16 degrees.
        assert!((flat - 16.0).abs() < 3.0, "{flat}");
        let straight = numbers("J2_deg", [-10.0, 75.0], |angle, _| angle);
        assert!(straight.get("beyond_30_share").unwrap() > 0.5, "{straight:?}");
    }

    #[test]
    fn a_dip_and_what_comes_back_are_found() {
        let dips = numbers("Fz_N", [-4.0, 0.0], |force, _| (-force - 1.0).powi(2) / 9.0 - 1.0 / 9.0);
        // The curve's ends lie half a bin within the range.
        assert!((dips.get("dip_V").unwrap() - 1.0 / 9.0).abs() < 0.012, "{dips:?}");
        assert!((dips.get("recovery_V").unwrap() - 1.0).abs() < 0.04);
        let rises = numbers("Fz_N", [-4.0, 0.0], |force, _| -force);
        assert!(rises.get("dip_V").unwrap() < 1e-6);
    }

    #[test]
    fn a_constant_output_has_neither_phase_nor_hysteresis() {
        let still = numbers("Fx_N", [-2.0, 2.0], |_, _| 1.0);
        assert_eq!(still.get("range_V"), Some(0.0));
        assert!(
            ["phase_deg", "hysteresis", "symmetry", "sd_share"].iter().all(|name| still.get(name).is_none()),
            "{still:?}"
        );
        assert_eq!(of_output(&Curve::default(), "Fx_N"), Numbers::default());
    }
}
