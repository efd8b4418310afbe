//! `align`: joint angles and a log of photodiodes and forces to a labelled training set with its certificate (3.1.2c,
//! 5.2).
//!
//! The set's columns `subject` and `session` are the recording's keys of these names, unless the stage names others.

use std::path::Path;
use std::sync::Arc;

use serde_json::json;

use super::format::{FORMAT, format, named};
use super::given::Given;
use super::options::request;
use super::pool::in_pool;
use super::truth::against;
use crate::align::{
    AlignInputs, AlignOptions, AlignOutputs, AlignReport, AlignRequest, Foreknown, LogHeader, Sync, plan_foreknown, run,
};
use crate::files::beside;
use crate::pipeline::{
    Demand, Facts, Foreseen, Job, KeyFault, Keys, Kind, Made, Part, Prepared, Quality, Role, Takes, Work,
};
use crate::stages::Step;
use crate::table::{TableFormat, column_names};

/// The kind.
pub(super) static ALIGN: Kind = Kind {
    name: "align",
    about: "joint angles and a log, on two clocks, to a labelled training set with a certificate",
    roles: &[
        Role { name: "joints", takes: Takes::One, about: "the table of angles of `posture`" },
        Role { name: "log", takes: Takes::One, about: "the log of photodiodes, and forces where it has them" },
        Role { name: TRACKS, takes: Takes::Optional, about: "the table of markers of `posture`, for the part `dlc`" },
        Role { name: "truth", takes: Takes::Optional, about: "the true angles of the log's rows: log_s, <joint>_deg" },
    ],
    parts: &[
        Part { name: "training", file: "training.csv", only_if_wanted: false, about: "the labelled set" },
        Part {
            name: "certificate",
            file: "training.sync.json",
            only_if_wanted: false,
            about: "how the clocks were tied, how well, and what was left unlabelled",
        },
        Part { name: MOT, file: "angles.mot", only_if_wanted: true, about: "the angles as an OpenSim motion file" },
        Part { name: BIDS, file: "bids", only_if_wanted: true, about: "the angles as a BIDS Motion dataset" },
        Part { name: DLC, file: "markers.csv", only_if_wanted: true, about: "the markers as a DeepLabCut table" },
        Part {
            name: PICTURES,
            file: "training-labels.png",
            only_if_wanted: true,
            about: "pictures of the labels over the photodiodes and of the tie",
        },
    ],
    revision: 1,
    keys: KEYS,
    prepare: |keys| Ok(Arc::new(Align::prepare(keys)?)),
};

const TRACKS: &str = "tracks";
const MOT: &str = "mot";
const BIDS: &str = "bids";
const DLC: &str = "dlc";
const PICTURES: &str = "pictures";
const KEYS: &[&str] = &[
    "sync",
    "clock_zero",
    "lag_about",
    "max_lag",
    "sensor_lag",
    "max_gap",
    "columns",
    "time_unit",
    "full_scale",
    "piece",
    "stream",
    "subject",
    "session",
    "task",
    FORMAT,
];

#[derive(Debug, Clone)]
struct Align {
    options: AlignOptions,
    format: TableFormat,
    /// As they stand in the file, for whoever asks whether they have changed.
    said: toml::Table,
}

impl Align {
    fn prepare(mut keys: toml::Table) -> Result<Self, KeyFault> {
        let said = keys.clone();
        let own = keys.remove(FORMAT).map(|value| (FORMAT.to_owned(), value));
        let format = format(&mut Given::new(own.into_iter().collect(), &[FORMAT])?)?;
        let options = request::<AlignRequest>(&keys)?.options();
        Ok(Self { options, format, said })
    }

    fn needs_clock(&self) -> bool {
        matches!(self.options.sync, None | Some(Sync::Clock))
    }

    fn options_for(&self, keys: &Keys) -> AlignOptions {
        let mut options = self.options.clone();
        let or_key = |said: &mut Option<String>, name: &str| {
            *said = said.take().or_else(|| keys.get(name).map(str::to_owned));
        };
        or_key(&mut options.subject, "subject");
        or_key(&mut options.session, "session");
        options
    }

    fn outputs(&self, demand: &Demand, folder: &Path) -> AlignOutputs {
        let place = |part: &str, name: &str| demand.parts.contains(part).then(|| folder.join(name));
        AlignOutputs {
            training: folder.join(named(self.format, "training.csv", "training.parquet")),
            mot: place(MOT, "angles.mot"),
            bids: place(BIDS, "bids"),
            dlc: place(DLC, "markers.csv"),
            figures: demand.parts.contains(PICTURES),
        }
    }
}

fn input<'a>(inputs: &'a [Foreseen], role: &str) -> Option<&'a Foreseen> {
    inputs.iter().find(|input| input.role == role)
}

impl Prepared for Align {
    fn demand(&self, role: &str, own: &Demand) -> Demand {
        match role {
            "joints" => Demand {
                parts: ["joints"].into(),
                // The lag is found by all angles together: which others are asked for must not change it.
                joints: own.joints.clone().filter(|_| self.options.sync != Some(Sync::Correlate)),
                clock: self.needs_clock(),
            },
            TRACKS if own.parts.contains(DLC) => Demand { parts: [TRACKS].into(), ..Demand::default() },
            _ => Demand::default(),
        }
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        let made: Vec<&str> =
            [MOT, BIDS, DLC, PICTURES].into_iter().filter(|part| demand.parts.contains(part)).collect();
        json!({ "options": self.said, "made": made })
    }

