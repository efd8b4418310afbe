//! What all photodiodes of a sensor do together.
//!
//! A photodiode answers where its range is a tenth of the greatest or more: phase, sign and loop of one that does not
//! are those of noise. Means of shares are over those with a quarter or more.
//!
//! - `in_phase_share`, `same_sign_share`, `falling_share`: of those that answer; `more_above_share`: steeper above zero
//!   than below.
//! - `hysteresis`, `sd_share`, `beyond_30_share`, `up_to_25_share`: means; `hysteresis_others`: without P1 and P2.
//!   `sd_V`: mean over all.
//! - of each: `sensitivity_share`, range over the greatest, and `rank`, 1 the greatest.

use super::measure::mean;
use crate::Numbers;

/// Of the greatest range: who answers at all, and who answers well.
const ANSWERS: [f64; 2] = [0.1, 0.25];
/// In phase, degrees.
const IN_PHASE_DEG: f64 = 60.0;

/// Numbers of a sensor from those of its photodiodes.
pub(super) fn of_all(own: &[(String, Numbers)], drive: &str) -> Numbers {
    let mut numbers = Numbers::default();
    let range = |own: &Numbers| own.get("range_V");
    let greatest = own.iter().filter_map(|(_, own)| range(own)).fold(0.0, f64::max);
    for (name, one) in own {
        numbers.take(name, one);
        if let Some(own_range) = range(one).filter(|_| greatest > 0.0) {
            numbers.set(format!("{name}.sensitivity_share"), own_range / greatest);
            let above = own.iter().filter(|(_, other)| range(other).is_some_and(|other| other > own_range)).count();
            numbers.set(format!("{name}.rank"), 1.0 + above as f64);
        }
    }
    if greatest <= 0.0 {
        return numbers;
    }
    let answering = |least: f64| {
        let answers = move |own: &Numbers| range(own).is_some_and(|range| range >= least * greatest);
        own.iter().filter(move |(_, own)| answers(own))
    };
    let share = |holds: &dyn Fn(&Numbers) -> Option<bool>| {
        mean(answering(ANSWERS[0]).filter_map(|(_, own)| holds(own)).map(|held| if held { 1.0 } else { 0.0 }))
    };
    let unit = drive.rsplit('_').next().unwrap_or_default();
    let slope = format!("slope_V_per_{unit}");
    numbers.set("in_phase_share", share(&|own| Some(own.get("phase_deg")?.abs() <= IN_PHASE_DEG)));
    let falling = share(&|own| Some(own.get(&slope)? < 0.0));
    numbers.set("falling_share", falling);
    numbers.set("same_sign_share", falling.map(|share| share.max(1.0 - share)));
    numbers.set("more_above_share", share(&|own| Some(own.get("slope_high")?.abs() > own.get("slope_low")?.abs())));
    for name in ["hysteresis", "sd_share", "beyond_30_share", "up_to_25_share"] {
        numbers.set(name, mean(answering(ANSWERS[1]).filter_map(|(_, own)| own.get(name))));
    }
    let others = answering(ANSWERS[1]).filter(|(name, _)| !matches!(name.as_str(), "P1" | "P2"));
    numbers.set("hysteresis_others", mean(others.filter_map(|(_, own)| own.get("hysteresis"))));
    numbers.set("sd_V", mean(own.iter().filter_map(|(_, own)| own.get("sd_V"))));
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(range: f64, slope: f64, phase: f64) -> Numbers {
        let mut numbers = Numbers::default();
        numbers.set("range_V", range);
        numbers.set("slope_V_per_N", slope);
        numbers.set("phase_deg", phase);
        numbers.set("hysteresis", range / 10.0);
        numbers
    }

    #[test]
    fn those_that_do_not_answer_have_no_say() {
        let own = [("P1", one(0.01, -1.0, 170.0)), ("P2", one(1.0, 1.0, 5.0)), ("P3", one(0.5, 1.0, -50.0))];
        let found = of_all(&own.map(|(name, numbers)| (name.to_owned(), numbers)), "Fx_N");
        assert_eq!((found.get("in_phase_share"), found.get("same_sign_share")), (Some(1.0), Some(1.0)));
        assert_eq!((found.get("P3.rank"), found.get("P1.sensitivity_share")), (Some(2.0), Some(0.01)));
        assert!((found.get("hysteresis").unwrap() - 0.075).abs() < 1e-12);
        assert_eq!(found.get("hysteresis_others"), Some(0.05));
        assert_eq!(found.get("beyond_30_share"), None);
    }

    #[test]
    fn a_sensor_that_shows_nothing_has_no_shares() {
        let found = of_all(&[("P1".to_owned(), one(0.0, 0.0, 0.0))], "Fx_N");
        assert_eq!(found.get("in_phase_share"), None);
        assert_eq!(of_all(&[], "Fx_N"), Numbers::default());
    }
}
