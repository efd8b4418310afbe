//! Whether the loads of a recording have the sign of pressing, and photodiodes that of the model.
//!
//! Warned of, and nothing is changed. The model answers to suction as well, so a recording of the other sign is fitted
//! too: by other values, with small standard errors.

use lunula_hemodynamics::FitResult;

use super::ReadRecording;
use crate::hemodynamics::given::{SUCTION, hardly_pressed};
use crate::log::doubts::{self, PULLED, cut_off};
use crate::log::rest::{Pressing, not_at_zero, without_spikes};

/// Pressures below this share of the recording's largest are noise or an offset (assumed).
const NOISE: f64 = 0.05;
/// A rest this near to 0, as a share of that, is at 0 (assumed).
const RESTS: f64 = 0.01;
/// So many standard errors below 0, a scaling is negative.
const SURE: f64 = 3.0;

/// What to say of a force of the finger on the surface, newtons. `is_log`: its reading has said what it doubts.
pub(super) fn of_force(name: &str, forces_n: &[f64], is_log: bool) -> Vec<String> {
    let cut = cut_off(name, forces_n);
    let doubted = doubts::forces(std::iter::once((name, forces_n)));
    if !doubted.is_empty() {
        return if is_log { cut } else { [cut, doubted].concat() };
    }
    // A fit's forces may all lie below what is forgiven there.
    let [least, greatest] = without_spikes(forces_n);
    let pulled = greatest > 0.0 && greatest > -PULLED * least;
    let said = pulled.then(|| {
        format!(
            "{name} goes from {least:.3} to {greatest:.3} N, as if the finger pulled: pressing is negative. Turn its \
             sign where it is the force of the surface on the finger; where the transducer was not zeroed, take its \
             offset away"
        )
    });
    let rests = if pulled || is_log { None } else { doubts::resting(name, forces_n) };
    cut.into_iter().chain(said).chain(rests).collect()
}

/// That a load that changes never comes near 0, beside a largest one.
pub(super) fn never_rests(name: &str, values: &[f64], largest: f64) -> Option<String> {
    let sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    let [least, greatest] = without_spikes(&sizes);
    (least > NOISE * largest && greatest > least).then(|| {
        format!(
            "{name} never comes near 0 (its least is {:.0} % of its greatest): an offset of what measured it is not \
             seen here, and moves what is fitted (300 Pa on 500 to 5500 moved k_C by 8 of its standard errors); \
             compare it with what it reads unloaded",
            100.0 * least / greatest
        )
    })
}

/// A load that changes in more than this share of rows does not step (steps: 0.05 at most; pulses: all).
const MOVES: f64 = 0.5;

/// What to say of a load that changes from row to row, and is taken to step.
pub(super) fn moves(name: &str, values: &[f64]) -> Option<String> {
    let changes = values.windows(2).filter(|pair| pair[0] != pair[1]).count();
    (changes as f64 > MOVES * values.len() as f64).then(|| {
        format!(
            "{name} changes in {changes} of {} rows, and --between held takes it to stay from row to row: it comes \
             late by half a row, and the damping found is too small. Leave --between out where it moves between rows",
            values.len()
        )
    })
}

/// What to say of a load that steps, and is taken to go straight from row to row: of a prescribed one every change
/// stands between rows that stay, and a measured one has rows on its way, and noise.
pub(super) fn steps(name: &str, values: &[f64]) -> Option<String> {
    let runs: Vec<&[f64]> = values.chunk_by(|a, b| a == b).collect();
    (runs.len() > 1 && runs.iter().all(|run| run.len() > 1)).then(|| {
        format!(
            "{name} steps from one row to the next, {} time(s), and is taken to go straight between the two: say \
             --between held, and --unloaded-before where its first row is already a step up from 0",
            runs.len() - 1
        )
    })
}

