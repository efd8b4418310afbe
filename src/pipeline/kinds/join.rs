//! `join`: the labelled sets of a session that was filmed in several videos to one, in the order of time.
//!
//! One set alone is passed on as it is.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::json;

use super::format::{FORMAT, format, named};
use super::given::Given;
use super::pool::in_pool;
use crate::align::join;
use crate::pipeline::{Demand, Facts, Foreseen, Job, KeyFault, Keys, Kind, Made, Part, Prepared, Role, Takes, Work};
use crate::stages::{Stages, Step};
use crate::table::TableFormat;

/// The kind.
pub(super) static JOIN: Kind = Kind {
    name: "join",
    about: "labelled sets of several videos to one table in the order of time",
    roles: &[Role { name: "sets", takes: Takes::Many, about: "what `align` made" }],
    parts: &[Part { name: "training", file: "training.csv", only_if_wanted: false, about: "all rows" }],
    revision: 1,
    keys: KEYS,
    prepare: |keys| Ok(Arc::new(Join::prepare(keys)?)),
};

const KEYS: &[&str] = &[FORMAT];

#[derive(Debug, Clone, Copy)]
struct Join {
    format: TableFormat,
}

impl Join {
    fn prepare(keys: toml::Table) -> Result<Self, KeyFault> {
        Ok(Self { format: format(&mut Given::new(keys, KEYS)?)? })
    }

    fn name(self) -> &'static str {
        named(self.format, "training.csv", "training.parquet")
    }
}

impl Prepared for Join {
    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        Demand { parts: ["training"].into(), joints: own.joints.clone(), clock: own.clock }
    }

    fn options(&self, _demand: &Demand) -> serde_json::Value {
        json!({ "format": named(self.format, "csv", "parquet") })
    }

    fn job(&self, _keys: &Keys, _demand: &Demand) -> Arc<dyn Job> {
        Arc::new(*self)
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let several = inputs.len() > 1;
        let why = if several { format!("{} sets", inputs.len()) } else { "one video: its set is passed on".to_owned() };
        Ok(vec![Step::new("sets joined", several, why)])
    }

    fn facts(&self, inputs: &[Foreseen], _demand: &Demand) -> Facts {
        inputs.first().map(|first| first.facts).unwrap_or_default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let size = |input: &Foreseen| std::fs::metadata(&input.path).map_or(1 << 20, |about| about.len());
        let bytes: u64 = inputs.iter().map(size).sum();
        ((32 << 20) + 8 * bytes, 0.01 + 3e-8 * bytes as f64)
    }

    fn file(&self, _part: &Part) -> &'static str {
        self.name()
    }
}

impl Job for Join {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let sets: Vec<PathBuf> = work.of("sets").map(|at| at.path.clone()).collect();
        let to = work.folder.join(self.name());
        let stages = Stages::default();
        let is_so = |set: &PathBuf| TableFormat::of(set).is_ok_and(|format| format == self.format);
        let (rows, left_out) = match &sets[..] {
            [only] if is_so(only) => {
                stages.time("pass on", || std::fs::copy(only, &to))?;
                (None, vec!["sets joined: one video, whose set is passed on".to_owned()])
            }
            _ => (Some(stages.time("join", || in_pool(work.threads, || join(&sets, &to, &to)))??), Vec::new()),
        };
        let report = json!({ "job": "join", "sets": sets.len(), "rows": rows });
        Ok(Made { report, left_out, stages: stages.list(), ..Made::default() })
    }
}
