//! Every mode of the solver on step responses.

use std::hint::black_box;
use std::time::Instant;

use anyhow::anyhow;
use lunula_hemodynamics::{
    Collapse, Inertia, Live, Load, Loads, Model, Order, Parameters, SolveOptions, Solver, State, Trajectory, rest,
    simulate_reduced,
};

use super::ERROR;
use crate::tradeoff::{Row, median};

/// What is measured, and how often.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Runs of each setting; the median time counts.
    pub repeats: usize,
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
struct Case {
    loads: Loads,
    reference: Trajectory,
}

/// The model, its start and the responses.
struct Bench {
    parameters: Parameters,
    model: Model,
    start: State,
    times_s: Vec<f64>,
    cases: Vec<Case>,
    repeats: usize,
}

/// Measures every setting; the words say which had no answer, and why.
///
/// # Errors
/// No reference.
pub fn measure(settings: &Settings) -> anyhow::Result<(Vec<Row>, Vec<String>)> {
    let bench = Bench::new(settings.repeats)?;
    let (mut rows, mut refused) = (Vec::new(), Vec::new());
    let mut take = |setting: String, found: anyhow::Result<(f64, f64, u64)>| match found {
        Ok((error, run_s, work)) => {
            rows.push(Row { job: "hemodynamics", setting, error, error_unit: ERROR.to_owned(), run_s, work })
        }
        Err(why) => refused.push(format!("{setting}: {why:#}")),
    };
    let orders = [
        (AUTO, Order::Auto),
        ("full, order 5", Order::Fifth),
        ("full, order 9", Order::Ninth),
        ("full, order 13", Order::Thirteenth),
    ];
    for (name, order) in orders {
        for rtol in TOLERANCES {
            let options = SolveOptions { order, ..SolveOptions::at(rtol) };
            take(format!("{name}, {rtol:.0e}"), bench.full(&bench.model, &options));
        }
    }
    for step_s in FIXED_S {
        let options = SolveOptions { fixed_step_s: Some(step_s), ..SolveOptions::at(1e-8) };
        take(format!("full, fixed step, {step_s} s"), bench.full(&bench.model, &options));
    }
    for hz in LIVE_HZ {
        take(format!("live, {hz} Hz"), bench.live(hz));
    }
    for (name, inertia) in [("inertia dropped", Inertia::Dropped), ("inertia corrected", Inertia::Corrected)] {
        for rtol in TOLERANCES.into_iter().take(7) {
            take(format!("{name}, {rtol:.0e}"), bench.reduced(&SolveOptions::at(rtol), inertia));
        }
    }
    // The same solver on the equations as they are printed, whose resistances cancel.
    let printed = Model::printed(&bench.parameters, Collapse::Error)?;
    for rtol in TOLERANCES {
        take(format!("printed form, {rtol:.0e}"), bench.full(&printed, &SolveOptions::at(rtol)));
    }
    Ok((rows, refused))
}

impl Bench {
    fn new(repeats: usize) -> anyhow::Result<Self> {
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
            for (proximal, distal) in [(step()?, zero()?), (zero()?, step()?)] {
                let loads = Loads::on(&parameters, proximal, distal);
                let mut reference = Trajectory::default();
                Solver::new(&model)
                    .run(&loads, &start, &times_s, &options, &mut reference)
                    .map_err(|why| anyhow!("the reference: {why}"))?;
                cases.push(Case { loads, reference });
            }
        }
        Ok(Self { parameters, model, start, times_s, cases, repeats })
    }

    /// Error, seconds a response, work a response of what `solve` makes of every case.
    fn over(
        &self,
        mut solve: impl FnMut(&Case, &mut Trajectory) -> anyhow::Result<()>,
    ) -> anyhow::Result<(f64, f64, u64)> {
        let mut found = Trajectory::default();
        let (mut error, mut work) = (0.0_f64, 0);
        for case in &self.cases {
            solve(case, &mut found)?;
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
        let mut seconds = Vec::new();
        for _ in 0..self.repeats {
            let begin = Instant::now();
            for case in &self.cases {
                solve(black_box(case), &mut found)?;
                black_box(&found);
            }
            seconds.push(begin.elapsed().as_secs_f64() / self.cases.len() as f64);
        }
        Ok((error, median(seconds), work / self.cases.len() as u64))
    }

    fn full(&self, model: &Model, options: &SolveOptions) -> anyhow::Result<(f64, f64, u64)> {
        let options = SolveOptions { start_s: Some(0.0), ..options.clone() };
        let mut solver = Solver::new(model);
        self.over(|case, found| Ok(solver.run(&case.loads, &self.start, &self.times_s, &options, found)?))
    }

    /// Sample by sample, a step each; where the load jumps, it is told so.
    fn live(&self, hz: u32) -> anyhow::Result<(f64, f64, u64)> {
        let sample_s = 1.0 / f64::from(hz);
        let mut live = Live::new(&self.model, &self.start, &self.cases[0].loads.at(0.0), sample_s)?;
        let (mut error, mut work, mut seconds) = (0.0_f64, 0, Vec::new());
        for repeat in 0..=self.repeats {
            let begin = Instant::now();
            let before = live.statistics().evaluations;
            for case in &self.cases {
                let mut pressed = case.loads.at(0.0);
                live.restart(&self.start, &pressed)?;
                let mut next_row = 0;
                for k in 1..=SECONDS * hz {
                    let state = live.sample(&pressed)?;
                    if k % (hz / RATE) == 0 {
                        if repeat == 0 {
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
            // The first run is for the error.
            if repeat > 0 {
                seconds.push(begin.elapsed().as_secs_f64() / self.cases.len() as f64);
            } else {
                work = live.statistics().evaluations - before;
            }
        }
        Ok((error, median(seconds), work / self.cases.len() as u64))
    }

    fn reduced(&self, options: &SolveOptions, inertia: Inertia) -> anyhow::Result<(f64, f64, u64)> {
        let options = SolveOptions { start_s: Some(0.0), ..options.clone() };
        self.over(|case, found| {
            *found =
                simulate_reduced(&self.model, &case.loads, &self.start, &self.times_s, &options, inertia)?.trajectory;
            Ok(())
        })
    }
}