/// What to say of pressures, Pa.
pub(super) fn of_pressures(columns: [(&str, &[f64]); 2]) -> Vec<String> {
    let ranges = columns.map(|(_, pressures_pa)| without_spikes(pressures_pa));
    let largest = ranges.as_flattened().iter().fold(0.0, |largest: f64, pa| largest.max(pa.abs()));
    let hardly = hardly_pressed(&columns);
    let one = |((name, pressures_pa), [least, greatest]): ((&str, &[f64]), [f64; 2])| {
        let sucked = pressures_pa.iter().filter(|pa| **pa < 0.0).count();
        let pressed = pressures_pa.iter().filter(|pa| **pa > 0.0).count();
        (sucked > pressed && least < -NOISE * largest).then(|| {
            format!(
                "{name} goes from {least:.0} to {greatest:.0} Pa and is negative in {sucked} of the {} rows in which \
                 it is not 0: {SUCTION}. Turn its sign where it was computed from a negative force that presses",
                sucked + pressed
            )
        })
    };
    let cut = columns.into_iter().flat_map(|(name, pressures_pa)| cut_off(name, pressures_pa));
    let said: Vec<String> = columns.into_iter().zip(ranges).filter_map(one).chain(hardly).chain(cut).collect();
    let rests = |(name, values): (&str, &[f64])| not_at_zero(name, "Pa", RESTS * largest, values, Pressing::Positive);
    if said.is_empty() { columns.into_iter().filter_map(rests).collect() } else { said }
}

