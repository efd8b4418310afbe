//! `layout` in a pipeline: recordings or maps to places.

use super::job::run;
use super::plan::steps;
use super::report::LayoutFigures;
use super::results::{POSITIONS, TABLE};
use crate::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Quality, Role, Takes, Work};
use crate::layout::options::{LayoutInputs, LayoutOptions};
use crate::layout::read::is_maps;
use crate::layout::solve::Method;
use crate::log::ReadingCost;
use crate::predictor::DataFile;
use crate::stages::Step;

impl Job for LayoutOptions {
    const KIND: Kind = Kind::of::<Self>(
        "layout",
        &[
            Role::new("data", Takes::Many, "tables of cells or photodiodes with targets, or maps"),
            Role::new("positions", Takes::Optional, "where the photodiodes are"),
        ],
        &[Part::new("layout", POSITIONS), Part::new("table", TABLE), Part::pictures("")],
    )
    .revision(12);

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let data: Vec<&Foreseen> = inputs.iter().filter(|input| input.role == "data").collect();
        let maps = matches!(&data[..], [one] if is_maps(&one.path));
        Ok(steps(data.len(), maps, self, &demand.outputs("")))
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let ReadingCost { memory, seconds, .. } = ReadingCost::of(inputs);
        // A billion multiply-adds a second, and as much again for persons left out (assumed).
        (memory + (64 << 20), seconds + 2.0 * self.proof * self.k.0.len() as f64)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let inputs = LayoutInputs {
            data: work.of("data").map(DataFile::from).collect(),
            positions: work.one("positions").map(|input| input.path.clone()),
        };
        let outputs = order.demand.outputs(work.folder);
        let report = work.run(order.said, |watch| run(&inputs, self, &outputs, watch))?;
        let quality = quality(&report);
        Ok(report.made(quality))
    }
}

/// What the chosen layout leaves.
fn quality(figures: &LayoutFigures) -> Vec<Quality> {
    let own = figures.methods.iter().find(|one| one.method == Method::Best && one.k == figures.chosen.k);
    own.map(|own| Quality::stated("layout", own.error, figures.error_is)).into_iter().collect()
}
