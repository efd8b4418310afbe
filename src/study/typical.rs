//! `typical`: one subject's normalized pictures in all poses, as they are and with contrast (Fig. 51 and 52).

use std::sync::Arc;

use anyhow::Context;
use serde_json::json;

use super::options::{read, told};
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Work};
use crate::stages::Step;
use crate::study::coloration_sheets;

/// The kind.
pub(super) static TYPICAL: Kind = Kind {
    name: "typical",
    about: "one subject's normalized pictures in all poses, as they are and with contrast",
    roles: &[Role { name: "pictures", takes: Takes::One, about: "normalize's part `pictures` of a subject" }],
    parts: &[Part { name: "sheets", file: "", only_if_wanted: false, about: "typical.png, typical-contrast.png" }],
    revision: 1,
    keys: &[],
    prepare,
};

#[derive(serde::Serialize, serde::Deserialize)]
struct Asked {}

fn prepare(table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    read::<Asked>(&[], table)?;
    Ok(Arc::new(Sheets))
}

struct Sheets;

impl Prepared for Sheets {
    fn demand(&self, _role: &str, _own: &Demand) -> Demand {
        Demand::default()
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        told(&Asked {}, demand, &[])
    }

    fn job(&self, _keys: &Keys, _demand: &Demand) -> Arc<dyn Job> {
        Arc::new(SheetsJob)
    }

    fn steps(&self, _inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(vec![Step::new("sheets", true, "of all poses, as they are and with contrast".to_owned())])
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (96_000_000, 0.5)
    }
}

struct SheetsJob;

impl Job for SheetsJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let pictures = work.one("pictures").context("there are no pictures")?;
        let subject = coloration_sheets(&pictures.path, None, work.folder).context(pictures.name.clone())?;
        Ok(Made { report: json!({ "job": "typical", "subject": subject }), ..Made::default() })
    }
}
