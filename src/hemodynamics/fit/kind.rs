//! `fit` in a pipeline: the hemodynamic model's free parameters to recorded responses (Fig. 79 to 82).
//!
//! Recordings of one subject are those whose key `subject` is the same; where not all have it, all are one's.

use std::sync::Arc;

use super::job::{fit, plan, steps};
use super::{FitInputs, FitOptions, FitReport};
use crate::hemodynamics::given::{PARAMS, existing, of_foreseen, of_task, read_parameters};
use crate::hemodynamics::model::{Parameters, Symbol};
use crate::job::{
    Demand, Foreseen, Job, Keys, Kind, Made, OptionFault, Order, Part, Prepared, Quality, Role, Takes, Work, prepare,
};
use crate::log::{ambient_step, foreseen_bytes};
use crate::stages::Step;

const RECORDINGS: &str = "recordings";
const TRUTH: &str = "truth";

/// Whose each recording is; none where not all have a subject.
fn subjects<'a>(keys: impl Iterator<Item = &'a Keys>) -> Vec<String> {
    keys.map(|keys| keys.get("subject").map(str::to_owned)).collect::<Option<Vec<_>>>().unwrap_or_default()
}

/// Reads a stage's keys; an empty list says what the command's word does.
fn prepare_fit(table: &toml::Table) -> Result<Arc<dyn Prepared>, OptionFault> {
    let mut table = table.clone();
    if table.get("free").and_then(toml::Value::as_array).is_some_and(Vec::is_empty) {
        table.insert("free".to_owned(), "none".into());
    }
    prepare::<FitOptions>(&table)
}

impl Job for FitOptions {
    const KIND: Kind = Kind {
        prepare: prepare_fit,
        ..Kind::of::<Self>(
            "fit",
            &[
                Role::new(RECORDINGS, Takes::Many, "recorded responses: loads and photodiodes; a log or align's set"),
                PARAMS,
                Role::new(TRUTH, Takes::Optional, "the true parameters, where they are known"),
            ],
            &[
                Part::new("params", "fit.toml"),
                Part::new("estimates", "fit-estimates.csv"),
                Part::new("fitted", "fit-fitted.csv"),
                Part::pictures(""),
            ],
        )
        .revision(11)
    };

    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        Demand { joints: Some(Default::default()), clock: own.clock, ..Demand::default() }
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let own = || inputs.iter().filter(|input| input.role == RECORDINGS);
        let files = FitInputs {
            recordings: own().map(|input| input.path.clone()).collect(),
            subjects: subjects(own().map(|input| &input.keys)),
            names: Vec::new(),
            params: of_foreseen(PARAMS.name, inputs),
        };
        let outputs = demand.outputs("fit.json");
        if existing(inputs) {
            return plan(&files, self, &outputs).map_err(|why| why.to_string());
        }
        let ambient = ambient_step(inputs, &[RECORDINGS], &self.columns.log);
        Ok(steps(&files, self, &outputs, ambient, None))
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let bytes = foreseen_bytes(inputs.iter().filter(|input| input.role == RECORDINGS));
        let fits = f64::from(self.starts) * (1.0 + self.free().len() as f64);
        (32_000_000 + 10 * bytes, 0.1 + fits * (0.05 + 2e-7 * bytes as f64))
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let inputs = FitInputs {
            recordings: work.of(RECORDINGS).map(|at| at.path.clone()).collect(),
            subjects: subjects(work.of(RECORDINGS).map(|at| &at.keys)),
            names: work.of(RECORDINGS).map(|at| at.name.clone()).collect(),
            params: of_task(PARAMS.name, work),
        };
        let outputs = order.demand.outputs(work.folder.join("fit.json"));
        let report = work.run(order.said, |watch| fit(&inputs, self, &outputs, watch))?;
        let mut quality = stated(&report);
        if let Some(at) = work.one(TRUTH) {
            quality.extend(against(&report, &read_parameters(&at.path)?));
        }
        Ok(report.made(quality))
    }
}

/// The residuals, and the standard errors of the values.
fn stated(report: &FitReport) -> Vec<Quality> {
    let mut quality = vec![Quality::stated("voltages", report.residual_sd_v, "V, SD of the residuals")];
    for group in &report.free {
        let errors = group.standard_errors.iter().flatten();
        for ((symbol, value), error) in group.symbols.iter().zip(&group.values).zip(errors) {
            quality.push(Quality::stated(&symbol.to_string(), (error / value).abs(), "of its value, standard error"));
        }
    }
    quality.retain(|one| one.value.is_finite());
    quality
}

/// How far the values are from the true ones.
fn against(report: &FitReport, truth: &Parameters) -> Vec<Quality> {
    let one = |(symbol, value): (&Symbol, &f64)| {
        let is = truth.get(*symbol)?;
        let error = ((value - is) / is).abs();
        let unit = "of its true value".to_owned();
        error.is_finite().then_some(Quality { what: symbol.to_string(), value: error, unit, against_truth: true })
    };
    report.free.iter().flat_map(|group| group.symbols.iter().zip(&group.values)).filter_map(one).collect()
}
