//! `maps`: the sums of all subjects to mean, standard deviation and count by pose (4.2.2, Fig. 53-56).
//!
//! Where this task's earlier maps stand and all that they hold is still there, only new sums are read and added: the
//! bytes are the same, as sums are integers.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::json;

use super::given::Given;
use super::pool::in_pool;
use crate::files::Staging;
use crate::npy;
use crate::photo::{Maps, Partials, gather};
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
            Step::new("sums joined", true, "those that stand are added to".into()),
            Step::new("mean", true, "by pose".into()),
            Step::new(
                "standard deviation",
                several,
                if several { "over subjects, by pose".into() } else { "it needs two subjects in a pose".into() },
            ),
            Step::new("figures", figures, if figures { "by pose, and sheets".into() } else { "not asked for".into() }),
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
        let staging = Staging::new(work.folder)?;
        let gathered = in_pool(work.threads, || gather(&parts, work.before, self.figures, &staging, work.stop))??;
        staging.commit()?;
        let truth = work.one("truth").map(|at| at.path.as_path());
        let quality = quality(&gathered.partials, truth)?;
        let report = json!({
            "job": "maps",
            "poses": gathered.poses,
            "sums_added": gathered.added,
            "sums_stood": gathered.stood,
            "normalization": gathered.partials.normalization,
        });
        let stood = gathered.stood;
        Ok(Made {
            report,
            left_out: (stood > 0)
                .then(|| format!("sums: {stood} stand in the maps before, and are not read again"))
                .into_iter()
                .collect(),
            warnings: gathered.warnings,
            failed: Vec::new(),
            stages: gathered.stages,
            quality,
        })
    }
}

/// Root mean squares, added up.
#[derive(Default)]
struct Rms {
    squares: f64,
    count: usize,
}

impl Rms {
    fn add(&mut self, difference: f64) {
        if difference.is_finite() {
            self.squares += difference * difference;
            self.count += 1;
        }
    }

    fn quality(&self, what: &str, unit: &str, against_truth: bool) -> Option<Quality> {
        let value = (self.squares / self.count as f64).sqrt() * LEVELS;
        let unit = unit.to_owned();
        (self.count > 0).then(|| Quality { what: what.to_owned(), value, unit, against_truth })
    }
}

/// Levels in which errors of maps are told.
const LEVELS: f64 = 255.0;

/// How far the maps are from the true ones; where these are not known, how far the mean can be by the subjects' spread.
fn quality(partials: &Partials, truth: Option<&Path>) -> anyhow::Result<Vec<Quality>> {
    let (mut mean, mut sd, mut spread) = (Rms::default(), Rms::default(), Rms::default());
    for (pose, sums) in &partials.poses {
        let maps: Maps = sums.maps();
        if let Some(folder) = truth {
            let pairs = [(&maps.mean, "mean", &mut mean), (&maps.sd, "sd", &mut sd)];
            for (map, name, rms) in pairs {
                let file = folder.join(format!("{pose}-{name}.npy"));
                if !file.exists() {
                    continue;
                }
                let exact = npy::read::<f32>(&file).map_err(|why| wrong(&file, &why))?;
                if exact.dim() != map.dim() {
                    anyhow::bail!("{}: is of another size than the maps; make both with one `size`", file.display());
                }
                map.iter().zip(&exact).for_each(|(map, exact)| rms.add(f64::from(*map) - f64::from(*exact)));
            }
        }
        let cells = maps.sd.iter().zip(&maps.count);
        cells.for_each(|(sd, count)| spread.add(f64::from(*sd) / f64::from(*count).sqrt()));
    }
    let unit = "of 255, RMS over pixels";
    let stated = "of 255, standard error over subjects, RMS over pixels";
    let all = [
        mean.quality("mean map", unit, true),
        sd.quality("SD map", unit, true),
        spread.quality("mean map", stated, false),
    ];
    Ok(all.into_iter().flatten().collect())
}

fn wrong(file: &Path, why: &dyn std::fmt::Display) -> anyhow::Error {
    anyhow::anyhow!(
        "{}: cannot be read as a map ({why}); name a folder with <pose>-mean.npy and <pose>-sd.npy",
        file.display()
    )
}
