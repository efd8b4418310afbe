//! `performance` in a pipeline: time per decision and how it is learned (appendix C).

use std::path::Path;

use super::job::{FIGURES, plan, run};
use super::options::PerformanceOptions;
use super::tables::{MEANS, ROWS};
use crate::job::{Demand, Foreseen, Job, Kind, Made, Order, Outputs, Part, Role, Takes, Work};
use crate::stages::Step;

const ROWS_PART: &str = "rows";
/// A table of trials is small; what is drawn takes the time (measured: 0.04 s for two pictures of 99 trials).
const COST: (u64, f64) = (64 << 20, 0.1);

fn outputs(folder: &Path, demand: &Demand) -> Outputs {
    Outputs { rows: demand.wants(ROWS_PART), ..demand.outputs(folder) }
}

impl Job for PerformanceOptions {
    const KIND: Kind = Kind::of::<Self>(
        "performance",
        &[Role::new("trials", Takes::One, "a table operator,method,trial,time_s")],
        &[
            Part::new("performance", FIGURES),
            Part::new("means", MEANS),
            Part::if_wanted(ROWS_PART, ROWS),
            Part::pictures(""),
        ],
    )
    .revision(7);

    fn steps(&self, _inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(plan(&outputs(Path::new(""), demand)))
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        COST
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let trials = work.needed("trials")?;
        let outputs = outputs(work.folder, order.demand);
        let report = work.run(order.said, |watch| run(&trials.path, &trials.name, self, &outputs, watch))?;
        Ok(report.made(Vec::new()))
    }
}
