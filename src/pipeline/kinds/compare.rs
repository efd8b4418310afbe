//! `compare`: models and sets of recordings over several people (5.4, Fig. 105-113).
//!
//! Recordings of one person are those whose key `subject` is the same; each role has one recording of each person. Who
//! lacks one is left out and told.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::options::{counts, fault, read, told};
use super::pool::in_pool;
use super::recordings::{ambient_step, only_joints, reading};
use crate::log::LogReading;
use crate::phantom::log::Protocol;
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Work};
use crate::predictor::models::{Kind as ModelKind, Recipe};
use crate::predictor::{CompareOptions, FolderOutputs, HIDDEN, ModelChoice, Person, compare, compare_plan};
use crate::stages::Step;
use crate::words::Words;

const PICTURES: &str = "pictures";
const SUBJECT: &str = "subject";

/// The kind.
pub(super) static COMPARE: Kind = Kind {
    name: "compare",
    about: "models and sets of recordings over several people",
    roles: &[
        Role { name: "set1", takes: Takes::Many, about: "the touch protocol's first repetition, of each subject" },
        Role { name: "set2", takes: Takes::Many, about: "the second, which is trained on as well" },
        Role { name: "set3", takes: Takes::Many, about: "the third, which validates" },
        Role { name: "random", takes: Takes::Many, about: "random touching" },
        Role { name: "bending", takes: Takes::Many, about: "bending, with J2" },
        Role { name: "bending_random", takes: Takes::Many, about: "random bending, with J2" },
    ],
    parts: &[
        Part { name: "table", file: "comparisons.csv", only_if_wanted: false, about: "RMSE, mean and SD over people" },
        Part { name: PICTURES, file: "", only_if_wanted: true, about: "Fig. 105 to 113" },
    ],
    revision: 1,
    keys: KEYS,
    prepare,
};

const KEYS: &[&str] = &["models", "hidden", "bending_s", "seed", "restarts", "epochs"];

/// A stage's keys.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(default)]
struct Asked {
    models: Vec<String>,
    hidden: u16,
    /// For how long the touch protocol bends before it touches.
    bending_s: f64,
    seed: u64,
    restarts: u16,
    epochs: u32,
}

impl Default for Asked {
    fn default() -> Self {
        let usual = Recipe::new(ModelKind::Linear);
        Self {
            models: ModelChoice::WORDS.iter().map(|one| one.1.to_owned()).collect(),
            hidden: HIDDEN,
            bending_s: Protocol::Touch.seconds()[0],
            seed: usual.seed,
            restarts: usual.restarts as u16,
            epochs: usual.max_epochs as u32,
        }
    }
}

fn prepare(table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    let asked: Asked = read(KEYS, table)?;
    counts(&[
        ("hidden", asked.hidden.into(), 1000),
        ("restarts", asked.restarts.into(), 1000),
        ("epochs", asked.epochs, u32::MAX),
    ])?;
    let mut models = Vec::new();
    for word in &asked.models {
        let choice = ModelChoice::by_word(word).map_err(|why| fault("models", why))?;
        models.push(Recipe {
            seed: asked.seed,
            restarts: usize::from(asked.restarts),
            max_epochs: asked.epochs as usize,
            ..Recipe::new(choice.kind(asked.hidden))
        });
    }
    if models.is_empty() {
        return Err(fault("models", "name at least one model"));
    }
    if !(asked.bending_s >= 0.0 && asked.bending_s.is_finite()) {
        return Err(fault("bending_s", format!("{}: choose 0 s or more", asked.bending_s)));
    }
    let options = CompareOptions { models, bending_s: asked.bending_s };
    Ok(Arc::new(Comparing { asked, options }))
}

struct Comparing {
    asked: Asked,
    options: CompareOptions,
}

fn outputs(folder: &Path, demand: &Demand) -> FolderOutputs {
    let figures = demand.parts.contains(PICTURES);
    FolderOutputs { folder: folder.to_owned(), rows: true, figures, report: false }
}

impl Prepared for Comparing {
    fn demand(&self, role: &str, own: &Demand) -> Demand {
        let bends = role == "bending" || role == "bending_random";
        only_joints(bends.then(|| "J2".to_owned()).into_iter().collect(), own)
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        told(&self.asked, demand, &[PICTURES])
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(CompareJob { options: self.options.clone(), demand: demand.clone() })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let people: BTreeSet<_> = inputs.iter().filter_map(|input| input.keys.get(SUBJECT)).collect();
        let out = outputs(Path::new(""), demand);
        let mut steps = compare_plan(people.len(), &self.options, Some(&out));
        let roles: Vec<&str> = COMPARE.roles.iter().map(|role| role.name).collect();
        steps.insert(1, ambient_step(inputs, &roles, &LogReading::default()));
        Ok(steps)
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let (memory, read_s, rows) = reading(inputs);
        let networks = self.options.models.iter().any(|recipe| matches!(recipe.kind, ModelKind::Network { .. }));
        let starts = f64::from(self.asked.hidden) * f64::from(self.asked.restarts);
        let fit_s = if networks { super::train::NETWORK_S * rows * starts } else { 1e-5 * rows };
        (memory, read_s + 0.5 + fit_s)
    }
}

struct CompareJob {
    options: CompareOptions,
    demand: Demand,
}

/// One person's recordings; else what is wrong with them.
fn person(work: &Work, subject: &str) -> Result<Person, String> {
    let one = |role: &str| -> Result<PathBuf, String> {
        let mut own = work.of(role).filter(|at| at.keys.get(SUBJECT) == Some(subject));
        match (own.next(), own.next()) {
            (Some(at), None) => Ok(at.path.clone()),
            (Some(at), Some(other)) => {
                Err(format!("{role} is {} as well as {}: narrow it with `where`", at.name, other.name))
            }
            (None, _) => Err(format!("there is no {role}")),
        }
    };
    let found = || -> Result<Person, String> {
        Ok(Person {
            name: subject.to_owned(),
            touch: [one("set1")?, one("set2")?, one("set3")?],
            touch_random: one("random")?,
            bending: one("bending")?,
            bending_random: one("bending_random")?,
        })
    };
    found().map_err(|why| format!("subject {subject}: {why}"))
}

impl Job for CompareJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let subjects: BTreeSet<&str> = work.inputs.iter().filter_map(|at| at.keys.get(SUBJECT)).collect();
        let (mut people, mut failed) = (Vec::new(), Vec::new());
        for subject in subjects {
            match person(work, subject) {
                Ok(one) => people.push(one),
                Err(why) => failed.push(why),
            }
        }
        anyhow::ensure!(
            !people.is_empty() || !failed.is_empty(),
            "no recording has the key `{SUBJECT}`, by which people are told apart"
        );
        anyhow::ensure!(!people.is_empty(), "nobody has all six recordings: {}", failed.join("; "));
        let out = outputs(work.folder, &self.demand);
        let report = in_pool(work.threads, || compare(&people, &self.options, Some(&out), work.stop))??;
        Ok(Made {
            report: serde_json::to_value(&report)?,
            warnings: report.warnings,
            failed,
            stages: report.stages,
            ..Made::default()
        })
    }
}
