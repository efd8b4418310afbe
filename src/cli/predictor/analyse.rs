//! `lunula analyse`: singular values and modes of a model.

use std::path::PathBuf;

use clap::Args;
use lunula::predictor::{FolderOutputs, ModelMode, analyse as run_analyse};

use super::{Common, Outcome, ended, say_end, say_notes};

/// Which combinations of forces depend on which combinations of photodiodes (Fig. 98)
///
/// Singular values and modes of the model's Jacobian; of a quadratic or network model, of the Jacobian at the middle of
/// its training rows. Singular values of like size mean that the targets can be told independently. --json also tells
/// the model as the thesis prints it (equation 9 or 16, with F_0).
#[derive(Debug, Args)]
pub(crate) struct AnalyseArgs {
    /// A model file of `lunula train`
    #[arg(value_name = "MODEL.json")]
    model: PathBuf,
    /// A folder for modes.csv, the picture and run.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

pub(crate) fn run(args: &AnalyseArgs) -> anyhow::Result<Outcome> {
    let stop = args.common.start()?;
    let out = args.out.clone().map(FolderOutputs::all);
    let report = run_analyse(&args.model, out.as_ref(), &stop).map_err(ended)?;
    let common = &args.common;
    say_notes(common, &report.warnings);
    common.print_json(&report)?;
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
    say_end(common, report.wall_s, &report.pictures);
    Ok(Outcome::Done)
}
