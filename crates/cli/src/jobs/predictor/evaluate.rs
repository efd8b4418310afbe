//! `lunula evaluate`: how far off a model is.

use std::path::PathBuf;

use clap::Args;
use clap::builder::Resettable;
use lunula::job::Given;
use lunula::predictor::models::FEWEST_UNITS;
use lunula::predictor::{DataFile, EvaluateChoices, EvaluateReport, Splits, evaluate, evaluate_plan, way};

use crate::jobs::predictor::{figure, say_merit};
use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

/// Measure how far off a model is on recordings, and how far off its recipe is on recordings held out
///
/// RMSE, bias and R2 of each target (R2 is empty where a target does not change), by recording and by the size of force
/// or angle, and how many rows the model's prediction intervals hold. With --by, the model's recipe is fitted again
/// without each trajectory, session or subject in turn and judged on what it has not seen: name all recordings then.
/// Rows of one trajectory resemble each other, so shuffled rows (--by rows) flatter; by how much is shown beside, and
/// --splits sets all ways beside each other. --out
/// draws predicted against measured over time and as scatter (Fig. 94 to 104).
#[derive(Debug, Args)]
#[command(mut_arg("out", |out| out
    .help("A folder for merit.csv, predicted.csv, pictures and run.json")
    .required_unless_present(Resettable::Reset)
))]
pub(crate) struct EvaluateArgs {
    /// A model file of `lunula train`
    #[arg(value_name = "MODEL.json")]
    model: PathBuf,
    /// Recordings with the model's photodiodes and targets
    #[arg(required = true, value_name = "DATA")]
    data: Vec<PathBuf>,
    #[command(flatten)]
    given: Given<EvaluateChoices>,
    #[command(flatten)]
    results: ResultArgs,
}

pub(crate) fn run(args: &EvaluateArgs) -> anyhow::Result<Outcome> {
    let (data, options) = (DataFile::of(&args.data), args.given.options.options());
    let outputs = args.results.outputs_if_said();
    jobs::run(
        &args.results.request("evaluate", "steps", &args.given.said),
        || {
            let ambient = DataFile::ambient_step(&data, &options.rows);
            Ok(evaluate_plan(data.len(), ambient, &options, None, outputs.as_ref()))
        },
        |watch| Ok(evaluate(&args.model, &data, &options, outputs.as_ref(), watch)?),
        say,
    )
}

fn say(common: &Common, report: &EvaluateReport) {
    say_merit(common, "the model", &report.merit);
    if let Some(plain) = &report.without_friction {
        say_merit(common, "without the cone of friction", plain);
    }
    say_coverage(common, report);
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
    if let Some(found) = &report.splits {
        say_splits(common, found);
    }
}

fn say_splits(common: &Common, found: &Splits) {
    for split in &found.ways {
        if let Some(why) = &split.fault {
            common.say(&format!("by {}: {why}", way(split.by)));
            continue;
        }
        if let Some(other) = split.same_as {
            common.say(&format!("by {}: the same parts as by {}", way(split.by), way(other)));
            continue;
        }
        let about = match split.by.counts_parts() {
            false => "; intervals are about these recordings only",
            true if split.parts < FEWEST_UNITS => "; too few to know how sure an RMSE on others is",
            true => "",
        };
        common.say(&format!("by {} ({} parts{about})", way(split.by), split.parts));
        for one in &split.methods {
            if let Some(why) = one.fault.as_ref().filter(|_| one.targets.is_empty()) {
                common.say(&format!("  {}: {why}", one.method));
            }
            for target in &one.targets {
                let interval = target
                    .interval
                    .map_or(String::new(), |ends| format!(" ({} to {})", figure(ends[0]), figure(ends[1])));
                let verdict = if target.beats_mean == Some(false) { ", no better than the mean" } else { "" };
                common.say(&format!(
                    "  {:<8} RMSE {:>8}{interval} {}{verdict}",
                    target.name,
                    figure(target.rmse),
                    one.method
                ));
            }
        }
    }
}

fn say_coverage(common: &Common, report: &EvaluateReport) {
    for (name, share) in report.within_own.iter().flat_map(|by| &by.0) {
        let share = share.map_or("-".to_owned(), |share| format!("{:.1}", 100.0 * share));
        common.say(&format!("  {name:<8} {share} % of the rows within the 95 % intervals of the model's own SD"));
    }
    for (name, share) in report.coverage.iter().flat_map(|by| &by.0) {
        let share = share.map_or("-".to_owned(), |share| format!("{:.1}", 100.0 * share));
        common.say(&format!("  {name:<8} {share} % of the rows within the model's prediction intervals"));
    }
}
