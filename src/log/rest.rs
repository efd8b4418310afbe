//! Where a load rests: a transducer that was not zeroed.
//!
//! A force that is off all along teaches a model to be off by as much, and nothing else of a recording shows it: 0.3 N
//! leave RMSE and R2 of the training as they are, and a third of the true forces in their 90 % intervals; 300 Pa of
//! 5000 put a stiffness 8 standard errors from the truth.

use super::lines::order::short;
use crate::median::median_of;

/// Below so many values, or so many means of values, nothing is said.
const LEAST_VALUES: usize = 50;
const LEAST_MEANS: usize = 20;
/// So many means a recording, of rows one behind the other, as far as rows allow it.
const MEANS: usize = 200;
const ROWS: [usize; 2] = [6, 25];
/// A rest stays within this share of the range, or so many times the noise; it has this share of all means, and so
/// many times those just above it: a force that goes to and fro has about 1.4 times (a sine at its turn, whatever its
/// period). All of these were chosen on phantoms.
const WITHIN: f64 = 0.005;
const NOISES: f64 = 2.0;
const SHARE: f64 = 0.05;
const STEEP: usize = 4;
/// Means below a rest, and at 0 where the rest is another, that are forgiven.
const FORGIVEN: f64 = 0.02;
/// A rest this near to 0, as a share of the range, is at 0.
const ZEROED: f64 = 0.01;

/// Samples left out at either end: spikes (assumed).
const SPIKES: f64 = 0.005;

/// How a load that presses is written.
#[derive(Clone, Copy)]
pub(crate) enum Pressing {
    Positive,
    Negative,
}

/// What to say of a load that rests elsewhere than at 0: by more than `least`, in `unit`.
pub(crate) fn not_at_zero(name: &str, unit: &str, least: f64, values: &[f64], pressing: Pressing) -> Option<String> {
    let sign = match pressing {
        Pressing::Positive => 1.0,
        Pressing::Negative => -1.0,
    };
    let loads: Vec<f64> = values.iter().filter(|value| value.is_finite()).map(|value| sign * value).collect();
    let (rest, share) = rest(&loads).filter(|(rest, _)| rest.abs() > least)?;
    Some(format!(
        "{name} rests at {} {unit}, in {:.0} % of its rows, and hardly ever at 0: if nothing touches then, take so \
         much away from all of it",
        short(sign * rest),
        100.0 * share
    ))
}

/// Where loads rest other than at 0, and the share of time that they do.
fn rest(loads: &[f64]) -> Option<(f64, f64)> {
    if loads.len() < LEAST_VALUES {
        return None;
    }
    let [least, greatest] = without_spikes(loads);
    let range = greatest.max(0.0) - least.min(0.0);
    let windows = loads.chunks_exact((loads.len() / MEANS).clamp(ROWS[0], ROWS[1]));
    let of_window = |window: &[f64]| {
        let mean = window.iter().sum::<f64>() / window.len() as f64;
        let squares: f64 = window.iter().map(|value| (value - mean).powi(2)).sum();
        (mean, (squares / (window.len() - 1) as f64).sqrt())
    };
    let (mut means, mut noises): (Vec<f64>, Vec<f64>) = windows.map(of_window).unzip();
    means.sort_unstable_by(f64::total_cmp);
    noises.sort_unstable_by(f64::total_cmp);
    if means.len() < LEAST_MEANS {
        return None;
    }
    let within = (NOISES * noises[noises.len() / 10]).max(WITHIN * range);
    let all = means.len() as f64;
    let lightest = means[(FORGIVEN * all) as usize];
    let rest = median_of(means.iter().copied().filter(|mean| (mean - lightest).abs() <= 2.0 * within))?;
    let count =
        |from: f64, to: f64| means.partition_point(|mean| *mean <= to) - means.partition_point(|mean| *mean < from);
    let resting = count(rest - within, rest + within);
    let above = count((rest + within).next_up(), rest + 5.0 * within);
    let few = |count: usize| count as f64 <= FORGIVEN * all;
    let is_rest = resting as f64 >= SHARE * all
        && resting >= STEEP * above
        && few(count(f64::NEG_INFINITY, (rest - within).next_down()))
        && 10.0 * within <= range;
    let is_at_zero = rest.abs() <= within.max(ZEROED * range) || !few(count(-within, within));
    (is_rest && !is_at_zero).then_some((rest, resting as f64 / all))
}

