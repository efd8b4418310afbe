//! `predict` in a pipeline: forces and angle from photodiodes, by trained models (5.1).

use std::path::PathBuf;

use crate::job::{Demand, Facts, Foreseen, Job, Kind, Made, OptionFault, Order, Part, Role, Takes, Work};
use crate::log::{ReadingCost, ambient_step};
use crate::predictor::jobs::kinds::only_joints;
use crate::predictor::jobs::predict::{PredictOptions, predict, predict_plan};
use crate::predictor::options::commands::PredictChoices;
use crate::stages::Step;

/// A stage of a pipeline.
#[derive(Debug, Clone)]
pub struct PredictJob(PredictOptions);

impl Job for PredictJob {
    const KIND: Kind = Kind::of::<Self>(
        "predict",
        &[
            Role { name: "data", takes: Takes::One, about: "a recording" },
            Role {
                name: "model",
                takes: Takes::Many,
                about: "a model of force, of posture, or both: then they are gated",
            },
        ],
        &[Part { name: "predicted", file: "predicted.csv", only_if_wanted: false }],
    );

    type Options = PredictChoices;

    fn new(options: PredictChoices) -> Result<Self, OptionFault> {
        options.options().map(Self).map_err(|why| OptionFault { key: String::new(), what: why.to_string() })
    }

    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        // Photodiodes alone are read.
        only_joints(Default::default(), own)
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let models = inputs.iter().filter(|input| input.role == "model").count();
        Ok(predict_plan(models, ambient_step(inputs, &["data"], &self.0.rows.log), &self.0))
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts { led: Some(false), ..Facts::default() }
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let ReadingCost { memory, seconds, rows } = ReadingCost::of(inputs);
        (memory, seconds + 1e-6 * rows)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let data = work.needed("data")?;
        let models: Vec<PathBuf> = work.of("model").map(|at| at.path.clone()).collect();
        let out = work.folder.join("predicted.csv");
        let report = work.run(order.said, |watch| predict(&models, &data.path, &self.0, &out, watch))?;
        Ok(report.made(Vec::new()))
    }
}
