//! Jobs for tests of planning: they do nothing, and say what they would.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::job::{Demand, Facts, Foreseen, Keys, Kind, Made, Maker, OptionFault, Part, Prepared, Role, Takes, Work};
use crate::pipeline::items::catalogue::{Catalogue, CatalogueFile, CatalogueTask};
use crate::pipeline::plan::Plan;
use crate::pipeline::spec::{PipelineError, Spec};
use crate::stages::Step;

/// The kinds of toys.
pub(in crate::pipeline) static TOYS: &[&Kind] = &[&TRACK, &ALIGN, &TRAIN, &EVALUATE, &NORMALIZE];

static TRACK: Kind = Kind {
    name: "track",
    roles: &[role("video", Takes::One), role("markers", Takes::Optional), role("truth", Takes::Optional)],
    parts: &[Part::new("joints", "joints.csv"), Part::if_wanted("tracks", "tracks.csv")],
    revision: 1,
    keys: || vec!["joints".to_owned()],
    prepare: |options| Toy::prepare("track", options),
};

static ALIGN: Kind = Kind {
    name: "tie",
    roles: &[role("joints", Takes::One), role("log", Takes::One)],
    parts: &[Part::new("training", "training.csv"), Part::new("certificate", "training.sync.json")],
    revision: 1,
    keys: || vec!["sync".to_owned()],
    prepare: |options| Toy::prepare("tie", options),
};

static TRAIN: Kind = Kind {
    name: "train",
    roles: &[role("data", Takes::Many), role("validate", Takes::AnyNumber)],
    parts: &[Part::new("model", "model.json")],
    revision: 1,
    keys: || vec!["target".to_owned()],
    prepare: |options| Toy::prepare("train", options),
};

static EVALUATE: Kind = Kind {
    name: "evaluate",
    roles: &[role("model", Takes::One), role("data", Takes::Many)],
    parts: &[Part::new("table", "evaluated.csv")],
    revision: 1,
    keys: Vec::new,
    prepare: |options| Toy::prepare("evaluate", options),
};

static NORMALIZE: Kind = Kind {
    name: "normalize",
    roles: &[role("photo", Takes::One), role("annotation", Takes::Optional)],
    parts: &[Part::new("partial", "")],
    revision: 1,
    keys: Vec::new,
    prepare: |options| Toy::prepare("normalize", options),
};

const fn role(name: &'static str, takes: Takes) -> Role {
    Role { name, takes, about: "a toy's" }
}

struct Toy {
    job: &'static str,
    options: toml::Table,
}

impl Toy {
    fn prepare(job: &'static str, options: &toml::Table) -> Result<Arc<dyn Prepared>, OptionFault> {
        if let Some((key, _)) = options.iter().find(|(key, value)| *key != "joints" && !value.is_str()) {
            return Err(OptionFault { key: key.clone(), what: format!("`{key}` has to be text") });
        }
        Ok(Arc::new(Self { job, options: options.clone() }))
    }
}

impl Prepared for Toy {
    fn demand(&self, role: &str, own: &Demand) -> Demand {
        let offset = self.options.get("sync").and_then(toml::Value::as_str).is_some_and(|s| s.starts_with("offset"));
        match (self.job, role) {
            ("tie", "joints") => Demand { parts: BTreeSet::new(), joints: own.joints.clone(), clock: !offset },
            ("train", _) => Demand { joints: Some(["J2".to_owned()].into()), ..Demand::default() },
            _ => Demand { joints: Some(BTreeSet::new()), ..Demand::default() },
        }
    }

    fn depends_on(&self, demand: &Demand) -> serde_json::Value {
        serde_json::json!({
            "given": self.options,
            "joints": demand.joints,
            "clock": demand.clock,
            "parts": demand.parts,
        })
    }

    fn maker(self: Arc<Self>, _keys: &Keys, _demand: &Demand) -> Arc<dyn Maker> {
        nothing()
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let grey = inputs.first().and_then(|input| input.facts.grey) == Some(true);
        Ok(vec![
            Step::new("work", true, format!("{} input(s)", inputs.len())),
            Step::new("clock", demand.clock, if demand.clock { "wanted".into() } else { "nobody needs it".into() }),
            Step::new("channel", !grey, if grey { "it is grey".into() } else { "in colour".into() }),
        ])
    }

