//! Every mode of the solver on step responses.

use std::hint::black_box;
use std::time::Instant;

use anyhow::anyhow;
use lunula_hemodynamics::{
    Collapse, Live, Load, Loads, Model, Order, Parameters, SolveOptions, Solver, State, Trajectory, rest,
};

use super::{ERROR, SOLVING, python};
use crate::tradeoff::peers::Python;
use crate::tradeoff::rows::{Measured, Row};
use crate::tradeoff::timing::{Effort, Run, in_turns};

/// What is measured.
#[derive(Debug, Clone)]
pub struct Settings {
    /// How much.
    pub effort: Effort,
    /// What runs other programs.
    pub python: Python,
}

/// The series that stands for lunula among its peers.
pub(super) const AUTO: &str = "lunula";
/// Tolerances that are asked for.
const TOLERANCES: [f64; 10] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12];
/// Fixed steps, s.
const FIXED_S: [f64; 4] = [1e-2, 5e-3, 2e-3, 1e-3];
/// Samples a second of live signals.
const LIVE_HZ: [u32; 3] = [100, 500, 1000];
/// A response's length, s, and its outputs a second.
const SECONDS: u32 = 4;
const RATE: u32 = 100;
/// The reference's tolerance.
const REFERENCE: f64 = 1e-13;

/// A step response to be solved.
pub(super) struct Case {
    loads: Loads,
    /// Whether proximal, else distal.
    pub(super) proximal: bool,
    pub(super) load_pa: f64,
    pub(super) reference: Trajectory,
}

/// The model, its start and the responses.
pub(super) struct Bench {
    parameters: Parameters,
    model: Model,
    pub(super) start: State,
    pub(super) times_s: Vec<f64>,
    pub(super) cases: Vec<Case>,
}

/// What `lunula simulate` does.
pub(in crate::tradeoff) fn solving_default() -> String {
    format!("{AUTO}, {:.0e}", SolveOptions::default().rtol)
}

/// What is told of a setting: its error, its work a response.
type Told = (f64, u64);

/// How the responses are solved.
enum Way<'a> {
    Full(&'a Model, SolveOptions),
    Live(u32),
}

