//! `lunula analyse`: which combinations of forces depend on which combinations of photodiodes (Fig. 98).
//!
//! In: a model file. Out: the singular values and modes of its Jacobian, targets over photodiodes; of a model that is
//! not linear, the Jacobian at the middle of the training rows, which holds near there only.

mod report;
mod results;

use std::path::Path;

use lunula_predictor::{Model, Modes, Predictor, linear_f0, modes, quadratic_printed, quadratic_terms};

use crate::job::{Outputs, Report, Watch};
use crate::predictor::error::PredictorError;
use crate::predictor::merit::figures::ByTarget;
use crate::predictor::open_models;
use crate::predictor::outputs::end;
use crate::stages::{Stages, Step, left_out};
pub use report::{AnalyseFigures, AnalyseReport, ModelMode, ModelModes, Printed};

/// Takes a model apart; writes a table and a picture where `out` names a folder.
///
/// # Errors
/// [`PredictorError`] where there is nothing to tell.
pub fn analyse(model: &Path, out: Option<&Outputs>, watch: &Watch<'_>) -> Result<AnalyseReport, PredictorError> {
    let stages = Stages::default();
    let mut notes = Vec::new();
    let (predictor, mut warnings) = open_models(&[model.to_owned()])?.one();
    if predictor.eigennails().is_some() {
        let what = "its modes are pictures: `lunula evaluate --out` draws them";
        return Err(PredictorError::Request(format!("{}: {what}", model.display())));
    }
    let inputs = predictor.seen_names();
    let targets = predictor.target_names();
    let at = predictor.model().centre();
    let jacobian = stages.time("jacobian", || predictor.model().jacobian_at(at));
    refuse_lost(&predictor, &jacobian, model)?;
    let found: Modes = stages.time("modes", || modes(jacobian.view()));
    let linear = matches!(predictor.model(), Model::Linear(_));
    if !linear {
        notes.push("the model is not linear: its modes are those at the middle of the training rows".to_owned());
    }
    watch.go_on()?;
    let column = |matrix: &ndarray::Array2<f64>, k: usize| matrix.column(k).to_vec();
    let mode = |(k, sigma): (usize, &f64)| ModelMode {
        singular_value: *sigma,
        targets: ByTarget::new(&targets, column(&found.left, k)),
        inputs: ByTarget::new(&inputs, column(&found.right, k)),
    };
    let printed = printed(predictor.model(), &inputs, &targets);
    let beyond = |all: &Printed| !all.jacobian.0.iter().flat_map(|(_, row)| row).all(|value| value.is_finite());
    let printed = match printed {
        Some(all) if matches!(predictor.model(), Model::Quadratic(_)) && beyond(&all) => {
            let what = "the terms of equation 16 in volts are beyond what a number can hold; they are left out";
            warnings.push(what.to_owned());
            None
        }
        other => other,
    };
    let (strongest, weakest) = (found.sigma.first().copied(), found.sigma.last().copied());
    let condition = strongest.zip(weakest).map(|(a, b)| a / b).filter(|ratio| ratio.is_finite());
    let figures = AnalyseFigures {
        model: model.to_owned(),
        at_v: (!linear).then(|| at.to_vec()),
        jacobian: ByTarget::new(&targets, jacobian.outer_iter().map(|row| row.to_vec())),
        modes: ModelModes { modes: found.sigma.iter().enumerate().map(mode).collect(), condition },
        printed,
        inputs,
        targets,
    };
    let left_out = left_out(analyse_plan(out));
    let report = Report { left_out, warnings, notes, ..Report::new("analyse", watch, figures) };
    end(report, out, |report, out| results::write(report, out, &stages), &stages)
}

/// Refuses a Jacobian that no number holds, though the model itself is scaled and sound.
fn refuse_lost(predictor: &Predictor, jacobian: &ndarray::Array2<f64>, model: &Path) -> Result<(), PredictorError> {
    for (target, row) in predictor.targets().iter().zip(jacobian.outer_iter()) {
        // What does not change with any voltage was constant, or is lost.
        let lost = row.iter().all(|value| value.abs() < f64::MIN_POSITIVE) && target.low < target.high;
        if lost || !row.iter().all(|value| value.is_finite()) {
            let what = "what it has of the voltages is beyond what a number can hold (1e-308 to 1e308): train it on \
                        volts and newtons";
            return Err(PredictorError::Request(format!("{}: {}: {what}", model.display(), target.name)));
        }
    }
    Ok(())
}

/// What would be done and what not.
#[must_use]
pub fn analyse_plan(out: Option<&Outputs>) -> Vec<Step> {
    vec![
        Step::new("jacobian", true, "of the model".to_owned()),
        Step::new("modes", true, "its singular values".to_owned()),
        Outputs::table_step(out, "modes"),
        Outputs::figures_step(out, "modes (Fig. 98)"),
    ]
}

/// The model in the thesis' own form.
fn printed(model: &Model, inputs: &[String], targets: &[String]) -> Option<Printed> {
    let (products, jacobian, offset) = match model {
        Model::Linear(model) => (Vec::new(), model.jacobian().clone(), linear_f0(model)),
        Model::Quadratic(model) => {
            let printed = quadratic_printed(model);
            (quadratic_terms(inputs.len()), printed.coefficients, printed.f0)
        }
        Model::Network(_) | Model::Eigennails(_) => return None,
    };
    let product = |(i, j): (usize, usize)| {
        if i == j { format!("{}^2", inputs[i]) } else { format!("{} {}", inputs[i], inputs[j]) }
    };
    Some(Printed {
        terms: inputs.iter().cloned().chain(products.into_iter().map(product)).collect(),
        jacobian: ByTarget::new(targets, jacobian.outer_iter().map(|row| row.to_vec())),
        offset: ByTarget::new(targets, offset),
    })
}
