//! `train` in a pipeline: recordings to a model of force or posture (5.).

use std::path::Path;

use crate::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Role, Takes, Work};
use crate::log::{ReadingCost, ambient_step};
use crate::predictor::jobs::kinds::{data_files, foreseen, joints, measured, only_joints};
use crate::predictor::jobs::train::{TrainInputs, TrainOutputs, train, train_plan};
use crate::predictor::options::choices::ModelChoice;
use crate::predictor::options::commands::TrainChoices;
use crate::stages::Step;

const CURVE: &str = "learning_curve";

impl Job for TrainChoices {
    const KIND: Kind = Kind::of::<Self>(
        "train",
        &[
            Role::new("data", Takes::Many, "recordings to train on"),
            Role::new("validate", Takes::AnyNumber, "recordings to report on"),
            Role::new("stop_on", Takes::AnyNumber, "recordings on which a network's training stops early"),
        ],
        &[
            Part::new("model", "model.json"),
            Part::new("merit", "merit.csv"),
            Part::if_wanted(CURVE, "learning-curve.csv"),
        ],
    )
    .revision(12);

    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        only_joints(joints(&self.target), own)
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let of = |role: &str| foreseen(inputs, role);
        let files = TrainInputs { data: of("data"), validate: of("validate"), stop_on: of("stop_on") };
        let ambient = ambient_step(inputs, &["data", "validate", "stop_on"], &self.rows.log);
        Ok(train_plan(&files, ambient, &self.options().recipe, demand.wants(CURVE)))
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let ReadingCost { memory, seconds, rows } = ReadingCost::of(inputs);
        let fit_s = match self.model {
            ModelChoice::Linear => 1e-6 * rows,
            ModelChoice::Quadratic => 1e-5 * rows,
            ModelChoice::Network => self.network.cost_s(rows),
            // Measured: 0.3 s a thousand rows of 144 cells, and 1 s for a process.
            ModelChoice::Eigennails => 1.0 + 3e-4 * rows,
        };
        (memory, seconds + fit_s)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let of = |role: &str| data_files(work, role);
        let inputs = TrainInputs { data: of("data"), validate: of("validate"), stop_on: of("stop_on") };
        let outputs = outputs(work.folder, order.demand);
        let report = work.run(order.said, |watch| train(&inputs, &self.options(), &outputs, watch))?;
        let quality = match &report.validation {
            Some(merit) => measured(merit, ""),
            None => measured(&report.training, ", rows trained on"),
        };
        Ok(report.made(quality))
    }
}

fn outputs(folder: &Path, demand: &Demand) -> TrainOutputs {
    TrainOutputs {
        model: folder.join("model.json"),
        learning_curve: demand.wants(CURVE).then(|| folder.join("learning-curve.csv")),
        merit: Some(folder.join("merit.csv")),
    }
}
