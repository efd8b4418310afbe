//! `lunula prune`: which photodiodes could be removed.

use std::path::PathBuf;

use clap::Args;
use lunula::predictor::{DataFile, FolderOutputs, PruneRow, Target, prune as run_prune};

use super::{Common, Outcome, RowsArgs, ended, figure, say_end, say_notes};

/// The linear model's errors for every subset of the photodiodes (Fig. 113 and beyond)
///
/// Each subset is fitted to DATA and told on what --validate names. Says which photodiodes are the best of each number,
/// and what the removal of each one costs. Subsets are compared by the mean over targets of RMSE over the target's
/// spread.
#[derive(Debug, Args)]
pub(crate) struct PruneArgs {
    /// Recordings to train on
    #[arg(required = true, value_name = "DATA")]
    data: Vec<PathBuf>,
    /// Recordings to compare on: others than those to train on
    #[arg(long, required = true, value_name = "DATA", num_args = 1..)]
    validate: Vec<PathBuf>,
    /// force, posture, or columns as Fz_N,J3_deg
    #[arg(long, value_name = "force|posture|COLUMNS", default_value = "force", value_parser = Target::parse)]
    target: Target,
    /// The photodiodes to choose from [default: all columns P1, P2, ..]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    inputs: Option<Vec<String>>,
    #[command(flatten)]
    rows: RowsArgs,
    /// A folder for subsets.csv, pictures and run.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

pub(crate) fn run(args: &PruneArgs) -> anyhow::Result<Outcome> {
    let stop = args.common.start()?;
    let wanted = args.rows.wanted(args.inputs.clone(), &args.target);
    let (data, validate) = (DataFile::of(&args.data), DataFile::of(&args.validate));
    let out = args.out.clone().map(FolderOutputs::all);
    let report = run_prune(&data, &validate, &wanted, out.as_ref(), &stop).map_err(ended)?;
    let common = &args.common;
    say_notes(common, &report.warnings);
    common.print_json(&report)?;
    let line = |row: &PruneRow| {
        let errors = row.validate_rmse.iter().flat_map(|by| &by.0);
        let errors: Vec<String> = errors.map(|(name, value)| format!("{name} {}", figure(*value))).collect();
        let told =
            if errors.is_empty() { "dependent on each other: no one model".to_owned() } else { errors.join("  ") };
        format!("  {:<28} {told}", row.inputs.join(" "))
    };
    common.say(&format!("{} subsets; the best of each number, validation RMSE:", report.subsets));
    report.best_of_size.iter().for_each(|row| common.say(&line(row)));
    if !report.without_one.is_empty() {
        common.say("all, then all but one:");
        report.without_one.iter().for_each(|row| common.say(&line(row)));
    }
    say_end(common, report.wall_s, &report.pictures);
    Ok(Outcome::Done)
}
