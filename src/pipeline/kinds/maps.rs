//! `maps`: the sums of all subjects to mean, standard deviation and count by pose (4.2.2, Fig. 53-56).
//!
//! Where this task's earlier maps are up to date with all that they hold, only new sums are read and added: the bytes
//! are the same, as sums are integers.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::json;

use super::given::Given;
use super::pool::in_pool;
use crate::photo::{Accuracy, Gathering, Watch, gather};
use crate::pipeline::{
    Demand, Facts, Foreseen, Job, KeyFault, Keys, Kind, Made, Part, Prepared, Quality, Role, Takes, Work,
};
use crate::stages::Step;

/// The kind.
pub(super) static MAPS: Kind = Kind {
    name: "maps",
    about: "the sums of all subjects to average coloration and its standard deviation",
    roles: &[
        Role { name: "sums", takes: Takes::Many, about: "what `normalize` made" },
        Role {
            name: "truth",
            takes: Takes::Optional,
            about: "a folder of exact maps, <pose>-mean.npy and <pose>-sd.npy",
        },
    ],
    parts: &[
        Part { name: "maps", file: "", only_if_wanted: false, about: "maps/<pose>-{mean,sd,count}.npy and nails.csv" },
        Part { name: "nails", file: "nails.csv", only_if_wanted: false, about: "every nail, used or not" },
        Part {
            name: FIGURES,
            file: "figures",
            only_if_wanted: true,
            about: "pictures: mean, contrast, threshold and sd of every pose, and sheets of all",
        },
    ],
    revision: 1,
    keys: &[],
    prepare: |keys| Ok(Arc::new(MapsOf::prepare(keys)?)),
};

const FIGURES: &str = "figures";

struct MapsOf;

impl MapsOf {
    fn prepare(keys: toml::Table) -> Result<Self, KeyFault> {
        Given::new(keys, &[]).map(|_| Self)
    }
}

impl Prepared for MapsOf {
    fn demand(&self, role: &str, _own: &Demand) -> Demand {
        let parts = if role == "sums" { ["sums"].into() } else { [].into() };
        Demand { parts, ..Demand::default() }
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        json!({ "figures": demand.parts.contains(FIGURES) })
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(MapsJob { figures: demand.parts.contains(FIGURES) })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let several = inputs.iter().filter(|input| input.role == "sums").count() > 1;
        let figures = demand.parts.contains(FIGURES);
        Ok(vec![
            Step::new("sums joined", true, "new ones are added to those of the maps made before".into()),
            Step::new("mean", true, "by pose".into()),
            Step::new(
                "standard deviation",
                several,
                if several { "over subjects, by pose".into() } else { "it needs two subjects in a pose".into() },
            ),
            Step::new("figures", figures, if figures { "by pose, and sheets".into() } else { "not requested".into() }),
        ])
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        (256 << 20, 0.5 + 0.005 * inputs.len() as f64)
    }
}

struct MapsJob {
    figures: bool,
}

impl Job for MapsJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let parts: Vec<PathBuf> = work.of("sums").map(|at| at.path.clone()).collect();
        let truth = work.one("truth").map(|at| at.path.as_path());
        let gathering =
            Gathering { parts: &parts, before: work.before, truth, figures: self.figures, out: work.folder };
        let watch = Watch { stop: work.stop, tick: &|| {} };
        let report = in_pool(work.threads, || gather(&gathering, &watch))??;
        Ok(Made {
            left_out: report.left_out.clone(),
            warnings: report.notes.clone(),
            failed: Vec::new(),
            stages: report.stages.clone(),
            quality: quality(&report.accuracy),
            report: serde_json::to_value(report)?,
        })
    }
}

/// How far the maps are from the true ones, and how far the mean can be by the subjects' spread.
fn quality(of: &Accuracy) -> Vec<Quality> {
    let unit = "of 255, RMS over pixels";
    let spread = "of 255, standard error over subjects, RMS over pixels";
    let all = [
        ("mean map", of.mean_of_255, unit, true),
        ("SD map", of.sd_of_255, unit, true),
        ("mean map", of.standard_error_of_255, spread, false),
    ];
    let known = all.into_iter().filter_map(|(what, value, unit, against_truth)| {
        Some(Quality { what: what.to_owned(), value: value?, unit: unit.to_owned(), against_truth })
    });
    known.collect()
}