/// Measures every setting, and other programs.
///
/// # Errors
/// No reference; [`Interrupted`](crate::tradeoff::Interrupted).
pub fn measure(settings: &Settings) -> anyhow::Result<Measured> {
    let bench = Bench::new()?;
    // The same solver on the equations as they are printed, whose resistances cancel.
    let printed = Model::printed(&bench.parameters, Collapse::Error)?;
    let ways = ways(&bench.model, &printed);
    let mut measured = Measured::default();
    let mut found = Trajectory::default();
    let each = in_turns(&ways, &settings.effort, |(_, way), first| match way {
        Way::Full(model, options) => bench.full(model, options, first, &mut found),
        Way::Live(hz) => bench.live(*hz, first),
    })?;
    for ((setting, _), found) in ways.iter().zip(each) {
        match found {
            Ok((time, (error, work))) => measured.rows.push(Row::own(SOLVING, setting, (error, ERROR), time, work)),
            Err(why) => measured.refused.push(format!("{setting}: {why:#}")),
        }
    }
    python::measure(&bench, settings, &mut measured)?;
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

impl Bench {
    fn new() -> anyhow::Result<Self> {
        let parameters = Parameters::thesis();
        let model = Model::new(&parameters, Collapse::Error);
        let times_s: Vec<f64> = (1..=SECONDS * RATE).map(|k| f64::from(k) / f64::from(RATE)).collect();
        let zero = || Load::constant(0.0);
        let unloaded = Loads::on(&parameters, zero()?, zero()?);
        let start = rest(&model, &unloaded.at(0.0))?.state;
        let mut cases = Vec::new();
        let options = SolveOptions { order: Order::Thirteenth, start_s: Some(0.0), ..SolveOptions::at(REFERENCE) };
        for k in 1..=10 {
            let step = || Load::step(1e3 * f64::from(k), 0.0, 2.0);
            for proximal in [true, false] {
                let (on, off) = (step()?, zero()?);
                let loads = if proximal { Loads::on(&parameters, on, off) } else { Loads::on(&parameters, off, on) };
                let mut reference = Trajectory::default();
                Solver::new(&model)
                    .run(&loads, &start, &times_s, &options, &mut reference)
                    .map_err(|why| anyhow!("the reference: {why}"))?;
                cases.push(Case { loads, proximal, load_pa: 1e3 * f64::from(k), reference });
            }
        }
        Ok(Self { parameters, model, start, times_s, cases })
    }

    /// Seconds a response of what `solve` makes of every case; the first time also error and work, which warms up.
    fn over(
        &self,
        first: bool,
        found: &mut Trajectory,
        mut solve: impl FnMut(&Case, &mut Trajectory) -> anyhow::Result<()>,
    ) -> Run<Told> {
        let told = if first { Some(self.told(found, &mut solve)?) } else { None };
        let begin = Instant::now();
        for case in &self.cases {
            solve(black_box(case), found)?;
            black_box(&*found);
        }
        Ok((begin.elapsed().as_secs_f64() / self.cases.len() as f64, told))
    }

    fn told(
        &self,
        found: &mut Trajectory,
        solve: &mut impl FnMut(&Case, &mut Trajectory) -> anyhow::Result<()>,
    ) -> anyhow::Result<Told> {
        let (mut error, mut work) = (0.0_f64, 0);
        for case in &self.cases {
            solve(case, found)?;
            anyhow::ensure!(found.len() == self.times_s.len(), "it ended early");
            for k in 0..found.len() {
                for (own, exact) in found.lumens(k).iter().zip(case.reference.lumens(k)) {
                    let miss = (own - exact).abs();
                    anyhow::ensure!(miss.is_finite(), "it is no number");
                    error = error.max(miss);
                }
            }
            work += found.statistics().evaluations;
        }
        Ok((error, work / self.cases.len() as u64))
    }

    fn full(&self, model: &Model, options: &SolveOptions, first: bool, found: &mut Trajectory) -> Run<Told> {
        let options = SolveOptions { start_s: Some(0.0), ..options.clone() };
        let mut solver = Solver::new(model);
        self.over(first, found, |case, found| {
            Ok(solver.run(&case.loads, &self.start, &self.times_s, &options, found)?)
        })
    }

    /// Sample by sample, a step each; where the load jumps, it is told so.
    fn live(&self, hz: u32, first: bool) -> Run<Told> {
        let sample_s = 1.0 / f64::from(hz);
        let mut live = Live::new(&self.model, &self.start, &self.cases[0].loads.at(0.0), sample_s)?;
        let (mut error, mut work, mut seconds) = (0.0_f64, 0, f64::NAN);
        // The very first run is for the error.
        for &telling in if first { &[true, false][..] } else { &[false][..] } {
            let begin = Instant::now();
            let before = live.statistics().evaluations;
            for case in &self.cases {
                let mut pressed = case.loads.at(0.0);
                live.restart(&self.start, &pressed)?;
                let mut next_row = 0;
                for k in 1..=SECONDS * hz {
                    let state = live.sample(&pressed)?;
                    if k % (hz / RATE) == 0 {
                        if telling {
                            for (own, exact) in state.lumens.iter().zip(case.reference.lumens(next_row)) {
                                error = error.max((own - exact).abs());
                            }
                        }
                        next_row += 1;
                    }
                    let now = case.loads.at(f64::from(k) / f64::from(hz));
                    if now != pressed {
                        pressed = now;
                        let state = state.clone();
                        live.restart(&state, &pressed)?;
                    }
                }
            }
            seconds = begin.elapsed().as_secs_f64() / self.cases.len() as f64;
            if telling {
                work = (live.statistics().evaluations - before) / self.cases.len() as u64;
            }
        }
        Ok((seconds, first.then_some((error, work))))
    }
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
        let (_, told) = bench.full(&bench.model, &options, true, &mut found).unwrap();
        let (error, work) = told.unwrap();
        assert!(error < 1e-7 && work > 0, "{error} {work}");
        let (seconds, again) = bench.full(&bench.model, &options, false, &mut found).unwrap();
        assert!(seconds > 0.0 && again.is_none());
        let (live, told) = bench.live(LIVE_HZ[0], true).unwrap();
        assert!(live > 0.0 && told.unwrap().0 < 1e-6);
    }
}
