//! Which equilibria: the options of `lunula simulate --static` and of a pipeline's stage.

use std::str::FromStr;

use clap::Args;
use serde::Serialize;

use crate::hemodynamics::choices::Pressed;
use crate::hemodynamics::given::{BloodOptions, ModelOptions};
use crate::hemodynamics::grid::{multiple, multiples_within};
use crate::job::one_of;

/// Loads from one to another by steps, Pa; the last is left out where the steps don't meet it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LoadRange {
    /// The first.
    pub from_pa: f64,
    /// Not beyond.
    pub to_pa: f64,
    /// Between two.
    pub step_pa: f64,
}

const MOST_LOADS: f64 = 1e5;

impl LoadRange {
    /// The loads, Pa.
    #[must_use]
    pub fn loads_pa(&self) -> Vec<f64> {
        let count = multiples_within(self.to_pa - self.from_pa, self.step_pa) as usize;
        (0..count).map(|k| self.from_pa + multiple(k, self.step_pa)).collect()
    }
}

impl FromStr for LoadRange {
    type Err = String;

    /// `FROM..TO/STEP`, as `0..12000/100`; a single load is `FROM`.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text:?} is not a range of loads: write FROM..TO/STEP in pascals, as 0..12000/100");
        let number = |part: &str| part.trim().parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(wrong);
        let Some((from, rest)) = text.split_once("..") else {
            let only = number(text)?;
            return Ok(Self { from_pa: only, to_pa: only, step_pa: 1.0 });
        };
        let (to, step) = rest.split_once('/').ok_or_else(wrong)?;
        let range = Self { from_pa: number(from)?, to_pa: number(to)?, step_pa: number(step)? };
        if range.step_pa <= 0.0 {
            return Err(format!("{text:?}: the step has to be more than 0 Pa, as 0..12000/100"));
        }
        if range.to_pa < range.from_pa {
            return Err(format!("{text:?}: ends before it begins; write the smaller load first"));
        }
        let count = multiples_within(range.to_pa - range.from_pa, range.step_pa);
        if count > MOST_LOADS {
            return Err(format!("{text:?}: {count:.3e} loads are more than {MOST_LOADS:e}; choose a longer step"));
        }
        Ok(range)
    }
}

/// Which loads, and what they press on.
#[derive(Debug, Clone, Args)]
pub struct CurveRange {
    /// Equilibria instead of a run: for these loads, in pascals
    #[arg(long = "static", id = "static", value_name = "FROM..TO/STEP", allow_hyphen_values = true)]
    pub loads: LoadRange,
    /// What the loads of --static press on
    #[arg(long = "load", value_parser = one_of::<Pressed>(), default_value = "both", requires = "static")]
    pub pressed: Pressed,
}

/// How equilibria are found.
#[derive(Debug, Clone, Args)]
pub struct CurveOptions {
    /// The loads.
    #[command(flatten)]
    pub range: CurveRange,
    /// The pressures of the blood, which have to be constants.
    #[command(flatten)]
    pub blood: BloodOptions,
    /// The model.
    #[command(flatten)]
    pub model: ModelOptions,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_read_and_counted() {
        let range: LoadRange = "0..12000/100".parse().unwrap();
        let loads = range.loads_pa();
        assert_eq!((loads.len(), loads[0], loads[120]), (121, 0.0, 12_000.0));
        assert_eq!("5e3".parse::<LoadRange>().unwrap().loads_pa(), [5e3]);
        assert_eq!("-100..100/150".parse::<LoadRange>().unwrap().loads_pa(), [-100.0, 50.0]);
    }

    #[test]
    fn the_reason_is_given_for_what_is_not_a_range() {
        for (text, why) in [
            ("0..1e9/1", "more than"),
            ("5..1/1", "before"),
            ("0..1/0", "more than 0"),
            ("0..1", "FROM..TO/STEP"),
            ("0..nan/1", "FROM..TO/STEP"),
            ("a", "FROM..TO/STEP"),
        ] {
            let why_not = text.parse::<LoadRange>().unwrap_err();
            assert!(why_not.contains(why), "{text}: {why_not}");
        }
    }
}
