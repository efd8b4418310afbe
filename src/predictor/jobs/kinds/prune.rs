//! `prune` in a pipeline: which photodiodes could be removed (5.5, Fig. 113).

use std::path::Path;

use crate::job::{Demand, Foreseen, Job, Kind, Made, OptionFault, Order, Part, Quality, Role, Takes, Work};
use crate::log::{ReadingCost, ambient_step};
use crate::predictor::jobs::kinds::{PICTURES, data_files, joints, only_joints, outputs};
use crate::predictor::jobs::prune::{PruneRow, prune, prune_plan};
use crate::predictor::options::commands::PruneChoices;
use crate::stages::Step;

/// A stage of a pipeline.
#[derive(Debug, Clone)]
pub struct PruneJob(PruneChoices);

impl Job for PruneJob {
    const KIND: Kind = Kind::of::<Self>(
        "prune",
        &[
            Role { name: "data", takes: Takes::Many, about: "recordings to train on" },
            Role { name: "validate", takes: Takes::Many, about: "others to compare on" },
        ],
        &[
            Part { name: "subsets", file: "subsets.csv", only_if_wanted: false },
            Part { name: PICTURES, file: "", only_if_wanted: true },
        ],
    );

    type Options = PruneChoices;

    fn new(options: PruneChoices) -> Result<Self, OptionFault> {
        Ok(Self(options))
    }

    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        only_joints(joints(&self.0.target), own)
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let count = |role: &str| inputs.iter().filter(|input| input.role == role).count();
        let ambient = ambient_step(inputs, &["data", "validate"], &self.0.rows.log);
        Ok(prune_plan([count("data"), count("validate")], ambient, Some(&outputs(Path::new(""), demand))))
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let ReadingCost { memory, seconds, rows } = ReadingCost::of(inputs);
        (memory, seconds + 0.3 + 1e-6 * rows)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let (data, validate) = (data_files(work, "data"), data_files(work, "validate"));
        let out = outputs(work.folder, order.demand);
        let report = work.run(order.said, |watch| prune(&data, &validate, &self.0.wanted(), Some(&out), watch))?;
        let best = |row: &PruneRow| {
            let what = format!("best {} photodiodes", row.inputs.len());
            let unit = "of the targets' SD, RMS".to_owned();
            row.score.map(|value| Quality { what, value, unit, against_truth: true })
        };
        let quality = report.best_of_size.iter().filter_map(best).collect();
        Ok(report.made(quality))
    }
}
