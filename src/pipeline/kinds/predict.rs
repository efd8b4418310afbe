//! `predict`: forces and angle from photodiodes, by models that stand (5.1).

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::log_keys::LogKeys;
use super::options::{fault, read, told};
use super::pool::in_pool;
use super::recordings::{ambient_step, only_joints, reading};
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Work};
use crate::predictor::models::Gate;
use crate::predictor::{F_MIN_N, PredictOptions, predict, predict_plan};
use crate::stages::Step;

/// The kind.
pub(super) static PREDICT: Kind = Kind {
    name: "predict",
    about: "forces and angle from photodiodes",
    roles: &[
        Role { name: "data", takes: Takes::One, about: "a recording" },
        Role { name: "model", takes: Takes::Many, about: "a model of force, of posture, or both: then they are gated" },
    ],
    parts: &[Part {
        name: "predicted",
        file: "predicted.csv",
        only_if_wanted: false,
        about: "predictions, a row each",
    }],
    revision: 1,
    keys: KEYS,
    prepare,
};

const KEYS: &[&str] = &[
    "f_min",
    "theta_touch",
    "hysteresis",
    "intervals",
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
    f_min: f64,
    theta_touch: f64,
    hysteresis: f64,
    intervals: bool,
    drop_invalid: bool,
    keep_faults: bool,
}

impl Default for Asked {
    fn default() -> Self {
        Self {
            f_min: F_MIN_N,
            theta_touch: 0.0,
            hysteresis: 0.0,
            intervals: false,
            drop_invalid: false,
            keep_faults: false,
        }
    }
}

fn prepare(mut table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    let log = LogKeys::take(&mut table)?;
    let asked: Asked = read(KEYS, table)?;
    let gate = Gate::new(asked.f_min, asked.theta_touch, asked.hysteresis);
    let gate = gate.map_err(|why| fault("", why.to_string()))?;
    let Asked { intervals, drop_invalid, keep_faults, .. } = asked;
    let options = PredictOptions { gate, intervals, drop_invalid, keep_faults, log: log.reading.clone() };
    Ok(Arc::new(Prediction { options, asked, log }))
}

struct Prediction {
    asked: Asked,
    options: PredictOptions,
    log: LogKeys,
}

impl Prepared for Prediction {
    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        // Photodiodes alone are read.
        only_joints(Default::default(), own)
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        self.log.tell(told(&self.asked, demand, &[]))
    }

    fn job(&self, _keys: &Keys, _demand: &Demand) -> Arc<dyn Job> {
        Arc::new(PredictJob(self.options.clone()))
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let models = inputs.iter().filter(|input| input.role == "model").count();
        let mut steps = predict_plan(models, &self.options);
        steps.insert(1, ambient_step(inputs, &["data"], &self.options.log));
        Ok(steps)
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts { led: Some(false), ..Facts::default() }
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let (memory, read_s, rows) = reading(inputs);
        (memory, read_s + 1e-6 * rows)
    }
}

struct PredictJob(PredictOptions);

impl Job for PredictJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let data = work.one("data").context("there is no recording to predict")?;
        let models: Vec<PathBuf> = work.of("model").map(|at| at.path.clone()).collect();
        let out = work.folder.join("predicted.csv");
        let report = in_pool(work.threads, || predict(&models, &data.path, &self.0, &out, work.stop))??;
        Ok(Made {
            report: serde_json::to_value(&report)?,
            warnings: report.warnings,
            stages: report.stages,
            ..Made::default()
        })
    }
}
