//! `lunula layout`: where to put photodiodes.

use clap::Args;
use lunula::job::{Given, Watch};
use lunula::layout::{LayoutFigures, LayoutInputs, LayoutOptions, LayoutReport, Method, plan, run};

use crate::Common;
use crate::jobs::{Command, Plan, Request, ResultArgs, needed};

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

impl Command for LayoutArgs {
    type Figures = LayoutFigures;

    const NAME: &'static str = "layout";

    const UNIT: &'static str = "numbers of photodiodes";

    fn given(&self) -> Request<'_> {
        self.results.given(&self.given.said)
    }

    fn plan(&self) -> anyhow::Result<Plan> {
        Ok(plan(&self.inputs, &self.given.options, self.results.outputs().as_ref()).into())
    }

    fn run(&self, watch: &Watch<'_>) -> anyhow::Result<LayoutReport> {
        Ok(run(&self.inputs, &self.given.options, &needed(self.results.outputs())?, watch)?)
    }

    fn say(&self, common: &Common, report: &LayoutReport) {
        common.say(&format!(
            "{} candidates, {} person(s); error: {} ({} without photodiodes)",
            report.candidates,
            report.persons.len(),
            report.error_is,
            report.error_of_none
        ));
        common.say("   k  method       error   left out (95 %)           proof       places");
        for one in report.methods.iter().filter(|one| matches!(one.method, Method::Best | Method::Thesis | Method::All))
        {
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
}
