//! `lunula evaluate`: how far off a model is.

use std::path::PathBuf;

use clap::Args;
use lunula::predictor::{
    ByChoice, DataFile, EvaluateOptions, EvaluateReport, FOLDS, FolderOutputs, LEVEL, evaluate as run_evaluate, share,
};

use super::{Common, Outcome, RowsArgs, ended, one_of, say_end, say_merit, say_notes};

/// How far off a model is on recordings, and how far off its recipe is on recordings that are held out
///
/// RMSE, bias and R2 a target (R2 is empty where a target does not change), by recording and by the size of force or
/// angle, and how many rows the model's prediction intervals hold. With --by, the model's recipe is fitted anew without
/// each trajectory, session or subject in turn and told on what it has not seen: name all recordings then. Rows of one
/// trajectory resemble each other, so shuffled rows (--by rows) flatter; how much is told beside. --out draws predicted
/// against measured over time and as scatter (Fig. 94 to 104).
#[derive(Debug, Args)]
pub(crate) struct EvaluateArgs {
    /// A model file of `lunula train`
    #[arg(value_name = "MODEL.json")]
    model: PathBuf,
    /// Recordings with the model's photodiodes and targets
    #[arg(required = true, value_name = "DATA")]
    data: Vec<PathBuf>,
    /// What is held out in turn
    #[arg(long, value_parser = one_of::<ByChoice>())]
    by: Option<ByChoice>,
    /// Parts of shuffled rows
    #[arg(long, value_name = "N", default_value_t = FOLDS, value_parser = clap::value_parser!(u16).range(2..=1000))]
    folds: u16,
    /// Which shuffle
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The share of rows that intervals of held-out parts are to hold
    #[arg(long, value_name = "SHARE", default_value_t = LEVEL)]
    level: f64,
    #[command(flatten)]
    rows: RowsArgs,
    /// A folder for merit.csv, predicted.csv, pictures and run.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

pub(crate) fn run(args: &EvaluateArgs) -> anyhow::Result<Outcome> {
    let stop = args.common.start()?;
    let level = share(args.level).map_err(|why| anyhow::anyhow!("--level {why}"))?;
    let by = args.by.map(|by| by.by(args.folds, args.seed));
    let options = EvaluateOptions {
        drop_invalid: args.rows.drop_invalid,
        keep_faults: args.rows.keep_faults,
        log: args.rows.log.clone(),
        by,
        level,
        called: None,
    };
    let out = args.out.clone().map(FolderOutputs::all);
    let report = run_evaluate(&args.model, &DataFile::of(&args.data), &options, out.as_ref(), &stop).map_err(ended)?;
    let common = &args.common;
    say_notes(common, &report.warnings);
    common.print_json(&report)?;
    say_merit(common, "the model", &report.merit);
    if let Some(plain) = &report.without_friction {
        say_merit(common, "without the cone of friction", plain);
    }
    say_coverage(common, &report);
    if let Some(found) = &report.held_out {
        say_merit(common, "its recipe, each part held out in turn", &found.pooled);
        for part in found.parts.iter().filter_map(|part| Some((&part.name, part.fault.as_ref()?))) {
            common.say(&format!("  {}: not fitted: {}", part.0, part.1));
        }
        if let Some(honest) = &found.by_trajectory {
            say_merit(common, "whole trajectories held out instead, which is what a new trajectory will see", honest);
        }
        for (name, ratio) in found.flattery.iter().flat_map(|by| &by.0) {
            let text = ratio.map_or("an unknown number of".to_owned(), |ratio| format!("{ratio:.2}"));
            common.say(&format!("  {name:<8} shuffled rows flatter it {text} times"));
        }
        match (&found.coverage, &found.no_coverage) {
            (Some(found), _) => {
                for (k, (name, _)) in report.merit.rmse.0.iter().enumerate() {
                    let reached = found.all.reached[k].map_or("-".to_owned(), |share| format!("{:.1}", 100.0 * share));
                    let wanted = 100.0 * found.level;
                    common.say(&format!(
                        "  {name:<8} intervals for {wanted:.0} % of the rows of parts not seen hold {reached} %"
                    ));
                }
            }
            (None, Some(why)) => common.say(&format!("  no prediction intervals: {why}")),
            (None, None) => {}
        }
    }
    if common.verbose {
        report.data.iter().flat_map(|file| &file.notes).for_each(|note| common.say(note));
        common.say_left_out(&report.left_out);
        common.say_stages(&report.stages);
    }
    say_end(common, report.wall_s, &report.pictures);
    Ok(Outcome::Done)
}

fn say_coverage(common: &Common, report: &EvaluateReport) {
    for (name, share) in report.coverage.iter().flat_map(|by| &by.0) {
        let share = share.map_or("-".to_owned(), |share| format!("{:.1}", 100.0 * share));
        common.say(&format!("  {name:<8} {share} % of the rows within the model's prediction intervals"));
    }
}
