//! `lunula performance`: time per decision and how it is learned.

use std::path::PathBuf;

use clap::Args;
use lunula::job::Given;
use lunula::live::performance::{
    self, Comparison, MethodFigures, PerformanceOptions, PerformanceReport, Statement, TrialMean,
};

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

const EXAMPLES: &str = "Examples:
The thesis' course (appendix C): 1.42 m at 25 mm/s, 27 moves:
  lunula performance trials.csv --path-m 1.42 --speed-mps 0.025 --decisions 27 --out results

The table has one row per operator, method and trial:
  operator,method,trial,time_s
  A,pendant,1,312.4
  A,virtual,1,151.0

A row without a time is a trial that was not done. A time that is shorter than path / speed can't be: it is named and \
kept out. Learning curves of at least 6 trials are fitted to the means: a + b exp(-(n - 1) / c) and a + b n^-c.";

/// Compare methods of control by the time per decision, and how it is learned (thesis, appendix C)
///
/// Time per decision is (time - path / speed) / decisions. Results: performance.json, with means and SD over operators,
/// learning curves with standard errors, the trial at which each method levels off, and paired differences with 95 %
/// intervals; the means as table.csv, each row's time per decision as rows.csv, pictures (Fig. 123 and 124), and
/// run.json.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct PerformanceArgs {
    /// The trials: operator,method,trial,time_s (.csv or .parquet)
    #[arg(value_name = "TRIALS.csv")]
    trials: PathBuf,
    #[command(flatten)]
    given: Given<PerformanceOptions>,
    #[command(flatten)]
    results: ResultArgs,
}

pub(crate) fn run(PerformanceArgs { trials, given, results }: &PerformanceArgs) -> anyhow::Result<Outcome> {
    let (name, options) = (trials.display().to_string(), &given.options);
    jobs::run(
        &results.request("performance", "steps", &given.said),
        || Ok(performance::plan(&results.outputs())),
        |watch| Ok(performance::run(trials, &name, options, &results.outputs(), watch)?),
        say,
    )
}

fn say(common: &Common, report: &PerformanceReport) {
    common.say(&format!(
        "{} trials of {} operators; driving alone takes {:.1} s",
        report.rows,
        report.operators.len(),
        report.shortest_s
    ));
    report.methods.iter().for_each(|method| say_method(common, method));
    report.comparisons.iter().for_each(|one| say_comparison(common, one));
    common.say(&report.level);
}

fn say_method(common: &Common, method: &MethodFigures) {
    let (Some(first), Some(last)) = (method.trials.first(), method.trials.last()) else { return };
    let time = |of: &TrialMean| {
        let sd = of.over_operators.sd.map_or(String::new(), |sd| format!(" ± {sd:.2}"));
        format!("{:.2}{sd} s in trial {} (n {})", of.over_operators.mean, of.trial, of.over_operators.n)
    };
    let level = match &method.levels_off {
        Some(level) => format!(
            "; levels off at trial {:.1} (95 % {:.1} to {}){}",
            level.trial.trial.value,
            level.trial.low,
            level.trial.high.map_or("no end".to_owned(), |high| format!("{high:.1}")),
            if level.was_reached { "" } else { ", which was not reached" }
        ),
        None => String::new(),
    };
    common.say(&format!("{}: {}, {}{level}", method.method, time(first), time(last)));
    if let Some(curve) = method.fitted.better_curve() {
        let law = method.fitted.better.map_or("", |law| law.formula());
        common.say(&format!(
            "  {law}: a {:.2} ± {:.2} s, b {:.2} ± {:.2} s, c {:.2} ± {:.2}{}",
            curve.a.value,
            curve.a.se,
            curve.b.value,
            curve.b.se,
            curve.c.value,
            curve.c.se,
            match method.fitted.aicc_difference {
                Some(difference) => format!("; AICc better by {:.1}", difference.abs()),
                None => String::new(),
            }
        ));
    }
}

fn say_comparison(common: &Common, one: &Comparison) {
    if let Some(paired) = &one.overall {
        let between = |ends: Option<[f64; 2]>| {
            ends.map_or("no interval of one operator".to_owned(), |[low, high]| format!("95 % {low:.2} to {high:.2}"))
        };
        let ratio = match paired.ratio {
            Some(ratio) => format!("; {ratio:.2} times as long ({})", between(paired.ratio_interval)),
            None => String::new(),
        };
        common.say(&format!(
            "{} less {}: {:.2} s per decision ({}; n {}){ratio}",
            one.method,
            one.baseline,
            paired.difference,
            between(paired.difference_interval),
            paired.n
        ));
    }
    let answer = |statement: &Statement| {
        let Some(ratio) = statement.ratio else { return "not known".to_owned() };
        let interval =
            statement.ratio_interval.map_or(String::new(), |[low, high]| format!(", 95 % {low:.2} to {high:.2}"));
        match statement.holds {
            Some(holds) => format!("{ratio:.2}{interval}, so {}", if holds { "yes" } else { "no" }),
            None => format!("not known ({ratio:.2}{interval}): {}", statement.unsettled.unwrap_or_default()),
        }
    };
    common.say(&format!("  less than half the time per decision initially? {}", answer(&one.initially)));
    common.say(&format!("  at most half the trials to level off? {}", answer(&one.to_level_off)));
}
