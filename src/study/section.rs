//! `section`: the simulations of section 4.3 with the thesis' values (Fig. 76 to 78), and `presses`: its experiments on
//! recorded people (Fig. 79 to 82).

use std::sync::Arc;

use serde_json::json;

use super::options::{read, told};
use super::pool::in_pool;
use crate::files::write_whole;
use crate::hemodynamics::{SectionText, section_presses, section_simulations};
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Work};
use crate::stages::Step;
use crate::study::{Numbers, PressFile, read_presses};

/// The kind.
pub(super) static SECTION: Kind = Kind {
    name: "section",
    about: "the thesis' simulations of the blood under the nail, steps and steady states",
    roles: &[],
    parts: &[Part {
        name: "section",
        file: "",
        only_if_wanted: false,
        about: "Fig. 76 to 78, section.md, numbers.json",
    }],
    revision: 1,
    keys: &[],
    prepare: |table| prepared(table, false),
};

/// The kind.
pub(super) static PRESSES: Kind = Kind {
    name: "presses",
    about: "slow and quick presses of people, and the model fitted to them",
    roles: &[Role {
        name: "data",
        takes: Takes::Many,
        about: "presses as `lunula fit` reads them; slow ones have no time_s",
    }],
    parts: &[Part {
        name: "presses",
        file: "",
        only_if_wanted: false,
        about: "Fig. 79 to 82, presses.md, numbers.json",
    }],
    revision: 1,
    keys: &[],
    prepare: |table| prepared(table, true),
};

#[derive(serde::Serialize, serde::Deserialize)]
struct Asked {}

fn prepared(table: toml::Table, presses: bool) -> Result<Arc<dyn Prepared>, KeyFault> {
    read::<Asked>(&[], table)?;
    Ok(Arc::new(Told { presses }))
}

#[derive(Clone, Copy)]
struct Told {
    presses: bool,
}

impl Prepared for Told {
    fn demand(&self, _role: &str, _own: &Demand) -> Demand {
        Demand::default()
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        told(&Asked {}, demand, &[])
    }

    fn job(&self, _keys: &Keys, _demand: &Demand) -> Arc<dyn Job> {
        Arc::new(*self)
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(if self.presses {
            vec![
                Step::new("static curves", true, format!("of those of {} files without time_s", inputs.len())),
                Step::new("fit", true, "stiffness and damping to all quick presses".to_owned()),
            ]
        } else {
            vec![
                Step::new("tune", true, "stiffness and damping to the measured time constants".to_owned()),
                Step::new("steps", true, "of ten loads, two sets of values, two places".to_owned()),
                Step::new("steady states", true, "along the load".to_owned()),
            ]
        })
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        (64_000_000, if self.presses { 0.5 * inputs.len() as f64 } else { 12.0 })
    }
}

impl Job for Told {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let told: SectionText = in_pool(work.threads, || {
            if !self.presses {
                return section_simulations(work.folder);
            }
            let files: Vec<PressFile<'_>> = work
                .of("data")
                .map(|at| PressFile { path: &at.path, name: &at.name, subject: at.keys.get("subject").unwrap_or("") })
                .collect();
            section_presses(&read_presses(&files)?, work.folder)
        })??;
        let numbers = Numbers(told.numbers);
        let name = if self.presses { "presses" } else { "section" };
        write_whole(&work.folder.join(format!("{name}.md")), told.text.as_bytes())?;
        write_whole(&work.folder.join("numbers.json"), numbers.to_text().as_bytes())?;
        Ok(Made { report: json!({ "job": name, "numbers": numbers }), ..Made::default() })
    }
}
