//! `lunula prune`: which photodiodes could be removed.

use std::path::PathBuf;

use clap::Args;
use clap::builder::Resettable;
use lunula::job::{Given, Watch};
use lunula::predictor::{DataFile, PruneChoices, PruneFigures, PruneReport, PruneRow, prune, prune_plan};

use crate::Common;
use crate::jobs::predictor::figure;
use crate::jobs::{Command, Plan, Request, ResultArgs};

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

impl Command for PruneArgs {
    type Figures = PruneFigures;

    const NAME: &'static str = "prune";

    fn given(&self) -> Request<'_> {
        self.results.given(&self.given.said)
    }

    fn plan(&self) -> anyhow::Result<Plan> {
        let files = [&self.data[..], &self.validate].concat();
        let ambient = DataFile::ambient_step(&DataFile::of(&files), &self.given.options.rows);
        Ok(prune_plan([self.data.len(), self.validate.len()], ambient, self.results.outputs().as_ref()).into())
    }

    fn run(&self, watch: &Watch<'_>) -> anyhow::Result<PruneReport> {
        let (data, validate) = (DataFile::of(&self.data), DataFile::of(&self.validate));
        Ok(prune(&data, &validate, &self.given.options.wanted(), self.results.outputs().as_ref(), watch)?)
    }

    fn say(&self, common: &Common, report: &PruneReport) {
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
}
