//! `switch-tune` and `switch-evaluate` in a pipeline: the virtual switch of recordings and a trained model (6.1).

use lunula_live::switch::Evaluation;

use super::evaluate::{evaluate_plan, evaluate_switch};
use super::options::{ContactOptions, TuneOptions};
use super::traces::SwitchInputs;
use super::tune::{tune_plan, tune_switch};
use crate::job::{At, Demand, Foreseen, Job, Kind, Made, Order, Part, Quality, Role, Takes, Work};
use crate::log::ReadingCost;
use crate::predictor::DataFile;
use crate::stages::Step;

const SWITCH: &str = "switch.toml";
const RECORDINGS: Role =
    Role::new("recordings", Takes::Many, "tables or logs with photodiodes and what is true of contact");
const MODEL: Role = Role::new("model", Takes::Many, "trained models");

fn inputs(work: &Work<'_>) -> SwitchInputs {
    let recording = |at: &At| DataFile { path: at.path.clone(), name: at.name.clone(), session: None, subject: None };
    SwitchInputs {
        recordings: work.of(RECORDINGS.name).map(recording).collect(),
        models: work.of(MODEL.name).map(|at| at.path.clone()).collect(),
    }
}

/// How a switch did on recordings that did not choose it.
fn quality(found: &Evaluation) -> Vec<Quality> {
    let one = |what: &str, value: f64, unit: &str| Quality {
        what: what.to_owned(),
        value,
        unit: unit.to_owned(),
        against_truth: true,
    };
    let rate = found.rate.map(|rate| one("false switches", rate.false_per_hour, "per hour"));
    let missed = found.missed as f64 / found.presses as f64;
    let missed = missed.is_finite().then(|| one("missed presses", missed, "of all"));
    let delay = found.delay_on_s.map(|delay| one("delay of presses", delay.median, "seconds, median"));
    [rate, missed, delay].into_iter().flatten().collect()
}

fn recordings(inputs: &[Foreseen]) -> usize {
    inputs.iter().filter(|input| input.role == RECORDINGS.name).count()
}

/// Bytes and seconds, `row_s` for each row; recordings are read row by row, and under either rule of ambient light.
fn cost(inputs: &[Foreseen], row_s: f64) -> (u64, f64) {
    let ReadingCost { memory, seconds, rows } = ReadingCost::of(inputs);
    (memory + (16 << 20), 3.0 * seconds + 0.1 + row_s * rows)
}

impl Job for TuneOptions {
    const KIND: Kind =
        Kind::of::<Self>("switch-tune", &[RECORDINGS, MODEL], &[Part::new("switch", SWITCH), Part::pictures("")])
            .revision(9);

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(tune_plan(recordings(inputs), &demand.outputs("")))
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        // Measured: 2.3 h of a sensor at 25 Hz, 4 recordings, in 4 s.
        cost(inputs, 2e-5)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let outputs = order.demand.outputs(work.folder.join(SWITCH));
        let report = work.run(order.said, |watch| tune_switch(&inputs(work), self, &outputs, watch))?;
        let quality = report.held_out.as_ref().map(quality).unwrap_or_default();
        Ok(report.made(quality))
    }
}

impl Job for ContactOptions {
    const KIND: Kind = Kind::of::<Self>(
        "switch-evaluate",
        &[RECORDINGS, MODEL, Role::new("switch", Takes::One, "a switch: switch.toml")],
        &[Part::new("presses", "presses.csv"), Part::pictures("")],
    )
    .revision(9);

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(evaluate_plan(recordings(inputs), &demand.outputs("")))
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        cost(inputs, 2e-6)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let switch = &work.needed("switch")?.path;
        let outputs = order.demand.outputs(work.folder);
        let report = work.run(order.said, |watch| evaluate_switch(switch, &inputs(work), self, &outputs, watch))?;
        let quality = quality(&report.all);
        Ok(report.made(quality))
    }
}
