//! `prune`: which photodiodes could be removed (5.5, Fig. 113).

use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::log_keys::LogKeys;
use super::options::{read, told};
use super::pool::in_pool;
use super::recordings::{ambient_step, data_files, joints, only_joints, reading};
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Quality, Work};
use crate::predictor::{FolderOutputs, PruneRow, Target, Wanted, prune, prune_plan};
use crate::stages::Step;

const PICTURES: &str = "pictures";

/// The kind.
pub(super) static PRUNE: Kind = Kind {
    name: "prune",
    about: "the linear model's errors for every subset of the photodiodes",
    roles: &[
        Role { name: "data", takes: Takes::Many, about: "recordings to train on" },
        Role { name: "validate", takes: Takes::Many, about: "others to compare on" },
    ],
    parts: &[
        Part { name: "subsets", file: "subsets.csv", only_if_wanted: false, about: "errors, a row a subset" },
        Part {
            name: PICTURES,
            file: "",
            only_if_wanted: true,
            about: "without one photodiode, the best of each number",
        },
    ],
    revision: 1,
    keys: KEYS,
    prepare,
};

const KEYS: &[&str] =
    &["target", "inputs", "drop_invalid", "keep_faults", "columns", "time_unit", "full_scale", "piece", "stream"];

/// A stage's keys, named as the command's options.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
struct Asked {
    target: Target,
    inputs: Option<Vec<String>>,
    drop_invalid: bool,
    keep_faults: bool,
}

fn prepare(mut table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    let log = LogKeys::take(&mut table)?;
    Ok(Arc::new(Pruning(read(KEYS, table)?, log)))
}

struct Pruning(Asked, LogKeys);

fn outputs(folder: &Path, demand: &Demand) -> FolderOutputs {
    let figures = demand.parts.contains(PICTURES);
    FolderOutputs { folder: folder.to_owned(), rows: true, figures, report: false }
}

impl Prepared for Pruning {
    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        only_joints(joints(&self.0.target), own)
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        self.1.tell(told(&self.0, demand, &[PICTURES]))
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        let Asked { target, inputs, drop_invalid, keep_faults } = self.0.clone();
        let log = self.1.reading.clone();
        let targets = target.columns().to_vec();
        let wanted = Wanted { inputs, targets, drop_invalid, keep_faults, log, skip_failed: false };
        Arc::new(PruneJob { wanted, demand: demand.clone() })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let count = |role: &str| inputs.iter().filter(|input| input.role == role).count();
        let out = outputs(Path::new(""), demand);
        let mut steps = prune_plan([count("data"), count("validate")], Some(&out));
        steps.insert(1, ambient_step(inputs, &["data", "validate"], &self.1.reading));
        Ok(steps)
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let (memory, read_s, rows) = reading(inputs);
        (memory, read_s + 0.3 + 1e-6 * rows)
    }
}

struct PruneJob {
    wanted: Wanted,
    demand: Demand,
}

impl Job for PruneJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let (data, validate) = (data_files(work, "data"), data_files(work, "validate"));
        let out = outputs(work.folder, &self.demand);
        let report = in_pool(work.threads, || prune(&data, &validate, &self.wanted, Some(&out), work.stop))??;
        let best = |row: &PruneRow| {
            let what = format!("best {} photodiodes", row.inputs.len());
            let unit = "of the targets' SD, RMS".to_owned();
            row.score.map(|value| Quality { what, value, unit, against_truth: true })
        };
        Ok(Made {
            report: serde_json::to_value(&report)?,
            quality: report.best_of_size.iter().filter_map(best).collect(),
            left_out: report.left_out,
            warnings: report.warnings,
            failed: Vec::new(),
            stages: report.stages,
        })
    }
}
