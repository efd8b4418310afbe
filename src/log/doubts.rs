//! Whether a finger can have done what a recording says, when it says so.
//!
//! Warned of, and nothing is changed. Milliseconds that are called seconds make every duration a thousand times as
//! long. A transducer reports the force of the surface on the finger as often as that of the finger on the surface, and
//! in any unit: a model that learnt from such a recording fits it well, and ever after answers with the wrong sign or
//! unit.

use super::lines::order::{median_step_s, short};

/// Below so many samples nothing is said of forces.
const SAMPLES: usize = 50;
/// Rows of a sensor are no further apart, seconds (assumed).
const APART_S: f64 = 1.0;
/// Samples left out at either end: spikes (assumed).
const SPIKES: f64 = 0.005;
/// More than a finger presses, newtons (assumed; norms of the strength of pinches: Mathiowetz et al., Archives of
/// Physical Medicine and Rehabilitation 66(2), 1985).
const MOST_N: f64 = 200.0;
/// An offset that is forgiven, newtons.
const OFFSET_N: f64 = 0.5;
/// How much further than it presses a finger may seem to pull (assumed).
pub(crate) const PULLED: f64 = 2.0;

/// What to say of a recording's times, which ascend.
pub(crate) fn time(time_s: &[f64]) -> Option<String> {
    let step_s = median_step_s(time_s).filter(|step_s| *step_s > APART_S)?;
    Some(format!(
        "rows are {} s apart, if the stamps are in seconds; write them in seconds, or say with --time-unit what they \
         are in",
        short(step_s)
    ))
}

/// The least and the greatest of the values that are known, but for spikes; of none 0.
pub(crate) fn without_spikes(values: &[f64]) -> [f64; 2] {
    let mut known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    known.sort_unstable_by(f64::total_cmp);
    let spikes = (SPIKES * known.len() as f64) as usize;
    // A negated 0 is written as 0.
    let at = |index: usize| known.get(index).copied().unwrap_or(0.0) + 0.0;
    [at(spikes), at(known.len().saturating_sub(1 + spikes))]
}

/// What to say of a recording's columns, those that are forces.
pub(crate) fn forces<'a>(columns: impl Iterator<Item = (&'a str, &'a [f64])>) -> Vec<String> {
    let mut doubts = Vec::new();
    for (name, values) in columns.filter(|(name, _)| matches!(*name, "Fx_N" | "Fy_N" | "Fz_N")) {
        if values.iter().filter(|value| value.is_finite()).count() < SAMPLES {
            continue;
        }
        let [least, greatest] = without_spikes(values);
        if greatest.max(-least) > MOST_N {
            doubts.push(format!(
                "{name} goes from {least:.0} to {greatest:.0} N, and no finger presses with more than {MOST_N} N: are \
                 the forces in newtons (1 gram is 0.00981 N)?"
            ));
        }
        if name == "Fz_N" && greatest > OFFSET_N && greatest > -PULLED * least {
            doubts.push(format!(
                "{name} goes from {least:.3} to {greatest:.3} N, as if the finger pulled: pressing is negative. Where \
                 these are forces of the surface on the finger, negate Fx_N, Fy_N and Fz_N; where the transducer was \
                 not zeroed, take its offset away"
            ));
        }
    }
    doubts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn milliseconds_that_are_called_seconds_are_doubted() {
        let every = |step_s: f64, count: usize| time(&(0..count).map(|k| step_s * k as f64).collect::<Vec<_>>());
        assert!(every(10.0, 50).is_some_and(|said| said.starts_with("rows are 10 s apart")), "{:?}", every(10.0, 50));
        assert_eq!([every(1.0, 400), every(10.0, 1), time(&[])], [None, None, None]);
    }

    #[test]
    fn a_sign_and_a_unit_that_no_finger_has_are_doubted_and_fingers_are_not() {
        // Presses of 5 N for half of the time.
        let press = |k: usize| if (k / 20).is_multiple_of(2) { 0.0 } else { -5.0 };
        let of = |name: &str, count: usize, value: &dyn Fn(usize) -> f64| {
            let values: Vec<f64> = (0..count).map(value).collect();
            forces(std::iter::once((name, &values[..])))
        };
        let doubted = |name: &str, value: &dyn Fn(usize) -> f64| of(name, 400, value).join(" ");
        for fine in [&press as &dyn Fn(usize) -> f64, &|k| press(k) + 1.0, &|_| 0.1, &|k| 20.0 * press(k)] {
            assert_eq!(doubted("Fz_N", fine), "");
        }
        // Spikes and missing values are no presses.
        assert_eq!(doubted("Fz_N", &|k| if k % 300 == 7 { 1e9 } else { press(k) }), "");
        assert_eq!(doubted("Fz_N", &|k| if k % 2 == 0 { f64::NAN } else { press(k) }), "");
        let other_sign = doubted("Fz_N", &|k| -press(k));
        assert!(other_sign.contains("from 0.000 to 5.000 N") && other_sign.contains("negate"), "{other_sign}");
        let grams = doubted("Fz_N", &|k| press(k) * 101.97);
        assert!(grams.contains("from -510 to 0 N") && grams.contains("in newtons"), "{grams}");
        // Shear has either sign, and the same units.
        assert_eq!(doubted("Fx_N", &|k| -press(k)), "");
        assert!(doubted("Fx_N", &|k| press(k) * -1000.0).contains("Fx_N goes from 0 to 5000 N"));
        // Both at once; and neither of what is no force, or of too few.
        assert_eq!(of("Fz_N", 400, &|k| press(k) * -1000.0).len(), 2);
        assert!(of("P1", 400, &|k| press(k) * -1000.0).is_empty() && of("Fz_N", 49, &|_| 1e4).is_empty());
    }
}
