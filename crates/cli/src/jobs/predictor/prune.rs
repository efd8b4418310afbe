//! `lunula prune`: which photodiodes could be removed.

use std::path::PathBuf;

use clap::Args;
use clap::builder::Resettable;
use lunula::job::Given;
use lunula::predictor::{DataFile, PruneChoices, PruneReport, PruneRow, prune, prune_plan};

use crate::jobs::predictor::{figure, say_rows};
use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

/// Compare the linear model's errors for every subset of the photodiodes (Fig. 113 and beyond)
///
/// Each subset is fitted to DATA and judged on what --validate names. Says which photodiodes are the best of each
/// number, and what the removal of each one costs. Subsets are compared by the mean over targets of RMSE over the
/// target's spread.
#[derive(Debug, Args)]
#[command(mut_arg("out", |out| out
    .help("A folder for subsets.csv, pictures and run.json")
    .required_unless_present(Resettable::Reset)
))]
pub(crate) struct PruneArgs {
    /// Recordings to train on
    #[arg(required = true, value_name = "DATA")]
    data: Vec<PathBuf>,
    /// Recordings to compare on: others than those to train on
    #[arg(long, required = true, value_name = "DATA", num_args = 1..)]
    validate: Vec<PathBuf>,
    #[command(flatten)]
    given: Given<PruneChoices>,
    #[command(flatten)]
    results: ResultArgs,
}

pub(crate) fn run(args: &PruneArgs) -> anyhow::Result<Outcome> {
    let PruneArgs { data, validate, given, results } = args;
    let outputs = results.outputs_if_said();
    jobs::run(
        &results.request("prune", "steps", &given.said),
        || {
            let files = DataFile::of(&[&data[..], validate].concat());
            let ambient = DataFile::ambient_step(&files, &given.options.rows);
            Ok(prune_plan([data.len(), validate.len()], ambient, outputs.as_ref()))
        },
        |watch| {
            let (data, validate) = (DataFile::of(data), DataFile::of(validate));
            Ok(prune(&data, &validate, &given.options.wanted(), outputs.as_ref(), watch)?)
        },
        say,
    )
}

fn say(common: &Common, report: &PruneReport) {
    say_rows(common, report.data.iter().chain(&report.validate));
    let line = |row: &PruneRow| {
        let errors = row.validate_rmse.iter().flat_map(|by| &by.0);
        let errors: Vec<String> = errors.map(|(name, value)| format!("{name} {}", figure(*value))).collect();
        let shown =
            if errors.is_empty() { "dependent on each other: no one model".to_owned() } else { errors.join("  ") };
        format!("  {:<28} {shown}", row.inputs.join(" "))
    };
    common.say(&format!("{} subsets; the best of each number, validation RMSE:", report.subsets));
    report.best_of_size.iter().for_each(|row| common.say(&line(row)));
    if !report.without_one.is_empty() {
        common.say("all, then all but one:");
        report.without_one.iter().for_each(|row| common.say(&line(row)));
    }
}
