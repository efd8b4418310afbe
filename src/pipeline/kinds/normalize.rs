//! `normalize`: photographs, by default all of one subject, to nails in their frames and the sums that maps are made of
//! (4.2.2).
//!
//! A photograph's subject and pose are its keys. Its outline is the file of role `outlines` that has its keys, else the
//! LabelMe file beside it, else detected. A photograph that gives nothing is reported, and the others are done.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::json;

use super::options::request;
use super::pool::in_pool;
use crate::photo::outline::{OutlinePlace, Sources};
use crate::photo::{
    Foreknown, Outputs, Photo, PhotoSet, PhotosOptions, Results, Watch, is_picture, plan_foreknown, run,
};
use crate::pipeline::{
    At, Demand, Facts, Foreseen, Job, KeyFault, Keys, Kind, Made, Part, Prepared, Role, Takes, Work,
};
use crate::stages::Step;

/// The kind.
pub(super) static NORMALIZE: Kind = Kind {
    name: "normalize",
    about: "photographs of nails to pictures in the nail's frame and their sums, a subject at a time",
    roles: &[
        Role { name: "photo", takes: Takes::Many, about: "photographs; their keys are `subject` and `pose`" },
        Role {
            name: OUTLINES,
            takes: Takes::AnyNumber,
            about: "LabelMe files or masks of the same subject and pose; where there is none, <photo>.json, else \
                    detection",
        },
    ],
    parts: &[
        Part { name: "sums", file: "", only_if_wanted: false, about: "nails.csv and the sums by pose, for `maps`" },
        Part { name: "nails", file: "nails.csv", only_if_wanted: false, about: "every nail, used or not" },
        Part {
            name: PICTURES,
            file: "normalized",
            only_if_wanted: true,
            about: "the normalized pictures, <pose>/<subject>.png",
        },
    ],
    revision: 2,
    keys: KEYS,
    prepare: |keys| Ok(Arc::new(Normalize::prepare(keys)?)),
};

const OUTLINES: &str = "outlines";
const PICTURES: &str = "pictures";
const KEYS: &[&str] = &[
    "outline",
    "mask_value",
    "distal",
    "annotations",
    "size",
    "margin",
    "channel",
    "linear",
    "white",
    "max_megapixels",
    "resample",
    "detect_size",
];

#[derive(Debug, Clone)]
struct Normalize {
    options: PhotosOptions,
}

impl Normalize {
    fn prepare(keys: toml::Table) -> Result<Self, KeyFault> {
        let mut options: PhotosOptions = request(&keys)?;
        // What the task's results depend on is among its inputs.
        options.outlines.listed_only = true;
        Ok(Self { options })
    }
}

