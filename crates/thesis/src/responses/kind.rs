//! `responses` in a pipeline: how photodiodes answer to a force or to bending that goes up and down (3.3, Fig. 23 to
//! 34).

use std::collections::BTreeSet;

use super::{ResponsesOptions, responses, steps};
use lunula::job::{Demand, Foreseen, Job, Kind, Made, OptionFault, Order, Part, Role, Takes, Work};
use lunula::log::{LogReading, ReadingCost, ambient_step};
use lunula::predictor::DataFile;
use lunula::stages::Step;

impl Job for ResponsesOptions {
    const KIND: Kind = Kind::of::<Self>(
        "responses",
        &[Role::new("data", Takes::Many, "recordings with photodiodes and the force or angle")],
        &[Part::new("responses", ""), Part::new("table", "responses.csv")],
    );

    fn checked(self) -> Result<Self, OptionFault> {
        self.places().map_err(|what| OptionFault { key: "places".to_owned(), what })?;
        Ok(self)
    }

    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        let joint = self.drive.strip_suffix("_deg");
        let mut joints: BTreeSet<String> = joint.map(str::to_owned).into_iter().collect();
        // The coupling of the joints (Fig. 33).
        if joint == Some("J2") {
            joints.insert("J3".to_owned());
        }
        Demand { parts: BTreeSet::new(), joints: Some(joints), clock: own.clock }
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let mut steps = steps(self);
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
        let files: Vec<DataFile> = work.of("data").map(DataFile::from).collect();
        let report = work.run(order.said, |watch| responses(&files, self, work.folder, watch))?;
        Ok(report.made(Vec::new()))
    }
}
