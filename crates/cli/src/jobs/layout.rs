//! `lunula layout`: where to put photodiodes.

use clap::Args;
use lunula::job::Given;
use lunula::layout::{self, LayoutInputs, LayoutOptions, LayoutReport, Method};

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

/// Choose where photodiodes serve best, out of all places of which there are readings (5.5, 7.2)
///
/// From tables with cells of the nail (`C_rr_cc`, lunula nailvideo --cells) or photodiodes (P1, P2, .., with
/// --positions) and loads, a table or more for each person: the places whose linear model leaves the least error. From
/// the results of lunula photos: the places at which poses are confused least. Results: layout.json, which nailvideo
/// and the phantom read as positions, layout.csv, pictures and run.json.
#[derive(Debug, Args)]
pub(crate) struct LayoutArgs {
    #[command(flatten)]
    given: Given<LayoutOptions>,
    #[command(flatten)]
    inputs: LayoutInputs,
    #[command(flatten)]
    results: ResultArgs,
}

pub(crate) fn run(args: &LayoutArgs) -> anyhow::Result<Outcome> {
    let LayoutArgs { given, inputs, results } = args;
    jobs::run(
        &results.request("layout", "numbers of photodiodes", &given.said),
        || Ok(layout::plan(inputs, &given.options, &results.outputs())),
        |watch| Ok(layout::run(inputs, &given.options, &results.outputs(), watch)?),
        say,
    )
}

fn say(common: &Common, report: &LayoutReport) {
    common.say(&format!(
        "{} candidates, {} person(s); error: {} ({} without photodiodes)",
        report.candidates,
        report.persons.len(),
        report.error_is,
        report.error_of_none
    ));
    common.say("   k  method       error   left out (95 %)           proof       places");
    for one in report.methods.iter().filter(|one| matches!(one.method, Method::Best | Method::Thesis | Method::All)) {
        let left_out = one.left_out.map_or("-".to_owned(), |own| {
            format!("{:.4} ({:.4} to {:.4})", own.error, own.interval[0], own.interval[1])
        });
        let line = format!(
            "{:>4}  {:<10}  {:.4}   {left_out:<24}  {:<10}  {}",
            one.k,
            one.method.word(),
            one.error,
            one.proof().unwrap_or_default(),
            one.places.join(" ")
        );
        common.say(line.trim_end());
    }
    common.say(&format!("chosen: {} photodiodes ({})", report.chosen.k, report.chosen.why));
}
