//! `lunula analyse`: singular values and modes of a model.

use std::path::PathBuf;

use clap::Args;
use clap::builder::Resettable;
use lunula::job::Given;
use lunula::predictor::{AnalyseJob, AnalyseReport, ModelMode, analyse, analyse_plan};

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

/// Show which combinations of forces depend on which combinations of photodiodes (Fig. 98)
///
/// Singular values and modes of the model's Jacobian; of a quadratic or network model, of the Jacobian at the middle of
/// its training rows. Singular values of like size mean that the targets can be predicted independently. --json also
/// gives the model as the thesis prints it (equation 9 or 16, with F_0).
#[derive(Debug, Args)]
#[command(mut_arg("out", |out| out
    .help("A folder for modes.csv, the picture and run.json")
    .required_unless_present(Resettable::Reset)
))]
pub(crate) struct AnalyseArgs {
    /// A model file of `lunula train`
    #[arg(value_name = "MODEL.json")]
    model: PathBuf,
    #[command(flatten)]
    given: Given<AnalyseJob>,
    #[command(flatten)]
    results: ResultArgs,
}

pub(crate) fn run(AnalyseArgs { model, given, results }: &AnalyseArgs) -> anyhow::Result<Outcome> {
    jobs::run(
        &results.request("analyse", "steps", &given.said),
        || Ok(analyse_plan(results.outputs_if_said().as_ref())),
        |watch| Ok(analyse(model, results.outputs_if_said().as_ref(), watch)?),
        say,
    )
}

fn say(common: &Common, report: &AnalyseReport) {
    for (k, ModelMode { singular_value, targets, inputs }) in report.modes.modes.iter().enumerate() {
        // Of very small and very large ones the digits, not zeros.
        let value = match singular_value.abs() {
            0.0 | 1e-4..1e7 => format!("{singular_value:.5}"),
            _ => format!("{singular_value:.5e}"),
        };
        common.say(&format!("mode {}: singular value {value}", k + 1));
        let text = |values: &[(String, f64)]| {
            values.iter().map(|(name, value)| format!("{name} {value:+.3}")).collect::<Vec<_>>().join("  ")
        };
        common.say(&format!("  {}", text(&targets.0)));
        common.say(&format!("  {}", text(&inputs.0)));
    }
    if let Some(condition) = report.modes.condition {
        common.say(&format!("the strongest over the weakest: {condition:.2}"));
    }
}
