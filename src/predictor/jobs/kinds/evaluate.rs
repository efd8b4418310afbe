//! `evaluate` in a pipeline: how far off a model is on recordings (5.3, 5.4).

use std::path::Path;

use crate::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Role, Takes, Work};
use crate::log::{ReadingCost, ambient_step};
use crate::predictor::jobs::evaluate::{EvaluateOptions, evaluate, evaluate_plan};
use crate::predictor::jobs::kinds::{ROWS, data_files, measured, outputs};
use crate::predictor::options::choices::ByChoice;
use crate::predictor::options::commands::EvaluateChoices;
use crate::stages::Step;

impl Job for EvaluateChoices {
    const KIND: Kind = Kind::of::<Self>(
        "evaluate",
        &[
            Role::new("model", Takes::One, "a model of train"),
            Role::new("data", Takes::Many, "recordings with the model's photodiodes and targets"),
        ],
        &[Part::new("merit", "merit.csv"), Part::if_wanted(ROWS, "predicted.csv"), Part::pictures("")],
    )
    .revision(12);

    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        // The model says which joints recordings have to hold, once it exists.
        Demand { clock: own.clock, ..Demand::default() }
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let files = inputs.iter().filter(|input| input.role == "data").count();
        let ambient = ambient_step(inputs, &["data"], &self.rows.log);
        Ok(evaluate_plan(files, ambient, &self.options(), None, Some(&outputs(Path::new(""), demand))))
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let ReadingCost { memory, seconds, rows } = ReadingCost::of(inputs);
        let parts = self.by.map_or(0.0, |by| if by == ByChoice::Rows { f64::from(self.folds) } else { 30.0 });
        (memory, seconds + 0.3 + rows * 1e-6 * (1.0 + parts))
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let model = work.needed("model")?;
        let options = EvaluateOptions { title: Some(model.name.clone()), ..self.options() };
        let outputs = outputs(work.folder, order.demand);
        let data = data_files(work, "data");
        let report = work.run(order.said, |watch| evaluate(&model.path, &data, &options, Some(&outputs), watch))?;
        let mut quality = measured(&report.merit, "");
        if let Some(held_out) = &report.held_out {
            quality.extend(measured(&held_out.pooled, ", parts held out"));
        }
        Ok(report.made(quality))
    }
}
