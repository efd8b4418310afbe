//! `lunula switch tune` and `lunula switch evaluate`: predicted pressing to a switch that can be trusted.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use lunula::job::Given;
use lunula::live::{
    ContactOptions, Evaluation, SwitchInputs, TuneOptions, TuneReport, evaluate_plan, evaluate_switch, tune_plan,
    tune_switch,
};

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

/// Choose and judge the thresholds of the virtual switch (6.1), for `lunula live --switch`
#[derive(Debug, Args)]
pub(crate) struct SwitchArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Tune(Box<TuneArgs>),
    Evaluate(Box<EvaluateArgs>),
}

/// Choose thresholds and holds from held-out recordings, for a rate of false switches
///
/// Every combination runs over all recordings; of those with at most --false-per-hour and --missed the one with the
/// highest threshold is taken that is at most a quarter slower than the fastest. Name recordings that the models were
/// not trained on, with hours of rest and of other work among them: what was not recorded is not known. Results:
/// switch.toml, beside it <switch>.run.json and the curve of delay against false switches.
#[derive(Debug, Args)]
#[command(mut_arg("out", |out| out.value_name("SWITCH.toml").help("The switch")))]
struct TuneArgs {
    #[command(flatten)]
    inputs: SwitchInputs,
    #[command(flatten)]
    given: Given<TuneOptions>,
    #[command(flatten)]
    results: ResultArgs,
}

/// Judge a switch on recordings: false switches an hour with their interval, misses, delays
///
/// Results: switch.json, presses.csv (presses that are judged and contacts that were missed), delays.png and .svg,
/// run.json.
#[derive(Debug, Args)]
struct EvaluateArgs {
    /// The switch
    #[arg(value_name = "SWITCH.toml")]
    switch: PathBuf,
    #[command(flatten)]
    inputs: SwitchInputs,
    #[command(flatten)]
    given: Given<ContactOptions>,
    #[command(flatten)]
    results: ResultArgs,
}

pub(crate) fn run(args: &SwitchArgs) -> anyhow::Result<Outcome> {
    match &args.what {
        What::Tune(args) => tune(args),
        What::Evaluate(args) => evaluate(args),
    }
}

fn tune(TuneArgs { inputs, given, results }: &TuneArgs) -> anyhow::Result<Outcome> {
    jobs::run(
        &results.request("switch tune", "recordings", &given.said),
        || Ok(tune_plan(inputs.recordings.len(), &results.outputs())),
        |watch| Ok(tune_switch(inputs, &given.options, &results.outputs(), watch)?),
        say_tuned,
    )
}

fn evaluate(EvaluateArgs { switch, inputs, given, results }: &EvaluateArgs) -> anyhow::Result<Outcome> {
    jobs::run(
        &results.request("switch evaluate", "recordings", &given.said),
        || Ok(evaluate_plan(inputs.recordings.len(), &results.outputs())),
        |watch| Ok(evaluate_switch(switch, inputs, &given.options, &results.outputs(), watch)?),
        |common, report| say_evaluation(common, "on these recordings", &report.all),
    )
}

fn say_tuned(common: &Common, report: &TuneReport) {
    let switch = &report.switch;
    let unit = if switch.column.is_none() { " N" } else { "" };
    common.say(&format!(
        "on from {}{unit}, off below {}{unit}, held {} s and {} s; of {} combinations",
        switch.on_n, switch.off_n, switch.hold_on_s, switch.hold_off_s, report.tried
    ));
    say_evaluation(common, "where it was chosen", &report.chosen);
    if let Some(held_out) = &report.held_out {
        say_evaluation(common, "held out", held_out);
    }
}

fn say_evaluation(common: &Common, wherever: &str, found: &Evaluation) {
    let rate = found.rate.map_or("an unknown number".to_owned(), |rate| {
        format!(
            "{:.2} an hour (95 %: {:.2} to {:.2})",
            rate.false_per_hour, rate.false_per_hour_low, rate.false_per_hour_high
        )
    });
    common.say(&format!(
        "{wherever}: {} false switches in {:.2} h, {rate}; {} of {} presses missed",
        found.false_switches, found.hours, found.missed, found.presses
    ));
    let delays = [("on", found.delay_on_s), ("off", found.delay_off_s)];
    for (what, delay) in delays.into_iter().filter_map(|(what, delay)| Some((what, delay?))) {
        common.say(&format!(
            "{wherever}: delay {what} {:.0} ms in median, half of them {:.0} to {:.0} ms",
            1e3 * delay.median,
            1e3 * delay.low,
            1e3 * delay.high
        ));
    }
}
