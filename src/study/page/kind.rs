//! `study`: the page with a counterpart of every data figure of the thesis and every statement of its text beside what
//! came out.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::options::{read, told};
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Work};
use crate::stages::Step;
use crate::study::{PageOptions, Part as StudyPart, PartFolder, study_page};

const fn role(name: &'static str, about: &'static str) -> Role {
    Role { name, takes: Takes::AnyNumber, about }
}

/// The kind; its roles are named as the study's parts.
pub(super) static STUDY: Kind = Kind {
    name: "study",
    about: "every data figure of the thesis, and what its text states beside what came out",
    roles: &[
        role("normal", "responses to normal force"),
        role("lateral", "responses to lateral shear"),
        role("longitudinal", "responses to longitudinal shear"),
        role("bending", "responses to bending"),
        role("typical", "one subject's coloration"),
        role("photos", "maps of photographs"),
        role("section", "the simulations of section 4.3"),
        role("presses", "its experiments"),
        role("touch_training", "the touch model evaluated on what it was trained on"),
        role("touch_validation", "on the third repetition"),
        role("touch_test", "on random touching"),
        role("modes", "the touch model analysed"),
        role("posture_training", "the posture model evaluated on what it was trained on"),
        role("posture_validation", "on new data"),
        role("compare", "models compared over subjects"),
    ],
    parts: &[
        Part { name: "page", file: "study.html", only_if_wanted: false, about: "the page" },
        Part { name: "statements", file: "statements.csv", only_if_wanted: false, about: "every statement, judged" },
        Part { name: "numbers", file: "numbers.json", only_if_wanted: false, about: "what they are judged by" },
    ],
    revision: 1,
    keys: KEYS,
    prepare,
};

const KEYS: &[&str] = &["title", "phantom", "subject"];

/// A stage's keys.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(default)]
struct Asked {
    title: String,
    /// The recordings are generated.
    phantom: bool,
    /// Whose results are shown; empty: the first one's.
    subject: String,
}

impl Default for Asked {
    fn default() -> Self {
        let title = "The thesis' figures, and what it states of them".to_owned();
        Self { title, phantom: false, subject: String::new() }
    }
}

fn prepare(table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    Ok(Arc::new(Page(read(KEYS, table)?)))
}

struct Page(Asked);

impl Prepared for Page {
    fn demand(&self, role: &str, _own: &Demand) -> Demand {
        // What the page shows of each, where that is made only if wanted.
        let parts: &[&'static str] = match role {
            "photos" => &["maps", "figures"],
            "touch_training" | "touch_validation" | "touch_test" | "posture_training" | "posture_validation" => {
                &["predicted", "pictures"]
            }
            "modes" | "compare" => &["pictures"],
            _ => &[],
        };
        Demand { parts: parts.iter().copied().collect(), ..Demand::default() }
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        told(&self.0, demand, &[])
    }

    fn job(&self, _keys: &Keys, _demand: &Demand) -> Arc<dyn Job> {
        Arc::new(StudyJob(self.0.clone()))
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let one = |part: &StudyPart| {
            let count = inputs.iter().filter(|input| input.role == part.name()).count();
            let reason = if count == 0 { "no results are named".to_owned() } else { format!("{count} folders") };
            Step::new(part.name(), count > 0, reason)
        };
        Ok(StudyPart::ALL.iter().map(one).collect())
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (128_000_000, 0.5)
    }
}

struct StudyJob(Asked);

impl Job for StudyJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let of = |part: StudyPart| {
            work.of(part.name()).map(move |at| PartFolder {
                part,
                folder: at.path.clone(),
                subject: at.keys.get("subject").unwrap_or_default().to_owned(),
            })
        };
        let folders: Vec<PartFolder> = StudyPart::ALL.into_iter().flat_map(of).collect();
        let Asked { title, phantom, subject } = self.0.clone();
        let report = study_page(&folders, &PageOptions { title, phantom, subject }, work.folder)?;
        Ok(Made {
            report: serde_json::to_value(&report)?,
            left_out: report.figures_lacking,
            warnings: report.warnings,
            ..Made::default()
        })
    }
}