fn outputs(folder: &Path, demand: &Demand) -> Outputs {
    let results = Results::Sums { pictures: demand.parts.contains(PICTURES) };
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

impl Prepared for Normalize {
    fn demand(&self, _role: &str, _own: &Demand) -> Demand {
        Demand::default()
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        json!({
            "normalization": self.options.normalization,
            "outline": self.options.outlines.sources,
            "distal": self.options.outlines.distal,
            "mask_value": self.options.outlines.mask_values,
            "max_megapixels": self.options.max_megapixels,
            "annotations": self.options.outlines.drawn,
            "detect_size": self.options.outlines.detect.working_size_px,
            "pictures": demand.parts.contains(PICTURES),
        })
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(NormalizeJob { options: self.options.clone(), demand: demand.clone() })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let outlines: Vec<_> = inputs.iter().filter(|input| input.role == OUTLINES).collect();
        let foreknown = inputs.iter().filter(|input| input.role == "photo").map(|input| {
            let (subject, pose) = subject_and_pose(&input.keys, &input.path);
            let outline = outline_of(&input.keys, outlines.iter().map(|o| (&o.keys, o.path.as_path())));
            if input.stands {
                let file = String::new();
                let photo = Photo { pose, subject, file, path: input.path.clone(), outline };
                return Foreknown::of(&photo, &self.options);
            }
            let drawn = outline.or_else(|| (input.facts.outlined == Some(true)).then(|| labelme_beside(&input.path)));
            let outlines = match (self.options.outlines.sources, drawn) {
                (Sources::Detect, _) | (Sources::Auto, None) => OutlinePlace::Detection,
                (Sources::Annotated, None) => OutlinePlace::Nowhere,
                (_, Some(file)) if is_picture(&file) => OutlinePlace::Mask(file),
                (_, Some(file)) => OutlinePlace::LabelMe(file),
            };
            Foreknown { pose, grey: input.facts.grey, outlines }
        });
        Ok(plan_foreknown(&foreknown.collect::<Vec<_>>(), &self.options, &outputs(Path::new(""), demand)))
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let photos = inputs.iter().filter(|input| input.role == "photo").count();
        let outlines = inputs.iter().filter(|input| input.role == OUTLINES).count();
        let detected = match self.options.outlines.sources {
            Sources::Auto => photos.saturating_sub(outlines),
            Sources::Annotated => 0,
            Sources::Detect => photos,
        };
        // The first represents all: a subject's photographs are one camera's.
        let first = inputs.iter().find(|input| input.role == "photo" && input.stands);
        let size_px = first.and_then(|input| image::image_dimensions(&input.path).ok()).unwrap_or((640, 480));
        let pixels = f64::from(size_px.0) * f64::from(size_px.1);
        let at_once = photos.min(std::thread::available_parallelism().map_or(1, usize::from)) as u64;
        let sums = 20 * (self.options.normalization.size * self.options.normalization.size) as u64 * photos as u64;
        let memory = at_once * (BYTES_A_PIXEL * pixels) as u64 + sums + BYTES_AT_LEAST;
        let seconds = photos as f64 * (NORMALIZE_S + READ_S_A_PIXEL * pixels) + detected as f64 * DETECT_S;
        (memory, seconds)
    }

    fn beside(&self, role: &str, path: &Path) -> Vec<(&'static str, PathBuf)> {
        let reads = role == "photo" && self.options.outlines.sources != Sources::Detect;
        reads.then(|| (OUTLINES, labelme_beside(path))).into_iter().collect()
    }

    fn each(&self) -> &'static [&'static str] {
        &["subject"]
    }
}

/// Memory while one photograph is worked on, with detection; measured with 640 x 480 to 24 million pixels.
const BYTES_A_PIXEL: f64 = 24.0;
const BYTES_AT_LEAST: u64 = 16 << 20;
/// Time of one photograph, measured on one core of 2.5 GHz.
const READ_S_A_PIXEL: f64 = 2.4e-8;
const NORMALIZE_S: f64 = 0.007;
const DETECT_S: f64 = 0.17;

fn labelme_beside(photo: &Path) -> PathBuf {
    photo.with_extension("json")
}

struct NormalizeJob {
    options: PhotosOptions,
    demand: Demand,
}

impl Job for NormalizeJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let photo = |at: &At| {
            let (subject, pose) = subject_and_pose(&at.keys, &at.path);
            let outline = outline_of(&at.keys, work.of(OUTLINES).map(|o| (&o.keys, o.path.as_path())));
            Photo { pose, subject, file: at.name.clone(), path: at.path.clone(), outline }
        };
        let set = PhotoSet::of(work.of("photo").map(photo).collect());
        let (outputs, watch) = (outputs(work.folder, &self.demand), Watch { stop: work.stop, tick: &|| {} });
        let report = in_pool(work.threads, || run(&set, &self.options, &outputs, &watch))??;
        Ok(Made {
            left_out: report.left_out.clone(),
            warnings: report.warnings.clone(),
            failed: report.failed.iter().map(|fault| format!("{}: {}", fault.place, fault.what)).collect(),
            stages: report.stages.clone(),
            quality: Vec::new(),
            report: serde_json::to_value(report)?,
        })
    }
}