    fn job(&self, keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(AlignJob { stage: self.clone(), keys: keys.clone(), demand: demand.clone() })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let (joints, log) = (input(inputs, "joints"), input(inputs, "log"));
        let header = log.filter(|log| log.stands).map(|log| LogHeader::read(&log.path, &self.options.columns));
        let header = header.transpose().map_err(|why| why.to_string())?;
        let names = joints.filter(|joints| joints.stands).map(|joints| column_names(&joints.path));
        let names = names.transpose().map_err(|why| why.to_string())?;
        let of_names = |names: &Vec<String>| {
            let joint = |name: &String| name.strip_suffix("_deg").filter(|j| !j.ends_with("_sd")).map(str::to_owned);
            names.iter().filter_map(joint).collect::<Vec<_>>()
        };
        let demanded = || Some(demand.joints.as_ref()?.iter().cloned().collect());
        let known = Foreknown {
            joints: names.as_ref().map(of_names).or_else(demanded),
            // Of angles that stand, a column with what the clock was read to show says that there is one.
            clock: match &names {
                Some(names) => Some(names.iter().any(|name| name == "clock_read_s")),
                None => joints.and_then(|joints| joints.facts.clock),
            },
            led: header.map(|header| header.led).or_else(|| log.and_then(|log| log.facts.led)),
            photodiodes: header.map(|header| header.photodiodes),
            ..Foreknown::default()
        };
        Ok(plan_foreknown(&known, &self.options, Some(&self.outputs(demand, Path::new("")))))
    }

    fn facts(&self, inputs: &[Foreseen], _demand: &Demand) -> Facts {
        let log = input(inputs, "log");
        let header =
            log.filter(|log| log.stands).and_then(|log| LogHeader::read(&log.path, &self.options.columns).ok());
        let forces = header.map(|header| header.forces > 0).or_else(|| log.and_then(|log| log.facts.forces));
        // What is unlit is taken away already.
        Facts { led: Some(false), forces, ..Facts::default() }
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let size = |input: &Foreseen| std::fs::metadata(&input.path).map_or(1 << 20, |about| about.len());
        let bytes: u64 = inputs.iter().filter(|input| input.role != "truth").map(size).sum();
        (BYTES_AT_LEAST + BYTES_A_BYTE * bytes, S_AT_LEAST + S_A_BYTE * bytes as f64)
    }

    fn file(&self, part: &Part) -> &'static str {
        if part.name == "training" { named(self.format, part.file, "training.parquet") } else { part.file }
    }
}

/// Memory and time by the size of the tables, measured on one core of 2.5 GHz.
const BYTES_AT_LEAST: u64 = 32 << 20;
const BYTES_A_BYTE: u64 = 6;
const S_AT_LEAST: f64 = 0.02;
const S_A_BYTE: f64 = 3e-8;

struct AlignJob {
    stage: Align,
    keys: Keys,
    demand: Demand,
}

impl Job for AlignJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let given = |role: &str| work.one(role).ok_or_else(|| anyhow::anyhow!("no {role} is given"));
        let inputs = AlignInputs {
            joints: given("joints")?.path.clone(),
            log: given("log")?.path.clone(),
            tracks: work.one(TRACKS).map(|at| at.path.clone()),
        };
        if self.demand.parts.contains(DLC) && inputs.tracks.is_none() {
            anyhow::bail!(
                "the part `{DLC}` is made of markers: give the stage `tracks`, as in tracks = \"angles.tracks\""
            );
        }
        let outputs = self.stage.outputs(&self.demand, work.folder);
        let options = self.stage.options_for(&self.keys);
        let report = in_pool(work.threads, || run(&inputs, &options, &outputs, work.stop))??;
        std::fs::remove_file(beside(&outputs.training, ".run.json"))?;
        let mut quality = match work.one("truth") {
            Some(truth) => against(&truth.path, "log_s", &outputs.training, "time_s", SAME_TIME_S)?,
            None => Vec::new(),
        };
        quality.extend(stated(&report));
        Ok(Made {
            left_out: report.left_out.clone(),
            warnings: report.warnings.clone(),
            failed: report.failed.clone(),
            stages: report.stages.clone(),
            quality,
            report: serde_json::to_value(report)?,
        })
    }
}

/// A row's stamp and its true time are no further apart.
const SAME_TIME_S: f64 = 0.002;

/// The standard errors that labels and tie come with.
fn stated(report: &AlignReport) -> Vec<Quality> {
    let quality = |what: &str, value: Option<f64>, unit: &str| {
        let (what, unit) = (what.to_owned(), unit.to_owned());
        Some(Quality { what, value: value?, unit, against_truth: false })
    };
    let labels = report
        .labels
        .iter()
        .map(|label| quality(&label.joint, label.sd_deg, "degrees, standard error of the label, RMS over rows"));
    let offset = quality("offset", report.certificate.offset_sd_s, "s, standard error");
    labels.chain([offset]).flatten().collect()
}
