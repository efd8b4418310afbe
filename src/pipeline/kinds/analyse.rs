//! `analyse`: singular values and modes of a model (Fig. 98).

use std::path::Path;
use std::sync::Arc;

use anyhow::Context;

use super::options::{read, told};
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Work};
use crate::predictor::{FolderOutputs, analyse, analyse_plan};
use crate::stages::Step;

const PICTURES: &str = "pictures";

/// The kind.
pub(super) static ANALYSE: Kind = Kind {
    name: "analyse",
    about: "singular values and modes of a model",
    roles: &[Role { name: "model", takes: Takes::One, about: "a model of train" }],
    parts: &[
        Part { name: "modes", file: "modes.csv", only_if_wanted: false, about: "the modes, a row each" },
        Part { name: PICTURES, file: "", only_if_wanted: true, about: "the modes as bars" },
    ],
    revision: 1,
    keys: &[],
    prepare,
};

#[derive(serde::Serialize, serde::Deserialize)]
struct Asked {}

fn prepare(table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    read::<Asked>(&[], table)?;
    Ok(Arc::new(Analysis))
}

struct Analysis;

fn outputs(folder: &Path, demand: &Demand) -> FolderOutputs {
    let figures = demand.parts.contains(PICTURES);
    FolderOutputs { folder: folder.to_owned(), rows: true, figures, report: false }
}

impl Prepared for Analysis {
    fn demand(&self, _role: &str, _own: &Demand) -> Demand {
        Demand::default()
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        told(&Asked {}, demand, &[PICTURES])
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(AnalyseJob(demand.clone()))
    }

    fn steps(&self, _inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(analyse_plan(Some(&outputs(Path::new(""), demand))))
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (32_000_000, 0.1)
    }
}

struct AnalyseJob(Demand);

impl Job for AnalyseJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let model = work.one("model").context("there is no model to analyse")?;
        let report = analyse(&model.path, Some(&outputs(work.folder, &self.0)), work.stop)?;
        Ok(Made {
            report: serde_json::to_value(&report)?,
            warnings: report.warnings,
            stages: report.stages,
            ..Made::default()
        })
    }
}
