//! `normalize` and `maps` in a pipeline (4.2.2): photographs, by default all of one subject, to nails in their frames
//! and the sums that maps are made of; the sums of all subjects to mean, standard deviation and count by pose (Fig.
//! 53-56).
//!
//! A photograph's subject and pose are its keys. Its outline is the file of role `outlines` that has its keys, else the
//! LabelMe file beside it, else detected. A photograph that gives nothing is reported, and the others are done. Where
//! earlier maps are up to date with all that they hold, only new sums are read and added: the bytes are the same, as
//! sums are integers.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::job::{At, Demand, Foreseen, Job, Keys, Kind, Made, OptionFault, Order, Part, Quality, Role, Takes, Work};
use crate::photo::options::{Outputs, PhotosOptions, Results};
use crate::photo::outline::{Detector, OutlinePlace, Sources};
use crate::photo::run::job::run;
use crate::photo::run::plan::{Foreknown, plan_foreknown};
use crate::photo::set::{Photo, PhotoSet};
use crate::photo::sums::{Accuracy, Gathering, gather};
use crate::stages::Step;

const OUTLINES: &str = "outlines";
const FIGURES: &str = "figures";

fn outputs(folder: &Path, demand: &Demand) -> Outputs {
    let results = Results::Sums { pictures: demand.draws() };
    Outputs { folder: folder.to_owned(), results, outlines: None }
}

/// The pose of photographs whose keys name none.
const ONLY_POSE: &str = "photos";

/// Whose photograph it is, and in what pose.
fn subject_and_pose(keys: &Keys, path: &Path) -> (String, String) {
    let stem = || path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let subject = keys.get("subject").map_or_else(stem, str::to_owned);
    (subject, keys.get("pose").unwrap_or(ONLY_POSE).to_owned())
}

/// The outline of a photograph: that of its very keys before one that speaks of fewer.
fn outline_of<'a>(keys: &Keys, outlines: impl Iterator<Item = (&'a Keys, &'a Path)>) -> Option<PathBuf> {
    let agreeing = outlines.filter(|(theirs, _)| theirs.agree(keys));
    let best = agreeing.max_by_key(|(theirs, _)| theirs.0.keys().filter(|name| keys.get(name).is_some()).count());
    best.map(|(_, path)| path.to_owned())
}

impl Job for PhotosOptions {
    const KIND: Kind = Kind::of::<Self>(
        "normalize",
        &[
            Role::new("photo", Takes::Many, "photographs; their keys are `subject` and `pose`"),
            Role::new(
                OUTLINES,
                Takes::AnyNumber,
                "LabelMe files or masks of the same subject and pose; where there is none, \
                        <photo>.json, else detection",
            ),
        ],
        &[Part::new("sums", ""), Part::new("nails", "nails.csv"), Part::pictures("normalized")],
    )
    .revision(18);

    fn checked(mut self) -> Result<Self, OptionFault> {
        if self.channels {
            let what = "channels are compared over all subjects at once; remove it here and run `lunula photos \
                        --channels` on the set";
            return Err(OptionFault { key: "channels".into(), what: what.into() });
        }
        // What the task's results depend on is among its inputs.
        self.outlines.listed_only = true;
        Ok(self)
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let outlines: Vec<_> = inputs.iter().filter(|input| input.role == OUTLINES).collect();
        let foreknown = inputs.iter().filter(|input| input.role == "photo").map(|input| {
            let (subject, pose) = subject_and_pose(&input.keys, &input.path);
            let outline = outline_of(&input.keys, outlines.iter().map(|o| (&o.keys, o.path.as_path())));
            if input.exists {
                let file = String::new();
                let photo = Photo { pose, subject, file, path: input.path.clone(), outline, tone: None };
                return Foreknown::of(&photo, self);
            }
            let drawn = outline.or_else(|| (input.facts.outlined == Some(true)).then(|| labelme_beside(&input.path)));
            let outlines = match (self.outlines.sources, drawn) {
                (Sources::Detect, _) | (Sources::Auto, None) => OutlinePlace::Detection,
                (Sources::Annotated, None) => OutlinePlace::Nowhere,
                (_, Some(file)) => OutlinePlace::of_file(file),
            };
            Foreknown { pose, grey: input.facts.grey, outlines }
        });
        Ok(plan_foreknown(&foreknown.collect::<Vec<_>>(), self, &outputs(Path::new(""), demand)))
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let photos = inputs.iter().filter(|input| input.role == "photo").count();
        let outlines = inputs.iter().filter(|input| input.role == OUTLINES).count();
        let detected = match self.outlines.sources {
            Sources::Auto => photos.saturating_sub(outlines),
            Sources::Annotated => 0,
            Sources::Detect => photos,
        };
        // The first represents all: a subject's photographs are one camera's.
        let first = inputs.iter().find(|input| input.role == "photo" && input.exists);
        let size_px = first.and_then(|input| image::image_dimensions(&input.path).ok()).unwrap_or((640, 480));
        let pixels = f64::from(size_px.0) * f64::from(size_px.1);
        let at_once = photos.min(std::thread::available_parallelism().map_or(1, usize::from)) as u64;
        let sums = 20 * (self.normalization.size * self.normalization.size) as u64 * photos as u64;
        let searched = if self.check_outlines { photos } else { detected };
        let with_net = self.check_outlines || detected > 0 && self.outlines.detect.detector == Detector::Net;
        let net = if with_net { NET_BYTES + at_once * NET_BYTES_A_THREAD } else { 0 };
        let memory = at_once * (BYTES_A_PIXEL * pixels) as u64 + sums + BYTES_AT_LEAST + net;
        let seconds = photos as f64 * (NORMALIZE_S + READ_S_A_PIXEL * pixels) + searched as f64 * DETECT_S;
        (memory, seconds)
    }