/// The least and the greatest of the values that are known, but for spikes; of none 0.
pub(crate) fn without_spikes(values: &[f64]) -> [f64; 2] {
    let mut known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let Some(last) = known.len().checked_sub(1) else { return [0.0; 2] };
    let spikes = (SPIKES * known.len() as f64) as usize;
    // Logs are long, and need not be sorted whole. A negated 0 is written as 0.
    [spikes, last - spikes].map(|rank| *known.select_nth_unstable_by(rank, f64::total_cmp).1 + 0.0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Presses for 2 s of 4, at 25 rows a second.
    fn presses(k: usize) -> f64 {
        (0.5 + 4.0 * (TAU * k as f64 / 100.0).sin()).clamp(0.0, 1.0) * 2.0
    }

    fn noise(k: usize) -> f64 {
        (((k * 7919 + 31) * (k + 17)) % 2003) as f64 / 1001.0 - 1.0
    }

    fn said(of: impl Fn(usize) -> f64) -> Option<String> {
        let values: Vec<f64> = (0..1500).map(of).collect();
        not_at_zero("Fz_N", "N", 0.02, &values, Pressing::Negative)
    }

    #[test]
    fn a_rest_elsewhere_than_at_0_is_seen_and_one_at_0_is_none() {
        for noise_n in [0.0, 0.001, 0.02, 0.08] {
            let with = |offset_n: f64, sign: f64| said(|k| sign * -presses(k) + offset_n + noise_n * noise(k));
            for offset_n in [-0.3, -0.12, 0.12, 0.5] {
                let said = with(offset_n, 1.0).unwrap_or_default();
                assert!(
                    said.starts_with(&format!("Fz_N rests at {:.1}", offset_n)[..15]),
                    "{noise_n} {offset_n}: {said}"
                );
            }
            assert_eq!(with(0.0, 1.0), None, "{noise_n}");
            // The other sign, which is another fault, rests at 0 as well.
            assert_eq!(with(0.0, -1.0), None, "{noise_n}");
        }
        // Nothing presses, and the transducer says that something does.
        assert!(said(|k| -0.3 + 0.001 * noise(k)).is_some());
        assert_eq!(said(|k| 0.001 * noise(k)), None);
    }

    #[test]
    fn loads_that_never_rest_are_no_offsets() {
        for period in [50.0, 250.0, 750.0, 3000.0] {
            for noise_n in [0.0, 0.01, 0.05] {
                let sine = |k: usize| (TAU * k as f64 / period).sin() - 1.5 + noise_n * noise(k);
                assert_eq!(said(sine), None, "{period} {noise_n}");
            }
        }
        // A hand that holds, and drifts.
        let held = |k: usize| -1.0 - presses(k) + 0.15 * (0.031 * k as f64).sin() + 0.1 * (0.0113 * k as f64).cos();
        assert_eq!(said(held), None);
    }

    #[test]
    fn few_values_and_none_say_nothing() {
        let values = [f64::NAN, -0.3, -0.3, -2.0];
        assert_eq!(not_at_zero("Fz_N", "N", 0.02, &values, Pressing::Negative), None);
        assert_eq!(not_at_zero("Fz_N", "N", 0.02, &[f64::NAN; 500], Pressing::Negative), None);
        let pressed: Vec<f64> = (0..400).map(|k| 300.0 + 2500.0 * presses(k)).collect();
        let said = not_at_zero("pf1_Pa", "Pa", 0.0, &pressed, Pressing::Positive);
        assert!(said.is_some_and(|said| said.starts_with("pf1_Pa rests at 300 Pa")));
    }
}
