//! `typical` in a pipeline: one subject's normalized pictures in all poses, as they are and with contrast (Fig. 51 and
//! 52).

use anyhow::Context;
use clap::Args;
use serde::Serialize;

use crate::coloration::coloration_sheets;
use lunula::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Role, Takes, Work};
use lunula::stages::Step;

/// A stage of a pipeline.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct TypicalJob {}

#[derive(Debug, Serialize)]
struct TypicalFigures {
    subject: String,
}

impl Job for TypicalJob {
    const KIND: Kind = Kind::of::<Self>(
        "typical",
        &[Role::new("pictures", Takes::One, "normalize's part `pictures` of a subject")],
        &[Part::new("sheets", "")],
    );

    fn steps(&self, _inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(vec![Step::new("sheets", true, "of all poses, as they are and with contrast".to_owned())])
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (96_000_000, 0.5)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let pictures = work.needed("pictures")?;
        let report = work.report::<Self, _>(order.said, "sheets", || {
            let subject = coloration_sheets(&pictures.path, None, work.folder).context(pictures.name.clone())?;
            Ok(TypicalFigures { subject })
        })?;
        Ok(report.made(Vec::new()))
    }
}
