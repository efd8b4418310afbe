//! `evaluate`: how far off a model is on recordings (5.3, 5.4).

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::log_keys::LogKeys;
use super::options::{fault, read, told};
use super::pool::in_pool;
use super::recordings::{ambient_step, data_files, measured, reading};
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Work};
use crate::predictor::{ByChoice, EvaluateOptions, FOLDS, FolderOutputs, LEVEL, evaluate, evaluate_plan, share};
use crate::stages::Step;

const ROWS: &str = "predicted";
const PICTURES: &str = "pictures";

/// The kind.
pub(super) static EVALUATE: Kind = Kind {
    name: "evaluate",
    about: "how far off a model is on recordings",
    roles: &[
        Role { name: "model", takes: Takes::One, about: "a model of train" },
        Role { name: "data", takes: Takes::Many, about: "recordings with the model's photodiodes and targets" },
    ],
    parts: &[
        Part {
            name: "merit",
            file: "merit.csv",
            only_if_wanted: false,
            about: "errors, a row a target and what it was told on",
        },
        Part { name: ROWS, file: "predicted.csv", only_if_wanted: true, about: "measured and predicted, a row each" },
        Part { name: PICTURES, file: "", only_if_wanted: true, about: "over time, as scatter and by size" },
    ],
    revision: 1,
    keys: KEYS,
    prepare,
};

const KEYS: &[&str] = &[
    "by",
    "folds",
    "seed",
    "level",
    "drop_invalid",
    "keep_faults",
    "columns",
    "time_unit",
    "full_scale",
    "piece",
    "stream",
];

/// A stage's keys, named as the command's options.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(default)]
struct Asked {
    #[serde(with = "crate::words::optional")]
    by: Option<ByChoice>,
    folds: u16,
    seed: u64,
    level: f64,
    drop_invalid: bool,
    keep_faults: bool,
}

impl Default for Asked {
    fn default() -> Self {
        Self { by: None, folds: FOLDS, seed: 1, level: LEVEL, drop_invalid: false, keep_faults: false }
    }
}

fn prepare(mut table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    let log = LogKeys::take(&mut table)?;
    let asked: Asked = read(KEYS, table)?;
    share(asked.level).map_err(|why| fault("level", why))?;
    if !(2..=1000).contains(&asked.folds) {
        return Err(fault("folds", format!("{}: choose 2 to 1000", asked.folds)));
    }
    Ok(Arc::new(Evaluation(asked, log)))
}

struct Evaluation(Asked, LogKeys);

impl Evaluation {
    fn options(&self) -> EvaluateOptions {
        let Asked { by, folds, seed, level, drop_invalid, keep_faults } = self.0;
        let (by, log) = (by.map(|by| by.by(folds, seed)), self.1.reading.clone());
        EvaluateOptions { drop_invalid, keep_faults, log, by, level, called: None }
    }
}

/// Which of the results, in a folder.
fn outputs(folder: &std::path::Path, demand: &Demand) -> FolderOutputs {
    let wants = |part: &str| demand.parts.contains(part);
    FolderOutputs { folder: folder.to_owned(), rows: wants(ROWS), figures: wants(PICTURES), report: false }
}

impl Prepared for Evaluation {
    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        // Which joints recordings have to hold, the model tells once it stands.
        Demand { clock: own.clock, ..Demand::default() }
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        self.1.tell(told(&self.0, demand, &[ROWS, PICTURES]))
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(EvaluateJob { options: self.options(), demand: demand.clone() })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let files = inputs.iter().filter(|input| input.role == "data").count();
        let out = outputs(std::path::Path::new(""), demand);
        let mut steps = evaluate_plan(files, &self.options(), None, Some(&out));
        steps.insert(1, ambient_step(inputs, &["data"], &self.1.reading));
        Ok(steps)
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let (memory, read_s, rows) = reading(inputs);
        let parts = self.0.by.map_or(0.0, |by| if by == ByChoice::Rows { f64::from(self.0.folds) } else { 30.0 });
        (memory, read_s + 0.3 + rows * 1e-6 * (1.0 + parts))
    }
}

struct EvaluateJob {
    options: EvaluateOptions,
    demand: Demand,
}

impl Job for EvaluateJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let model = work.one("model").ok_or_else(|| anyhow::anyhow!("there is no model to evaluate"))?;
        let options = EvaluateOptions { called: Some(model.name.clone()), ..self.options.clone() };
        let outputs = outputs(work.folder, &self.demand);
        let data = data_files(work, "data");
        let report = in_pool(work.threads, || evaluate(&model.path, &data, &options, Some(&outputs), work.stop))??;
        let mut quality = measured(&report.merit, "");
        if let Some(found) = &report.held_out {
            quality.extend(measured(&found.pooled, ", parts held out"));
        }
        Ok(Made {
            report: serde_json::to_value(&report)?,
            left_out: report.left_out,
            warnings: report.warnings,
            failed: Vec::new(),
            stages: report.stages,
            quality,
        })
    }
}
