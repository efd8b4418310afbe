//! The step responses that every solver is measured on.

use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Instant;

use anyhow::anyhow;
use lunula_hemodynamics::{
    Collapse, Live, Load, Loads, Model, Order, Parameters, SolveOptions, Solver, State, Trajectory, rest,
};

use crate::tradeoff::measure::timing::Run;

/// The series of lunula among its peers.
pub(in crate::tradeoff) const AUTO: &str = "lunula";
/// A response's length, s, and its outputs a second.
const SECONDS: u32 = 4;
const RATE: u32 = 100;
const REFERENCE: f64 = 1e-13;

/// A step response to be solved.
struct Case {
    loads: Loads,
    /// Whether proximal, else distal.
    proximal: bool,
    load_pa: f64,
    reference: Trajectory,
}

/// The model, its start and the responses.
pub struct Bench {
    pub(super) parameters: Parameters,
    pub(super) model: Model,
    start: State,
    times_s: Vec<f64>,
    cases: Vec<Case>,
}

/// A setting's error, and its work a response.
pub(super) type ErrorAndWork = (f64, u64);

impl Bench {
    /// Solves the responses for their references.
    ///
    /// # Errors
    /// No reference.
    pub fn new() -> anyhow::Result<Self> {
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

    /// The responses to loads on the vein (`proximal`) or on the capillaries as CSV, a row `load_Pa,time_s,C1,C2,V` for
    /// each load and time: displacements, as differences from the nominal diameters and over them.
    #[must_use]
    pub fn reference(&self, proximal: bool) -> String {
        let mut text = String::from("load_Pa,time_s,C1,C2,V\n");
        for case in self.cases.iter().filter(|case| case.proximal == proximal) {
            let mut row = |time_s: f64, lumens: &[f64]| {
                let walls: Vec<String> = lumens.iter().map(|lumen| format!("{:e}", lumen - 1.0)).collect();
                // Writing to a string does not fail.
                let _ = writeln!(text, "{},{time_s},{}", case.load_pa, walls.join(","));
            };
            row(0.0, &self.start.lumens);
            for (k, time_s) in self.times_s.iter().enumerate() {
                row(*time_s, case.reference.lumens(k));
            }
        }
        text
    }

    /// Seconds a response of what `solve` makes of every case; the first time also error and work, which warms up.
    fn over(
        &self,
        first: bool,
        found: &mut Trajectory,
        mut solve: impl FnMut(&Case, &mut Trajectory) -> anyhow::Result<()>,
    ) -> Run<ErrorAndWork> {
        let scored = if first { Some(self.scored(found, &mut solve)?) } else { None };
        let begin = Instant::now();
        for case in &self.cases {
            solve(black_box(case), found)?;
            black_box(&*found);
        }
        Ok((begin.elapsed().as_secs_f64() / self.cases.len() as f64, scored))
    }

    fn scored(
        &self,
        found: &mut Trajectory,
        solve: &mut impl FnMut(&Case, &mut Trajectory) -> anyhow::Result<()>,
    ) -> anyhow::Result<ErrorAndWork> {
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

    pub(super) fn full(
        &self,
        model: &Model,
        options: &SolveOptions,
        first: bool,
        found: &mut Trajectory,
    ) -> Run<ErrorAndWork> {
        let options = SolveOptions { start_s: Some(0.0), ..options.clone() };
        let mut solver = Solver::new(model);
        self.over(first, found, |case, found| {
            Ok(solver.run(&case.loads, &self.start, &self.times_s, &options, found)?)
        })
    }

    /// Sample by sample, a step each; jumps of the load are announced to it.
    pub(super) fn live(&self, hz: u32, first: bool) -> Run<ErrorAndWork> {
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
