//! `align` and `join` in a pipeline: joint angles and a log of photodiodes and forces to a labelled training set with
//! its certificate (3.1.2c, 5.2); the sets of a session that was filmed in several videos to one, in the order of time.
//!
//! The set's columns `subject` and `session` are the recording's keys of these names, unless the stage names others.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use crate::align::join::join;
use crate::align::options::{AlignInputs, AlignOptions, AlignOutputs, Sync};
use crate::align::posture::joints_of;
use crate::align::run::job::run;
use crate::align::run::plan::{Foreknown, steps};
use crate::align::run::report::AlignReport;
use crate::job::{
    Demand, Facts, Foreseen, Job, Keys, Kind, Made, Order, Part, Quality, Report, Role, Tables, Takes, Work, against,
};
use crate::log::LogHeader;
use crate::stages::{Stages, Step};
use crate::table::{TableFormat, column_names};

const TRACKS: &str = "tracks";
const MOT: &str = "mot";
const BIDS: &str = "bids";
const DLC: &str = "dlc";

/// A stage of a pipeline.
#[derive(Debug, Clone, Args)]
pub(crate) struct AlignJob {
    #[command(flatten)]
    options: AlignOptions,
    #[command(flatten)]
    tables: Tables,
}

impl AlignJob {
    fn needs_clock(&self) -> bool {
        matches!(self.options.sync, None | Some(Sync::Clock))
    }

    fn options_for(&self, keys: &Keys) -> AlignOptions {
        let own = &self.options;
        let or_key = |said: &Option<String>, name: &str| said.clone().or_else(|| keys.get(name).map(str::to_owned));
        let (subject, session) = (or_key(&own.subject, "subject"), or_key(&own.session, "session"));
        AlignOptions { subject, session, ..own.clone() }
    }

    fn outputs(&self, demand: &Demand, folder: &Path) -> AlignOutputs {
        let place = |part: &str, name: &str| demand.wants(part).then(|| folder.join(name));
        AlignOutputs {
            training: folder.join(self.tables.named("training.csv", "training.parquet")),
            mot: place(MOT, "angles.mot"),
            bids: place(BIDS, "bids"),
            dlc: place(DLC, "markers.csv"),
            figures: demand.draws(),
            report: false,
        }
    }

    fn header(&self, log: Option<&Foreseen>) -> Option<Result<LogHeader, String>> {
        let log = log.filter(|log| log.exists)?;
        Some(LogHeader::read(&log.path, &self.options.log.columns).map_err(|why| why.to_string()))
    }
}

impl Job for AlignJob {
    const KIND: Kind = Kind::of::<Self>(
        "align",
        &[
            Role::new("joints", Takes::One, "the table of angles of `posture`"),
            Role::new("log", Takes::One, "the log of photodiodes, and forces where it has them"),
            Role::new(TRACKS, Takes::Optional, "the table of markers of `posture`, for the part `dlc`"),
            Role::new("truth", Takes::Optional, "the true angles of the log's rows: log_s, <joint>_deg"),
        ],
        &[
            Part::new("training", "training.csv"),
            Part::new("certificate", "training.sync.json"),
            Part::if_wanted(MOT, "angles.mot"),
            Part::if_wanted(BIDS, "bids"),
            Part::if_wanted(DLC, "markers.csv"),
            Part::pictures("training-labels.png"),
        ],
    )
    .revision(12);

    fn demand(&self, role: &str, own: &Demand) -> Demand {
        match role {
            "joints" => Demand {
                parts: ["joints"].into(),
                // All angles together find the lag: which others are wanted must not change it.
                joints: own.joints.clone().filter(|_| self.options.sync != Some(Sync::Correlate)),
                clock: self.needs_clock(),
            },
            TRACKS if own.wants(DLC) => Demand { parts: [TRACKS].into(), ..Demand::default() },
            _ => Demand::default(),
        }
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let (joints, log) = (Foreseen::of(inputs, "joints"), Foreseen::of(inputs, "log"));
        let header = self.header(log).transpose()?;
        let names = joints.filter(|joints| joints.exists).map(|joints| column_names(&joints.path));
        let names = names.transpose().map_err(|why| why.to_string())?;
        let demanded = || Some(demand.joints.as_ref()?.iter().cloned().collect());
        let known = Foreknown {
            joints: names.as_deref().map(joints_of).or_else(demanded),
            // In a table of angles that exists, a column with what the clock was read to show says that there is one.
            clock: match &names {
                Some(names) => Some(names.iter().any(|name| name == "clock_read_s")),
                None => joints.and_then(|joints| joints.facts.clock),
            },
            led: header.map(|header| header.led).or_else(|| log.and_then(|log| log.facts.led)),
            photodiodes: header.map(|header| header.photodiodes),
            ..Foreknown::default()
        };
        Ok(steps(&known, &self.options, &self.outputs(demand, Path::new(""))))
    }

