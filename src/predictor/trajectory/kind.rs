//! `trajectory`: tables of forces or angles for a prompter to play (5.2.3).

use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::nail::without_report;
use super::options::{fault, read, told};
use super::pool::in_pool;
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared};
use crate::pipeline::task::{Job, Made, Work};
use crate::predictor::trajectory::{Kind as Way, TrajectoryOptions, TrajectoryOutputs, plan, run};
use crate::stages::Step;
use crate::words::Words;

const PICTURES: &str = "pictures";
const TABLE: &str = "trajectory.csv";

/// The kind.
pub(super) static TRAJECTORY: Kind = Kind {
    name: "trajectory",
    about: "tables of forces or angles for a prompter to play",
    roles: &[],
    parts: &[
        Part { name: "trajectory", file: TABLE, only_if_wanted: false, about: "forces or angles over time" },
        Part { name: PICTURES, file: "", only_if_wanted: true, about: "its path and over time (Fig. 90 to 93)" },
    ],
    revision: 1,
    keys: KEYS,
    prepare,
};

const KEYS: &[&str] = &[
    "kind",
    "seconds",
    "every",
    "lead",
    "trail",
    "tau",
    "fz_max",
    "mu",
    "soft_start",
    "error",
    "fs",
    "fc",
    "hz",
    "random",
    "seed",
];

/// Which of the command's kinds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Word {
    Force,
    Posture,
    Random,
}

impl Words for Word {
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(Self::Force, "force", ""), (Self::Posture, "posture", ""), (Self::Random, "random", "")];
}

impl Word {
    /// Keys that only some kinds have.
    fn takes(self, key: &str) -> bool {
        match key {
            "fs" | "fc" => self == Self::Force,
            "hz" | "seed" => self != Self::Force,
            "fz_max" | "mu" | "error" => self != Self::Posture,
            "random" => self == Self::Posture,
            _ => true,
        }
    }
}

/// A stage's keys: `kind` is the command's, the others are its options.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
struct Asked {
    #[serde(with = "crate::words::optional")]
    kind: Option<Word>,
    seconds: Option<f64>,
    every: Option<f64>,
    lead: Option<f64>,
    trail: Option<f64>,
    tau: Option<f64>,
    fz_max: Option<f64>,
    mu: Option<f64>,
    soft_start: Option<f64>,
    error: Option<f64>,
    fs: Option<f64>,
    fc: Option<f64>,
    hz: Option<f64>,
    random: bool,
    seed: Option<u64>,
}

fn prepare(table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    let given: Vec<String> = table.keys().cloned().collect();
    let asked: Asked = read(KEYS, table)?;
    let word = asked.kind.ok_or_else(|| fault("kind", "is needed: force, posture or random"))?;
    if let Some(key) = given.iter().find(|key| !word.takes(key)) {
        return Err(fault(key, format!("is no option of a {} trajectory", word.word())));
    }
    if let Some(key) = ["seed", "soft_start"]
        .into_iter()
        .find(|key| word == Word::Posture && !asked.random && given.iter().any(|own| own == key))
    {
        return Err(fault(key, "is only of random bending: `random = true`"));
    }
    let options = asked.options(word);
    plan(&options, None).map_err(|why| fault("", why.to_string()))?;
    Ok(Arc::new(Planned { asked, options }))
}

impl Asked {
    fn options(&self, word: Word) -> TrajectoryOptions {
        let seed = self.seed.unwrap_or(1);
        let usual = match word {
            Word::Force => Way::FORCE,
            Word::Random => Way::RANDOM,
            Word::Posture => Way::POSTURE,
        };
        let kind = match usual {
            Way::Force { fs_per_n, fc_hz } => {
                Way::Force { fs_per_n: self.fs.unwrap_or(fs_per_n), fc_hz: self.fc.unwrap_or(fc_hz) }
            }
            Way::Random { hz, .. } => Way::Random { hz: self.hz.unwrap_or(hz), seed },
            Way::Posture { hz, .. } => Way::Posture { hz: self.hz.unwrap_or(hz), seed: self.random.then_some(seed) },
        };
        let of = TrajectoryOptions::of(kind);
        TrajectoryOptions {
            kind,
            seconds: self.seconds.unwrap_or(of.seconds),
            every_s: self.every.unwrap_or(of.every_s),
            lead_s: self.lead.unwrap_or(of.lead_s),
            trail_s: self.trail.unwrap_or(of.trail_s),
            soft_s: self.soft_start.unwrap_or(of.soft_s),
            fz_max_n: self.fz_max.unwrap_or(of.fz_max_n),
            mu: self.mu.unwrap_or(of.mu),
            tau_s: self.tau.unwrap_or(of.tau_s),
            error: self.error.map_or(of.error, |percent| 0.01 * percent),
        }
    }
}

struct Planned {
    asked: Asked,
    options: TrajectoryOptions,
}

fn outputs(folder: &Path, demand: &Demand) -> TrajectoryOutputs {
    TrajectoryOutputs { table: folder.join(TABLE), figures: demand.parts.contains(PICTURES) }
}

impl Prepared for Planned {
    fn demand(&self, _role: &str, _own: &Demand) -> Demand {
        Demand::default()
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        told(&self.asked, demand, &[PICTURES])
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(TrajectoryJob { options: self.options, demand: demand.clone() })
    }

    fn steps(&self, _inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        plan(&self.options, Some(&outputs(Path::new(""), demand))).map_err(|why| why.to_string())
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts { led: Some(false), forces: Some(self.options.is_force()), ..Facts::default() }
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (48_000_000, 0.1 + 2e-6 * self.options.rows() + 1e-3 * self.options.whole_s())
    }
}

struct TrajectoryJob {
    options: TrajectoryOptions,
    demand: Demand,
}

impl Job for TrajectoryJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let outputs = outputs(work.folder, &self.demand);
        let report = in_pool(work.threads, || run(&self.options, &outputs, work.stop))??;
        without_report(&outputs.table)?;
        Ok(Made {
            report: serde_json::to_value(&report)?,
            left_out: report.left_out,
            warnings: report.warnings,
            failed: report.failed,
            stages: report.stages,
            quality: Vec::new(),
        })
    }
}