    fn beside(&self, role: &str, path: &Path) -> Vec<(&'static str, PathBuf)> {
        let reads = role == "photo" && self.outlines.sources != Sources::Detect;
        reads.then(|| (OUTLINES, labelme_beside(path))).into_iter().collect()
    }

    fn each(&self) -> &'static [&'static str] {
        &["subject"]
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let photo = |at: &At| {
            let (subject, pose) = subject_and_pose(&at.keys, &at.path);
            let outline = outline_of(&at.keys, work.of(OUTLINES).map(|o| (&o.keys, o.path.as_path())));
            Photo { pose, subject, file: at.name.clone(), path: at.path.clone(), outline, tone: None }
        };
        let set = PhotoSet::of(work.of("photo").map(photo).collect());
        let outputs = outputs(work.folder, order.demand);
        let report = work.run(order.said, |watch| run(&set, self, &outputs, watch))?;
        Ok(report.made(Vec::new()))
    }
}

/// Memory while one photograph is worked on, with detection; measured with 640 x 480 to 24 million pixels.
const BYTES_A_PIXEL: f64 = 24.0;
const BYTES_AT_LEAST: u64 = 16 << 20;
/// Of the network that finds nails, and of each thread's copy at work: measured with a square photograph that shows no
/// large nail, which is looked at in 1024 x 1024.
const NET_BYTES: u64 = 32 << 20;
const NET_BYTES_A_THREAD: u64 = 320 << 20;
/// Time of one photograph, measured on one core of 2.5 GHz.
const READ_S_A_PIXEL: f64 = 2.4e-8;
const NORMALIZE_S: f64 = 0.007;
const DETECT_S: f64 = 0.17;

fn labelme_beside(photo: &Path) -> PathBuf {
    photo.with_extension("json")
}

/// A stage that makes maps of sums.
#[derive(Debug, Clone, Copy, Args)]
pub struct MapsJob {}

impl Job for MapsJob {
    const KIND: Kind = Kind::of::<Self>(
        "maps",
        &[
            Role::new("sums", Takes::Many, "what `normalize` made"),
            Role::new("truth", Takes::Optional, "a folder of exact maps, <pose>-mean.npy and <pose>-sd.npy"),
        ],
        &[Part::new("maps", ""), Part::new("nails", "nails.csv"), Part::if_wanted(FIGURES, "figures")],
    )
    .revision(5);

    fn demand(&self, role: &str, _own: &Demand) -> Demand {
        let parts = if role == "sums" { ["sums"].into() } else { [].into() };
        Demand { parts, ..Demand::default() }
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let several = inputs.iter().filter(|input| input.role == "sums").count() > 1;
        let figures = demand.wants(FIGURES);
        Ok(vec![
            Step::new("sums joined", true, "new ones are added to those of the maps made before".into()),
            Step::new("mean", true, "by pose".into()),
            Step::new(
                "standard deviation",
                several,
                if several { "over subjects, by pose".into() } else { "it needs two subjects in a pose".into() },
            ),
            Step::figures(figures, "by pose, and sheets"),
        ])
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        (256 << 20, 0.5 + 0.005 * inputs.len() as f64)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let parts: Vec<PathBuf> = work.of("sums").map(|at| at.path.clone()).collect();
        let truth = work.one("truth").map(|at| at.path.as_path());
        let figures = order.demand.wants(FIGURES);
        let gathering = Gathering { parts: &parts, before: work.before, truth, figures, out: work.folder };
        let report = work.run(order.said, |watch| gather(&gathering, watch))?;
        let quality = quality(&report.accuracy);
        Ok(report.made(quality))
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
