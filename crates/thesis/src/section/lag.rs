//! The dynamic lag of Fig. 88: a photodiode under a force that grows steadily, and what it would show without dynamics.
//!
//! In: the parameters. Out: `fig-88`, both over time; the lag, in seconds: how much later than the output without
//! dynamics the output reaches its values, the mean over the second half of the ramp; and the time constant of a step
//! to the same load, the slowest that the output has (5.2.2, equation 19).
//!
//! The output without dynamics is that of the same ramp, [`SLOWER`] times as slow, at the same load.

use lunula_hemodynamics::{Load, Loads, Parameters};

use super::steps::{answer, change, steps};
use super::{RTOL, SectionText};
use lunula::files::Staging;
use lunula::hemodynamics::figures::{Curve, Panel, draw_over_time};
use lunula::hemodynamics::{HemodynamicsError, Pressed};

/// The greatest load, Pa: 0.5 N on 1 cm2. Further on the output bends (Fig. 78), and bending is no lag.
const LOAD_PA: f64 = 5e3;
/// How long the load takes to get there, s: 0.5 N/s, half of what 5.2.2 allows at 1 N.
const RAMP_S: f64 = 1.0;
/// Its lag is less than a hundredth of that of the fast one.
const SLOWER: f64 = 200.0;
/// Rows of the ramp.
const ROWS: u32 = 1000;

/// The light at the proximal photodiode under a proximal ramp that takes so long, at [`ROWS`] + 1 moments.
fn ramped(parameters: &Parameters, ramp_s: f64) -> Result<Vec<f64>, HemodynamicsError> {
    let of =
        |load_pa: f64| Load::ramp(0.0, load_pa, 0.0, ramp_s).map_err(|why| HemodynamicsError::Model(why.to_string()));
    let [proximal, distal] = Pressed::Proximal.of(LOAD_PA);
    let loads = Loads::on(parameters, of(proximal)?, of(distal)?);
    Ok(answer(parameters, &loads, &times_s(ramp_s), RTOL)?.photodiode_v(0))
}

fn times_s(ramp_s: f64) -> Vec<f64> {
    (0..=ROWS).map(|k| ramp_s * f64::from(k) / f64::from(ROWS)).collect()
}

/// How much later `late` has its values than `expected`, which has them in order; the mean over the second half.
fn lag_s(times_s: &[f64], expected: &[f64], late: &[f64]) -> Option<f64> {
    let sign = (expected.last()? - expected.first()?).signum();
    let one = |row: usize| {
        let after = expected.partition_point(|value| sign * value < sign * late[row]);
        let before = after.checked_sub(1)?;
        let share = (late[row] - expected[before]) / (expected.get(after)? - expected[before]);
        Some(times_s[row] - (times_s[before] + share * (times_s[after] - times_s[before])))
    };
    let all = (times_s.len() / 2..times_s.len()).map(one).collect::<Option<Vec<f64>>>()?;
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}

/// Draws and reports the lag.
pub(super) fn figure_88(text: &mut SectionText, parameters: &Parameters, staging: &Staging) -> anyhow::Result<()> {
    let (expected, late) = (ramped(parameters, SLOWER * RAMP_S)?, ramped(parameters, RAMP_S)?);
    let times_s = times_s(RAMP_S);
    let stepped = steps(parameters, Pressed::Proximal, &[LOAD_PA], RTOL)?;
    let constant =
        stepped.first().and_then(|one| change(&one.response.times_s, &one.response.photodiode_v(0)).constants_s[0]);
    text.numbers.set("fig88.lag_s", lag_s(&times_s, &expected, &late));
    text.numbers.set("fig88.constant_s", constant);
    let curve = |name: &str, values: Vec<f64>, colour: usize| Curve {
        name: Some(name.to_owned()),
        times_s: times_s.clone(),
        values,
        colour,
        width: 2,
    };
    let panel = Panel {
        title: "A ramp to 0.5 N/cm2 in 1 s: the photodiode lags behind".to_owned(),
        y: "VP1, V".to_owned(),
        curves: vec![curve("expected: without dynamics", expected, 0), curve("actual", late, 1)],
    };
    draw_over_time(&[panel], &staging.place("fig-88.png")?, &staging.place("fig-88.svg")?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_is_late_is_late_by_its_shift() {
        let times_s: Vec<f64> = (0..=100).map(|k| 0.01 * f64::from(k)).collect();
        let line = |late_s: f64| times_s.iter().map(|time_s| -3.0 * (time_s - late_s).max(0.0)).collect::<Vec<_>>();
        let found = lag_s(&times_s, &line(0.0), &line(0.125)).unwrap();
        assert!((found - 0.125).abs() < 1e-12, "{found}");
        assert_eq!(lag_s(&times_s, &[0.0; 101], &line(0.125)), None);
    }
}
