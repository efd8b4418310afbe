//! `prune` in a pipeline: which photodiodes could be removed (5.5, Fig. 113).

use std::path::Path;

use crate::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Quality, Role, Takes, Work};
use crate::log::{ReadingCost, ambient_step};
use crate::predictor::jobs::kinds::{data_files, joints, only_joints, outputs};
use crate::predictor::jobs::prune::{PruneRow, prune, prune_plan};
use crate::predictor::options::commands::PruneChoices;
use crate::stages::Step;

impl Job for PruneChoices {
    const KIND: Kind = Kind::of::<Self>(
        "prune",
        &[
            Role::new("data", Takes::Many, "recordings to train on"),
            Role::new("validate", Takes::Many, "others to compare on"),
        ],
        &[Part::new("subsets", "subsets.csv"), Part::pictures("")],
    )
    .revision(10);

    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        only_joints(joints(&self.target), own)
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let count = |role: &str| inputs.iter().filter(|input| input.role == role).count();
        let ambient = ambient_step(inputs, &["data", "validate"], &self.rows.log);
        Ok(prune_plan([count("data"), count("validate")], ambient, Some(&outputs(Path::new(""), demand))))
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let ReadingCost { memory, seconds, rows } = ReadingCost::of(inputs);
        (memory, seconds + 0.3 + 1e-6 * rows)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let (data, validate) = (data_files(work, "data"), data_files(work, "validate"));
        let out = outputs(work.folder, order.demand);
        let report = work.run(order.said, |watch| prune(&data, &validate, &self.wanted(), Some(&out), watch))?;
        let best = |row: &PruneRow| {
            let what = format!("best {} photodiodes", row.inputs.len());
            let unit = "of the targets' SD, RMS".to_owned();
            row.score.map(|value| Quality { what, value, unit, against_truth: true })
        };
        let quality = report.best_of_size.iter().filter_map(best).collect();
        Ok(report.made(quality))
    }
}
