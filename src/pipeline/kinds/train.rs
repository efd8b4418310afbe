//! `train`: recordings to a model of force or posture (5.).

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::log_keys::LogKeys;
use super::options::{counts, fault, read, told};
use super::pool::in_pool;
use super::recordings::{ambient_step, data_files, foreseen, joints, measured, only_joints, reading};
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Work};
use crate::predictor::models::{Deficient, Kind as ModelKind, Recipe};
use crate::predictor::{
    DataFile, HIDDEN, LEVEL, ModelChoice, Target, TrainInputs, TrainOptions, TrainOutputs, Wanted, share, train,
    train_plan,
};
use crate::stages::Step;

const CURVE: &str = "learning_curve";

/// The kind.
pub(super) static TRAIN: Kind = Kind {
    name: "train",
    about: "recordings of photodiodes with forces or angles to a model",
    roles: &[
        Role { name: "data", takes: Takes::Many, about: "recordings to train on" },
        Role { name: "validate", takes: Takes::AnyNumber, about: "recordings to report on" },
        Role {
            name: "stop_on",
            takes: Takes::AnyNumber,
            about: "recordings on which a network's training stops early",
        },
    ],
    parts: &[
        Part { name: "model", file: "model.json", only_if_wanted: false, about: "the model" },
        Part {
            name: "merit",
            file: "merit.csv",
            only_if_wanted: false,
            about: "errors on the rows trained on and reported on",
        },
        Part {
            name: CURVE,
            file: "learning-curve.csv",
            only_if_wanted: true,
            about: "the error against how much was trained on, and a picture",
        },
    ],
    revision: 1,
    keys: KEYS,
    prepare,
};

const KEYS: &[&str] = &[
    "target",
    "model",
    "hidden",
    "inputs",
    "lags",
    "friction",
    "deficient",
    "seed",
    "restarts",
    "epochs",
    "level",
    "drop_invalid",
    "keep_faults",
    "skip_failed",
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
    target: Option<Target>,
    #[serde(with = "crate::words")]
    model: ModelChoice,
    hidden: u16,
    inputs: Option<Vec<String>>,
    lags: Vec<f64>,
    friction: Option<f64>,
    #[serde(deserialize_with = "by_word")]
    deficient: Deficient,
    seed: u64,
    restarts: u16,
    epochs: u32,
    level: f64,
    drop_invalid: bool,
    keep_faults: bool,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    skip_failed: bool,
}

/// `refuse`, `ridge=1e-6`, as on the command line.
fn by_word<'de, D: serde::Deserializer<'de>>(from: D) -> Result<Deficient, D::Error> {
    String::deserialize(from)?.parse().map_err(serde::de::Error::custom)
}

impl Default for Asked {
    fn default() -> Self {
        let usual = Recipe::new(ModelKind::Linear);
        Self {
            target: None,
            model: ModelChoice::default(),
            hidden: HIDDEN,
            inputs: None,
            lags: usual.lags_s,
            friction: usual.friction_mu,
            deficient: usual.deficient,
            seed: usual.seed,
            restarts: usual.restarts as u16,
            epochs: usual.max_epochs as u32,
            level: LEVEL,
            drop_invalid: false,
            keep_faults: false,
            skip_failed: false,
        }
    }
}

struct Training {
    asked: Asked,
    target: Target,
    log: LogKeys,
}

fn prepare(mut table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    let log = LogKeys::take(&mut table)?;
    let asked: Asked = read(KEYS, table)?;
    let target =
        asked.target.clone().ok_or_else(|| fault("target", "is needed: force, posture or columns as Fz_N,J3_deg"))?;
    share(asked.level).map_err(|why| fault("level", why))?;
    counts(&[
        ("hidden", asked.hidden.into(), 1000),
        ("restarts", asked.restarts.into(), 1000),
        ("epochs", asked.epochs, u32::MAX),
    ])?;
    Ok(Arc::new(Training { asked, target, log }))
}

impl Training {
    fn options(&self) -> TrainOptions {
        let asked = &self.asked;
        TrainOptions {
            wanted: Wanted {
                inputs: asked.inputs.clone(),
                targets: self.target.columns().to_vec(),
                drop_invalid: asked.drop_invalid,
                keep_faults: asked.keep_faults,
                log: self.log.reading.clone(),
                skip_failed: asked.skip_failed,
            },
            recipe: Recipe {
                deficient: asked.deficient,
                seed: asked.seed,
                restarts: usize::from(asked.restarts),
                max_epochs: asked.epochs as usize,
                lags_s: asked.lags.clone(),
                friction_mu: asked.friction,
                ..Recipe::new(asked.model.kind(asked.hidden))
            },
            level: asked.level,
        }
    }
}

impl Prepared for Training {
    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        only_joints(joints(&self.target), own)
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        self.log.tell(told(&self.asked, demand, &[CURVE]))
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(TrainJob { options: self.options(), curve: demand.parts.contains(CURVE) })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let of = |role: &str| foreseen(inputs, role);
        let files = TrainInputs { data: of("data"), validate: of("validate"), stop_on: of("stop_on") };
        let mut steps = train_plan(&files, &self.options().recipe, demand.parts.contains(CURVE));
        steps.insert(1, ambient_step(inputs, &["data", "validate", "stop_on"], &self.log.reading));
        Ok(steps)
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let (memory, read_s, rows) = reading(inputs);
        let asked = &self.asked;
        let fit_s = match asked.model {
            ModelChoice::Linear => 1e-6 * rows,
            ModelChoice::Quadratic => 1e-5 * rows,
            ModelChoice::Network => NETWORK_S * rows * f64::from(asked.hidden) * f64::from(asked.restarts),
        };
        (memory, read_s + fit_s)
    }
}

/// A network's training takes about so long for each row, hidden node and start, seconds.
pub(super) const NETWORK_S: f64 = 3e-6;

struct TrainJob {
    options: TrainOptions,
    curve: bool,
}

impl Job for TrainJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let of = |role: &str| -> Vec<DataFile> { data_files(work, role) };
        let inputs = TrainInputs { data: of("data"), validate: of("validate"), stop_on: of("stop_on") };
        let place = |name: &str| work.folder.join(name);
        let outputs = TrainOutputs {
            model: place("model.json"),
            learning_curve: self.curve.then(|| place("learning-curve.csv")),
            merit: Some(place("merit.csv")),
        };
        let report = in_pool(work.threads, || train(&inputs, &self.options, &outputs, work.stop))??;
        let quality = match &report.validation {
            Some(merit) => measured(merit, ""),
            None => measured(&report.training, ", rows trained on"),
        };
        Ok(Made {
            report: serde_json::to_value(&report)?,
            left_out: report.left_out,
            warnings: report.warnings,
            failed: report.failed.into_iter().map(|file| file.why).collect(),
            stages: report.stages,
            quality,
        })
    }
}
