//! The commands of the predictors: train, evaluate, predict, analyse, prune.

pub(crate) mod analyse;
pub(crate) mod evaluate;
pub(crate) mod predict;
pub(crate) mod prune;
pub(crate) mod train;

use lunula::predictor::{ByTarget, FileRows, Merit};

use crate::Common;

/// A line for each file of which rows are left out.
fn say_rows<'a>(common: &Common, files: impl Iterator<Item = &'a FileRows>) {
    for file in files.filter(|file| file.used < file.rows) {
        common.say(&format!(
            "{}: {} of {} rows used ({} lack a cell, {} invalid, {} with a fault of the sensor)",
            file.path.display(),
            file.used,
            file.rows,
            file.empty,
            file.invalid,
            file.faults
        ));
    }
}

/// One line per target: `Fx_N  RMSE 0.31  bias -0.02  R2 0.87`.
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