/// What to say of scalings: `V_1` is a photodiode's sensitivity, the LED's brightness and losses (equation 4), and no
/// one of these is negative.
pub(in crate::hemodynamics::fit) fn of_scalings(result: &FitResult, recordings: &[ReadRecording]) -> Option<String> {
    let is_negative = |value: f64, sd: Option<f64>| sd.is_some_and(|sd| value + SURE * sd < 0.0);
    let negative = result.photodiodes.iter().filter(|one| is_negative(one.scaling.value, one.scaling.standard_error));
    let names: Vec<String> = negative
        .map(|one| {
            let first = one.recordings.first().and_then(|&k| recordings.get(k));
            first.map_or(format!("unit {}", one.unit + 1), |first| format!("unit {} of {}", one.unit + 1, first.name))
        })
        .collect();
    (!names.is_empty()).then(|| {
        format!(
            "the scaling V_1 is negative for {}, as if more light gave less voltage: right only where an amplifier \
             inverts; else look at the sign of the loads and at which column is above which unit (--photodiode)",
            names.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Presses for a third of the time.
    fn presses(high: f64, count: usize) -> Vec<f64> {
        (0..count).map(|k| if k % 30 < 10 { high } else { 0.0 }).collect()
    }

    #[test]
    fn a_load_that_moves_from_row_to_row_does_not_step() {
        let pulse: Vec<f64> = (0..300).map(|k| 3000.0 + 1000.0 * (0.1 * f64::from(k)).sin()).collect();
        assert!(moves("pf1_Pa", &pulse).is_some_and(|said| said.starts_with("pf1_Pa changes in 299 of 300 rows")));
        assert_eq!(
            [&presses(3000.0, 300), &vec![3000.0; 300], &Vec::new()].map(|load| moves("pf1_Pa", load)),
            [(); 3].map(|()| None)
        );
    }

    #[test]
    fn a_load_that_steps_does_not_go_straight() {
        let step = [vec![5000.0; 100], vec![0.0; 100]].concat();
        let said = steps("pf1_Pa", &step).expect("a step");
        assert!(said.starts_with("pf1_Pa steps from one row to the next, 1 time(s)"), "{said}");
        let ramp: Vec<f64> = (0..200).map(|k| f64::from(k.clamp(50, 150))).collect();
        let noisy: Vec<f64> = step.iter().enumerate().map(|(k, pa)| pa + (k % 3) as f64).collect();
        for load in [&ramp, &noisy, &vec![5000.0; 100], &Vec::new()] {
            assert_eq!(steps("pf1_Pa", load), None);
        }
    }

    #[test]
    fn a_load_that_never_rests_is_said() {
        let wave = |mean: f64| (0..300).map(|k| mean + 2500.0 * (0.1 * f64::from(k)).sin()).collect::<Vec<f64>>();
        let said = never_rests("pf1_Pa", &wave(3000.0), 5500.0);
        assert!(said.is_some_and(|said| said.starts_with("pf1_Pa never comes near 0 (its least is 9 % of")));
        let newtons: Vec<f64> = wave(3000.0).iter().map(|pa| -1e-3 * pa).collect();
        assert!(never_rests("F_N", &newtons, 5.5).is_some());
        assert_eq!(never_rests("pf2_Pa", &wave(3000.0), 5e5), None, "it hardly presses");
        for load in [wave(2500.0), vec![3000.0; 300], vec![0.0; 300], Vec::new()] {
            assert_eq!(never_rests("pf1_Pa", &load, 5500.0), None);
        }
    }

    #[test]
    fn forces_that_pull_are_doubted_however_small() {
        let said = |forces_n: &[f64]| of_force("F_N", forces_n, false).join(" ");
        assert!(said(&presses(0.3, 300)).contains("F_N goes from 0.000 to 0.300 N"), "{}", said(&presses(0.3, 300)));
        assert!(said(&presses(0.3, 30)).contains("as if the finger pulled"));
        for fine in [presses(-0.3, 300), presses(-0.3, 30), presses(0.0, 30), vec![-0.3, -0.3, 0.5], Vec::new()] {
            assert_eq!(said(&fine), "");
        }
        // A spike is no press.
        let mut spiked = presses(-0.3, 300);
        spiked[7] = 50.0;
        assert_eq!(said(&spiked), "");
        // What a log's reading says too is said once.
        let [table, log] = [false, true].map(|is_log| of_force("Fz_N", &presses(1e4, 300), is_log));
        assert_eq!((table.len(), log.len()), (2, 0), "{table:?}");
        assert!(table[0].contains("from 0 to 10000 N") && table[1].contains("as if the finger pulled"), "{table:?}");
    }

    #[test]
    fn loads_that_are_cut_off_are_doubted() {
        let pressure = |k: usize| 2500.0 - 2500.0 * (0.05 * k as f64).cos() + ((k * k) % 13) as f64;
        let all = |most: f64| (0..600).map(|k| pressure(k).min(most)).collect::<Vec<f64>>();
        let said = |most: f64| of_pressures([("pf1_Pa", &all(most)), ("pf2_Pa", &all(6e3))]).concat();
        assert!(said(4e3).starts_with("pf1_Pa stays at exactly 4000, its greatest value"), "{}", said(4e3));
        assert_eq!(said(6e3), "");
        let force: Vec<f64> = all(4e3).iter().map(|pa| -1e-4 * pa).collect();
        assert!(of_force("Fz_N", &force, true).concat().contains("its least value"));
    }

    #[test]
    fn pressures_that_suck_are_doubted_and_noise_is_not() {
        let said = |first: &[f64], second: &[f64]| of_pressures([("pf1_Pa", first), ("pf2_Pa", second)]);
        let (pressed, sucked) = (presses(5000.0, 300), presses(-5000.0, 300));
        assert_eq!((said(&pressed, &pressed).len(), said(&sucked, &sucked).len()), (0, 2));
        let one = said(&sucked, &pressed);
        assert!(one.len() == 1 && one[0].starts_with("pf1_Pa goes from -5000 to 0 Pa"), "{one:?}");
        assert!(one[0].contains("in 100 of the 100 rows"), "{one:?}");
        // An offset below 0, a short pull, nothing at all.
        let offset: Vec<f64> = pressed.iter().map(|pa| pa - 20.0).collect();
        let pull: Vec<f64> = (0..300).map(|k| if k < 5 { -5000.0 } else { pressed[k] }).collect();
        let noise: Vec<f64> = (0..300).map(|k| 15.0 * f64::from(k * k % 7 - 3)).collect();
        for fine in [offset, pull, vec![-20.0; 300], vec![20.0; 300], vec![0.0; 300], noise] {
            assert_eq!(said(&fine, &pressed), Vec::<String>::new());
        }
        assert!(said(&[], &[]).is_empty());
        let one = said(&pressed, &presses(3.0, 300));
        assert!(one.len() == 1 && one[0].starts_with("no pressure of pf2_Pa is greater than 3 Pa, and"), "{one:?}");
        let in_kpa = said(&presses(5.0, 300), &presses(3.0, 300));
        assert!(in_kpa.len() == 1 && in_kpa[0].contains("greater than 5 Pa"), "{in_kpa:?}");
    }
}