    fn facts(&self, inputs: &[Foreseen], _demand: &Demand) -> Facts {
        let log = Foreseen::of(inputs, "log");
        let header = self.header(log).and_then(Result::ok);
        let forces = header.map(|header| header.forces > 0).or_else(|| log.and_then(|log| log.facts.forces));
        // The unlit light is subtracted already.
        Facts { led: Some(false), forces, ..Facts::default() }
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let read = inputs.iter().filter(|input| input.role != "truth");
        let bytes: u64 = read.map(|input| input.bytes(1 << 20)).sum();
        (BYTES_AT_LEAST + BYTES_A_BYTE * bytes, S_AT_LEAST + S_A_BYTE * bytes as f64)
    }

    fn file(&self, part: &Part) -> &'static str {
        if part.name == "training" { self.tables.named(part.file, "training.parquet") } else { part.file }
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let inputs = AlignInputs {
            joints: work.needed("joints")?.path.clone(),
            log: work.needed("log")?.path.clone(),
            tracks: work.one(TRACKS).map(|at| at.path.clone()),
        };
        if order.demand.wants(DLC) && inputs.tracks.is_none() {
            anyhow::bail!(
                "the part `{DLC}` is made of markers: give the stage `tracks`, as in tracks = \"angles.tracks\""
            );
        }
        let outputs = self.outputs(order.demand, work.folder);
        let options = self.options_for(order.keys);
        let report = work.run(order.said, |watch| run(&inputs, &options, &outputs, watch))?;
        let mut quality = match work.one("truth") {
            Some(truth) => against(&truth.path, "log_s", &outputs.training, "time_s", SAME_TIME_S)?,
            None => Vec::new(),
        };
        quality.extend(stated(&report));
        Ok(report.made(quality))
    }
}

/// Memory and time by the size of the tables, measured on one core of 2.5 GHz.
const BYTES_AT_LEAST: u64 = 32 << 20;
const BYTES_A_BYTE: u64 = 6;
const S_AT_LEAST: f64 = 0.02;
const S_A_BYTE: f64 = 3e-8;
/// A row's stamp and its true time differ by no more.
const SAME_TIME_S: f64 = 0.002;

/// The standard errors that labels and tie come with.
fn stated(report: &AlignReport) -> Vec<Quality> {
    let of_label = "degrees, standard error of the label, RMS over rows";
    let labels = report.labels.iter().map(|label| Some(Quality::stated(&label.joint, label.sd_deg?, of_label)));
    let offset = report.certificate.offset_sd_s.map(|sd_s| Quality::stated("offset", sd_s, "s, standard error"));
    labels.chain([offset]).flatten().collect()
}

/// A stage that joins sets; one set alone is passed on as it is.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct JoinJob {
    #[command(flatten)]
    tables: Tables,
}

#[derive(Debug, Serialize)]
struct JoinFigures {
    sets: usize,
    rows: Option<usize>,
}

impl Job for JoinJob {
    const KIND: Kind = Kind::of::<Self>(
        "join",
        &[Role::new("sets", Takes::Many, "what `align` made")],
        &[Part::new("training", "training.csv")],
    );

    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        Demand { parts: ["training"].into(), joints: own.joints.clone(), clock: own.clock }
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let several = inputs.len() > 1;
        let why = if several { format!("{} sets", inputs.len()) } else { "one video: its set is passed on".to_owned() };
        Ok(vec![Step::new("sets joined", several, why)])
    }

    fn facts(&self, inputs: &[Foreseen], _demand: &Demand) -> Facts {
        inputs.first().map(|first| first.facts).unwrap_or_default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let bytes: u64 = inputs.iter().map(|input| input.bytes(1 << 20)).sum();
        ((32 << 20) + 8 * bytes, 0.01 + 3e-8 * bytes as f64)
    }

    fn file(&self, part: &Part) -> &'static str {
        self.tables.named(part.file, "training.parquet")
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let stages = Stages::default();
        let sets: Vec<PathBuf> = work.of("sets").map(|at| at.path.clone()).collect();
        let to = work.folder.join(self.tables.named("training.csv", "training.parquet"));
        let is_of_format = |set: &PathBuf| TableFormat::of(set).is_ok_and(|format| format == self.tables.format());
        let report = work.run(order.said, |watch| -> anyhow::Result<_> {
            let mut report = Report::new("join", watch, JoinFigures { sets: sets.len(), rows: None });
            match &sets[..] {
                [only] if is_of_format(only) => {
                    stages.time("pass on", || std::fs::copy(only, &to))?;
                    report.left_out.push("sets joined: one video, whose set is passed on".to_owned());
                }
                _ => report.rows = Some(stages.time("join", || join(&sets, &to, &to))?),
            }
            Ok(report.timed(&stages))
        })?;
        Ok(report.made(Vec::new()))
    }
}
