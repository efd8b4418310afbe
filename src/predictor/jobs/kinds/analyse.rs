//! `analyse` in a pipeline: singular values and modes of a model (Fig. 98).

use std::path::Path;

use clap::Args;

use crate::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Role, Takes, Work};
use crate::predictor::jobs::analyse::{analyse, analyse_plan};
use crate::predictor::jobs::kinds::outputs;
use crate::stages::Step;

/// A stage of a pipeline.
#[derive(Debug, Clone, Copy, Args)]
pub struct AnalyseJob {}

impl Job for AnalyseJob {
    const KIND: Kind = Kind::of::<Self>(
        "analyse",
        &[Role::new("model", Takes::One, "a model of train")],
        &[Part::new("modes", "modes.csv"), Part::pictures("")],
    );

    fn steps(&self, _inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(analyse_plan(Some(&outputs(Path::new(""), demand))))
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (32_000_000, 0.1)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let model = work.needed("model")?;
        let out = outputs(work.folder, order.demand);
        let report = work.run(order.said, |watch| analyse(&model.path, Some(&out), watch))?;
        Ok(report.made(Vec::new()))
    }
}
