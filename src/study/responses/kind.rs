//! `responses`: how photodiodes answer to a force or to bending that goes up and down (3.3, Fig. 23 to 34).

use std::collections::BTreeSet;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::options::{fault, read, told};
use super::pool::in_pool;
use super::recordings::{ambient_step, reading};
use crate::log::LogReading;
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Work};
use crate::stages::Step;
use crate::study::responses::{DRIVES, NamedFile, Places, ResponsesOptions, responses};

/// The kind.
pub(super) static RESPONSES: Kind = Kind {
    name: "responses",
    about: "how photodiodes answer to a force or to bending that goes up and down, averaged over cycles",
    roles: &[Role { name: "data", takes: Takes::Many, about: "recordings with photodiodes and the force or angle" }],
    parts: &[
        Part { name: "responses", file: "", only_if_wanted: false, about: "pictures, responses.csv and numbers.json" },
        Part { name: "table", file: "responses.csv", only_if_wanted: false, about: "averages over cycles" },
    ],
    revision: 1,
    keys: KEYS,
    prepare,
};

const KEYS: &[&str] = &["drive", "bins", "places"];

/// A stage's keys.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(default)]
struct Asked {
    /// What goes up and down.
    drive: String,
    bins: usize,
    /// Rows from distal to proximal.
    places: Vec<Vec<String>>,
}

impl Default for Asked {
    fn default() -> Self {
        let usual = ResponsesOptions::of("");
        Self { drive: usual.drive, bins: usual.bins, places: usual.places.0 }
    }
}

fn prepare(table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    let asked: Asked = read(KEYS, table)?;
    if !DRIVES.contains(&asked.drive.as_str()) {
        return Err(fault("drive", format!("\"{}\": choose one of {}", asked.drive, DRIVES.join(", "))));
    }
    if !(4..=200).contains(&asked.bins) {
        return Err(fault("bins", format!("{}: choose 4 to 200", asked.bins)));
    }
    let places = Places::checked(asked.places.clone()).map_err(|why| fault("places", why))?;
    let options = ResponsesOptions { drive: asked.drive.clone(), bins: asked.bins, places };
    Ok(Arc::new(Responding { asked, options }))
}

struct Responding {
    asked: Asked,
    options: ResponsesOptions,
}

impl Prepared for Responding {
    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        let joint = self.options.drive.strip_suffix("_deg");
        let mut joints: BTreeSet<String> = joint.map(str::to_owned).into_iter().collect();
        // The coupling of the joints (Fig. 33).
        if joint == Some("J2") {
            joints.insert("J3".to_owned());
        }
        Demand { parts: BTreeSet::new(), joints: Some(joints), clock: own.clock }
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        told(&self.asked, demand, &[])
    }

    fn job(&self, _keys: &Keys, _demand: &Demand) -> Arc<dyn Job> {
        Arc::new(ResponsesJob(self.options.clone()))
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let bends = self.options.drive == "J2_deg";
        Ok(vec![
            ambient_step(inputs, &["data"], &LogReading::default()),
            Step::new("cycles", true, format!("of {}", self.options.drive)),
            Step::new("averages", true, "over cycles, rising and falling".to_owned()),
            Step::new(
                "coupling",
                bends,
                if bends { "J3 over J2, where the recording has J3" } else { "it is J2's alone" }.to_owned(),
            ),
        ])
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let (memory, read_s, _) = reading(inputs);
        (memory, read_s + 0.8)
    }

    fn each(&self) -> &'static [&'static str] {
        &["subject"]
    }
}

struct ResponsesJob(ResponsesOptions);

impl Job for ResponsesJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let files: Vec<NamedFile> =
            work.of("data").map(|at| NamedFile { path: at.path.clone(), name: at.name.clone() }).collect();
        let report = in_pool(work.threads, || responses(&files, &self.0, work.folder))??;
        Ok(Made {
            report: serde_json::to_value(&report)?,
            warnings: report.warnings,
            stages: report.stages,
            ..Made::default()
        })
    }
}
