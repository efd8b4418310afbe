//! `predict` in a pipeline: forces and angle from photodiodes, by trained models (5.1).

use std::path::PathBuf;

use crate::job::{Demand, Facts, Foreseen, Job, Kind, Made, OptionFault, Order, Part, Role, Takes, Work};
use crate::log::{ReadingCost, ambient_step};
use crate::predictor::jobs::kinds::only_joints;
use crate::predictor::jobs::predict::{predict, predict_plan};
use crate::predictor::options::commands::PredictChoices;
use crate::stages::Step;

impl Job for PredictChoices {
    const KIND: Kind = Kind::of::<Self>(
        "predict",
        &[
            Role::new("data", Takes::One, "a recording"),
            Role::new("model", Takes::Many, "a model of force, of posture, or both: then they are gated"),
        ],
        &[Part::new("predicted", "predicted.csv")],
    )
    .revision(6);

    fn checked(self) -> Result<Self, OptionFault> {
        self.options().map_err(OptionFault::whole)?;
        Ok(self)
    }

    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        // Photodiodes alone are read.
        only_joints(Default::default(), own)
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let models = inputs.iter().filter(|input| input.role == "model").count();
        let options = self.options().map_err(|why| why.to_string())?;
        Ok(predict_plan(models, ambient_step(inputs, &["data"], &self.rows.log), &options))
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
        let (options, out) = (self.options()?, work.folder.join("predicted.csv"));
        let report = work.run(order.said, |watch| predict(&models, &data.path, &options, &out, watch))?;
        Ok(report.made(Vec::new()))
    }
}