    fn facts(&self, inputs: &[Foreseen], _demand: &Demand) -> Facts {
        inputs.first().map(|input| input.facts).unwrap_or_default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        (1 << 20, inputs.len() as f64)
    }

    fn beside(&self, role: &str, path: &Path) -> Vec<(&'static str, PathBuf)> {
        if role == "photo" { vec![("annotation", path.with_extension("json"))] } else { Vec::new() }
    }

    fn each(&self) -> &'static [&'static str] {
        &[]
    }

    fn file(&self, part: &Part) -> &'static str {
        part.file
    }
}

fn nothing() -> Arc<dyn Maker> {
    Arc::new(|_: &Work<'_>| Ok(Made::default()))
}

pub(in crate::pipeline) fn folder_of(files: &[(&str, &str)]) -> tempfile::TempDir {
    let dir = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        let path = dir.path().join(name);
        std::fs::create_dir_all(path.parent().expect("within the folder")).expect("a folder");
        std::fs::write(path, text).expect("a file");
    }
    dir
}

/// A folder with files, in which a pipeline is planned.
pub(in crate::pipeline) struct Bench(pub(in crate::pipeline) tempfile::TempDir);

impl Bench {
    pub(in crate::pipeline) fn new(files: &[(&str, &str)]) -> Self {
        Self(folder_of(files))
    }

    pub(in crate::pipeline) fn try_plan(&self, text: &str) -> Result<Plan, PipelineError> {
        let path = self.0.path().join("pipeline.toml");
        let spec = Spec::parse(text, &path, TOYS)?;
        let generated = spec.catalogue(catalogue)?;
        Plan::new(&spec, &self.0.path().join("out"), generated.as_ref())
    }

    pub(in crate::pipeline) fn plan(&self, text: &str) -> Plan {
        self.try_plan(text).unwrap_or_else(|why| panic!("{why}"))
    }

    /// The faults of a pipeline, as `line:column: what`.
    #[track_caller]
    pub(in crate::pipeline) fn faults(&self, text: &str) -> Vec<String> {
        match self.try_plan(text) {
            Err(PipelineError::Faults { faults, .. }) => {
                faults.iter().map(|f| format!("{}:{}: {}", f.line, f.column, f.what)).collect()
            }
            Err(other) => panic!("{other}"),
            Ok(_) => panic!("the pipeline is planned without fault"),
        }
    }
}

/// Two people's videos and logs, and a table of them.
fn catalogue(options: &toml::Table) -> Result<Catalogue, OptionFault> {
    if let Some(key) = options.keys().find(|key| *key != "study") {
        return Err(OptionFault { key: key.clone(), what: format!("no phantom `{key}`; there is `study`") });
    }
    let mut tasks = Vec::new();
    let mut files = Vec::new();
    let mut table = String::from("subject,kind,video,log\n");
    let mut task = |name: &str, subject: Option<&str>, made: &[&str]| {
        let keys = Keys(subject.map(|subject| ("subject".to_owned(), subject.to_owned())).into_iter().collect());
        let facts = Facts { grey: Some(true), ..Facts::default() };
        files.extend(made.iter().map(|file| CatalogueFile {
            path: format!("{name}/{file}"),
            task: tasks.len(),
            facts,
        }));
        let options = serde_json::json!({ "phantom": name });
        tasks.push(CatalogueTask { name: name.to_owned(), keys, options, memory: 1, cost_s: 1.0, job: nothing() });
    };
    for subject in ["S01", "S02"] {
        task(&format!("recordings/{subject}"), Some(subject), &["bending.mp4", "bending.csv"]);
        table +=
            &format!("{subject},bending,../recordings/{subject}/bending.mp4,../recordings/{subject}/bending.csv\n");
    }
    task("markers", None, &["markers.toml"]);
    task("tables", None, &["sessions.csv"]);
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(Catalogue { tasks, files, tables: [("tables/sessions.csv".to_owned(), table)].into() })
}
