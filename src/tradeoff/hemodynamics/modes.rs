//! Every mode of the solver on step responses.

use lunula_hemodynamics::{Collapse, Model, Order, SolveOptions, Trajectory};

use super::bench::{AUTO, Bench};
use super::{ERROR, SOLVING};
use crate::tradeoff::measure::rows::Measured;
use crate::tradeoff::measure::timing::{Effort, in_turns};

const TOLERANCES: [f64; 10] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12];
const FIXED_S: [f64; 4] = [1e-2, 5e-3, 2e-3, 1e-3];
/// Samples a second of live signals.
const LIVE_HZ: [u32; 3] = [100, 500, 1000];

/// What `lunula simulate` does.
pub(in crate::tradeoff) fn solving_default() -> String {
    format!("{AUTO}, {:.0e}", SolveOptions::default().rtol)
}

/// How the responses are solved.
enum Way<'a> {
    Full(&'a Model, SolveOptions),
    Live(u32),
}

/// Measures every setting.
///
/// # Errors
/// No reference; [`Interrupted`](crate::job::Interrupted).
pub fn measure(effort: &Effort) -> anyhow::Result<Measured> {
    let bench = Bench::new()?;
    // The same solver on the equations as they are printed, whose resistances cancel.
    let printed = Model::printed(&bench.parameters, Collapse::Error)?;
    let ways = ways(&bench.model, &printed);
    let mut measured = Measured::default();
    let mut found = Trajectory::default();
    let each = in_turns(&ways, effort, |(_, way), first| match way {
        Way::Full(model, options) => bench.full(model, options, first, &mut found),
        Way::Live(hz) => bench.live(*hz, first),
    })?;
    for ((setting, _), found) in ways.iter().zip(each) {
        measured.add(SOLVING, setting, ERROR, found);
    }
    Ok(measured)
}

/// Every setting with its name.
fn ways<'a>(model: &'a Model, printed: &'a Model) -> Vec<(String, Way<'a>)> {
    let orders = [
        (AUTO, Order::Auto),
        ("full, order 5", Order::Fifth),
        ("full, order 9", Order::Ninth),
        ("full, order 13", Order::Thirteenth),
    ];
    let mut ways = Vec::new();
    for (name, order) in orders {
        for rtol in TOLERANCES {
            let options = SolveOptions { order, ..SolveOptions::at(rtol) };
            ways.push((format!("{name}, {rtol:.0e}"), Way::Full(model, options)));
        }
    }
    for step_s in FIXED_S {
        let options = SolveOptions { fixed_step_s: Some(step_s), ..SolveOptions::at(1e-8) };
        ways.push((format!("full, fixed step, {step_s} s"), Way::Full(model, options)));
    }
    for hz in LIVE_HZ {
        ways.push((format!("live, {hz} Hz"), Way::Live(hz)));
    }
    for rtol in TOLERANCES {
        ways.push((format!("printed form, {rtol:.0e}"), Way::Full(printed, SolveOptions::at(rtol))));
    }
    ways
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_take_turns_and_the_default_is_one_of_them() {
        let bench = Bench::new().unwrap();
        let printed = Model::printed(&bench.parameters, Collapse::Error).unwrap();
        let ways = ways(&bench.model, &printed);
        assert_eq!(ways.iter().filter(|(name, _)| *name == solving_default()).count(), 1);
        let mut found = Trajectory::default();
        let options = SolveOptions::default();
        let (_, scored) = bench.full(&bench.model, &options, true, &mut found).unwrap();
        let (error, work) = scored.unwrap();
        assert!(error < 1e-7 && work > 0, "{error} {work}");
        let (seconds, again) = bench.full(&bench.model, &options, false, &mut found).unwrap();
        assert!(seconds > 0.0 && again.is_none());
        let (live, scored) = bench.live(LIVE_HZ[0], true).unwrap();
        assert!(live > 0.0 && scored.unwrap().0 < 1e-6);
    }
}
