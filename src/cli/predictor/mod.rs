//! The commands of the predictors: train, evaluate, predict, analyse, prune.

mod analyse;
mod evaluate;
mod predict;
mod prune;
mod train;

use std::path::PathBuf;

use clap::Args;
use lunula::log::LogReading;
use lunula::predictor::{ByTarget, Merit, Target, Wanted};

use super::{Common, Outcome, one_of};

pub(super) use analyse::{AnalyseArgs, run as analyse};
pub(super) use evaluate::{EvaluateArgs, run as evaluate};
pub(super) use predict::{PredictArgs, run as predict};
pub(super) use prune::{PruneArgs, run as prune};
pub(super) use train::{TrainArgs, run as train};

/// Which rows of the recordings count.
#[derive(Debug, Clone, Args)]
struct RowsArgs {
    /// A cell that is no finite number leaves its row out, which is counted [default: it is an error]
    #[arg(long)]
    drop_invalid: bool,
    /// Rows in which `lunula align` found a photodiode saturated or without ambient light count too
    #[arg(long)]
    keep_faults: bool,
    #[command(flatten)]
    log: LogReading,
}

impl RowsArgs {
    fn wanted(&self, inputs: Option<Vec<String>>, target: &Target) -> Wanted {
        Wanted {
            inputs,
            targets: target.columns().to_vec(),
            drop_invalid: self.drop_invalid,
            keep_faults: self.keep_faults,
            log: self.log.clone(),
            skip_failed: false,
        }
    }
}

/// An error of a job, with a word of its own where somebody stopped it.
fn ended(error: lunula::predictor::PredictorError) -> anyhow::Error {
    match error {
        lunula::predictor::PredictorError::Interrupted => lunula::job::Interrupted.into(),
        error => error.into(),
    }
}

/// A line a target: `Fx_N  RMSE 0.31  bias -0.02  R2 0.87`.
fn say_merit(common: &Common, what: &str, merit: &Merit) {
    common.say(&format!("{what} ({} rows)", merit.rows));
    let ByTarget(rmse) = &merit.rmse;
    for (k, (name, rmse)) in rmse.iter().enumerate() {
        common.say(&format!(
            "  {name:<8} RMSE {:>8}  bias {:>8}  R2 {:>8}",
            figure(*rmse),
            figure(merit.bias.0[k].1),
            figure(merit.r2.0[k].1.unwrap_or(f64::NAN))
        ));
    }
}

/// Four places; of what is too large for that to be read, four digits; nothing where it is not known.
fn figure(value: f64) -> String {
    match value {
        _ if !value.is_finite() => "-".to_owned(),
        _ if value.abs() >= 1e7 => format!("{value:.3e}"),
        _ => format!("{value:.4}"),
    }
}

/// How long it took, and where to look.
fn say_end(common: &Common, wall_s: f64, pictures: &[PathBuf]) {
    let look = pictures.first().map_or(String::new(), |picture| format!("; look at {}", picture.display()));
    common.say(&format!("{wall_s:.2} s{look}"));
}

/// Notes for the reader, on standard error.
fn say_notes(common: &Common, notes: &[String]) {
    if !common.quiet {
        notes.iter().for_each(|note| eprintln!("note: {note}"));
    }
}
