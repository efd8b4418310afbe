//! `responses` in a pipeline: how photodiodes answer to a force or to bending that goes up and down (3.3, Fig. 23 to
//! 34).

use std::collections::BTreeSet;

use super::{NamedFile, ResponsesOptions, responses, steps};
use lunula::job::{Demand, Foreseen, Job, Kind, Made, OptionFault, Order, Part, Role, Takes, Work, keys, prepare};
use lunula::log::{LogReading, ReadingCost, ambient_step};
use lunula::stages::Step;

/// A stage of a pipeline.
#[derive(Debug, Clone)]
pub(crate) struct ResponsesJob(ResponsesOptions);

impl Job for ResponsesJob {
    const KIND: Kind = Kind {
        name: "responses",
        roles: &[Role {
            name: "data",
            takes: Takes::Many,
            about: "recordings with photodiodes and the force or angle",
        }],
        parts: &[
            Part { name: "responses", file: "", only_if_wanted: false },
            Part { name: "table", file: "responses.csv", only_if_wanted: false },
        ],
        revision: 1,
        keys: keys::<ResponsesOptions>,
        prepare: prepare::<Self>,
    };

    type Options = ResponsesOptions;

    fn new(options: ResponsesOptions) -> Result<Self, OptionFault> {
        options.places().map_err(|what| OptionFault { key: "places".to_owned(), what })?;
        Ok(Self(options))
    }

    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        let joint = self.0.drive.strip_suffix("_deg");
        let mut joints: BTreeSet<String> = joint.map(str::to_owned).into_iter().collect();
        // The coupling of the joints (Fig. 33).
        if joint == Some("J2") {
            joints.insert("J3".to_owned());
        }
        Demand { parts: BTreeSet::new(), joints: Some(joints), clock: own.clock }
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let mut steps = steps(&self.0);
        steps.insert(0, ambient_step(inputs, &["data"], &LogReading::default()));
        Ok(steps)
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let reading = ReadingCost::of(inputs);
        (reading.memory, reading.seconds + 0.8)
    }

    fn each(&self) -> &'static [&'static str] {
        &["subject"]
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let files: Vec<NamedFile> =
            work.of("data").map(|at| NamedFile { path: at.path.clone(), name: at.name.clone() }).collect();
        let report = work.run(order.said, |watch| responses(&files, &self.0, work.folder, watch))?;
        Ok(report.made(Vec::new()))
    }
}
