//! `typical` in a pipeline: one subject's normalized pictures in all poses, as they are and with contrast (Fig. 51 and
//! 52).

use std::time::Instant;

use anyhow::Context;
use serde::Serialize;

use crate::coloration::coloration_sheets;
use lunula::job::{
    Demand, Foreseen, Job, Kind, Made, NoOptions, OptionFault, Order, Part, Report, Role, Takes, Work, keys, prepare,
};
use lunula::stages::{Stages, Step};

/// A stage of a pipeline.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TypicalJob;

#[derive(Debug, Serialize)]
struct TypicalFigures {
    subject: String,
}

impl Job for TypicalJob {
    const KIND: Kind = Kind {
        name: "typical",
        roles: &[Role { name: "pictures", takes: Takes::One, about: "normalize's part `pictures` of a subject" }],
        parts: &[Part { name: "sheets", file: "", only_if_wanted: false }],
        revision: 1,
        keys: keys::<NoOptions>,
        prepare: prepare::<Self>,
    };

    type Options = NoOptions;

    fn new(_options: NoOptions) -> Result<Self, OptionFault> {
        Ok(Self)
    }

    fn steps(&self, _inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(vec![Step::new("sheets", true, "of all poses, as they are and with contrast".to_owned())])
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (96_000_000, 0.5)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let (start, stages) = (Instant::now(), Stages::default());
        let pictures = work.needed("pictures")?;
        let report = work.run(order.said, |watch| -> anyhow::Result<_> {
            let sheets = stages.time("sheets", || coloration_sheets(&pictures.path, None, work.folder));
            let subject = sheets.context(pictures.name.clone())?;
            Ok(Report::new("typical", watch, TypicalFigures { subject }).timed(&stages, start))
        })?;
        Ok(report.made(Vec::new()))
    }
}
