//! The photos job over its settings: how values are resampled, and how large a picture detection searches.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use anyhow::{Context, ensure};
use geo::{Contains, Point};
use ndarray::Array2;
use ndarray_npy::ReadNpyExt;
use rayon::prelude::*;

use super::{Row, median};
use crate::files::Staging;
use crate::photo::outline::{Axis, DetectOptions, Drawn, Outline, OutlineOptions, Sources, detect, read_annotated};
use crate::photo::{
    NailFrame, Normalization, Photo, PhotoSet, Photograph, PhotosOptions, Resample, Watch, run as run_photos,
};

/// Root mean square difference inside the nail.
const PICTURE_ERROR: &str = "normalized picture inside the nail, RMS of 255";
/// Root mean square difference over the pixels of all poses' maps.
const MAP_ERRORS: [(&str, &str); 2] = [("mean", "map of the mean, RMS of 255"), ("sd", "map of the SD, RMS of 255")];
/// Of all nails, a missed one counting as 1.
const OUTLINE_ERROR: &str = "detected outline, mean of 1 - IoU (missed = 1)";
const RESAMPLE: [Resample; 3] = [Resample::Nearest, Resample::Linear, Resample::Cubic];
/// Longest sides that detection searches, pixels.
const WORKING_PX: [u32; 4] = [128, 200, 320, 640];

/// What is measured, and how often.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The set of photographs.
    pub set: PathBuf,
    /// Its truth, as `lunula phantom photos` writes it.
    pub truth: PathBuf,
    /// Runs of each setting; the median time counts.
    pub repeats: usize,
}

/// One photograph's truth.
struct Truth {
    outline: Outline,
    normalized: Array2<f32>,
    inside: Vec<bool>,
}

/// Measures every setting.
///
/// # Errors
/// A set or truth that can't be read, with its file.
pub fn measure(settings: &Settings) -> anyhow::Result<Vec<Row>> {
    let set = PhotoSet::open(&settings.set, &[])?;
    let truths: Vec<Truth> =
        set.photos.par_iter().map(|photo| read_truth(photo, &settings.truth)).collect::<anyhow::Result<_>>()?;
    let mut rows: Vec<Row> = Vec::new();
    for resample in RESAMPLE {
        rows.extend(resampled(&set, &truths, resample, settings)?);
    }
    for working_size_px in WORKING_PX {
        rows.push(detected(&set, &truths, working_size_px, settings)?);
    }
    Ok(rows)
}

fn read_truth(photo: &Photo, truth: &Path) -> anyhow::Result<Truth> {
    let name = format!("{}/{}", photo.pose, photo.subject);
    let picture = Photograph::read(&photo.path).with_context(|| photo.file.clone())?;
    let file = truth.join(format!("outlines/{name}.json"));
    let nail = read_annotated(&file, &picture, Drawn::Auto)?.swap_remove(0);
    let (outline, axis) = (nail.outline?, nail.axis.with_context(|| format!("{}: no axis", file.display()))?);
    let file = truth.join(format!("normalized/{name}.npy"));
    let normalized = read_map(&file)?;
    let size = Normalization::default().size;
    ensure!(normalized.dim() == (size, size), "{}: is not {size} x {size}", file.display());
    let inside = inside(&outline, axis)?;
    Ok(Truth { outline, normalized, inside })
}

/// Which pixels of the normalized picture lie inside the outline.
fn inside(outline: &Outline, axis: Axis) -> anyhow::Result<Vec<bool>> {
    let Normalization { size, margin, .. } = Normalization::default();
    let frame = NailFrame::new(outline, axis)?;
    let nail = size as f64 / margin;
    let half = size as f64 / 2.0;
    let pixel = |row: usize, column: usize| {
        let [x, y] = frame.photo_from_nail((column as f64 + 0.5 - half) / nail, (half - row as f64 - 0.5) / nail);
        outline.polygon().contains(&Point::new(x, y))
    };
    Ok((0..size * size).map(|at| pixel(at / size, at % size)).collect())
}

/// The whole job with drawn outlines: errors of its normalized pictures and of its maps.
fn resampled(set: &PhotoSet, truths: &[Truth], resample: Resample, settings: &Settings) -> anyhow::Result<Vec<Row>> {
    let normalization = Normalization { resample, ..Normalization::default() };
    let outlines = OutlineOptions { sources: Sources::Annotated, ..OutlineOptions::default() };
    let options = PhotosOptions { normalization, outlines, keep_detected: false };
    let mut seconds = Vec::new();
    let mut errors = Vec::new();
    for repeat in 0..settings.repeats {
        let out = tempfile::tempdir()?;
        let staging = Staging::new(out.path())?;
        let result = run_photos(set, &options, &staging, &Watch { stop: &AtomicBool::new(false), tick: &|| {} })?;
        // The only stage that the setting changes.
        let stages = result.stages.list();
        seconds.extend(stages.iter().filter(|s| s.stage == "normalize").map(|s| s.thread_s / s.runs as f64));
        if repeat > 0 {
            continue;
        }
        staging.commit()?;
        let mut difference = Difference::default();
        for row in &result.rows {
            let Some(name) = &row.normalized else { continue };
            let picture = image::open(out.path().join(name)).with_context(|| name.clone())?.to_luma16();
            let truth = &truths[row.photo];
            let made = picture.iter().map(|&level| f32::from(level) / 65535.0);
            for ((made, exact), _) in made.zip(&truth.normalized).zip(&truth.inside).filter(|(_, inside)| **inside) {
                difference.add(made, *exact);
            }
        }
        errors.push((PICTURE_ERROR, difference.rms_of_255()));
        for (kind, unit) in MAP_ERRORS {
            let mut difference = Difference::default();
            for pose in set.poses() {
                let name = format!("maps/{pose}-{kind}.npy");
                let (made, exact) = (read_map(&out.path().join(&name))?, read_map(&settings.truth.join(&name))?);
                ensure!(made.dim() == exact.dim(), "{name}: {:?} and {:?} pixels", made.dim(), exact.dim());
                made.iter().zip(&exact).for_each(|(made, exact)| difference.add(*made, *exact));
            }
            errors.push((unit, difference.rms_of_255()));
        }
    }
    let taps: u64 = match resample {
        Resample::Nearest => 1,
        Resample::Linear => 4,
        Resample::Cubic => 16,
    };
    let run_s = median(seconds);
    let setting = format!("resample {}", format!("{resample:?}").to_lowercase());
    let work = taps * (normalization.size * normalization.size) as u64;
    let row = |(unit, error): (&str, f64)| {
        let (setting, error_unit) = (setting.clone(), unit.to_owned());
        Row { job: "photos", setting, error, error_unit, run_s, work }
    };
    Ok(errors.into_iter().map(row).collect())
}

fn read_map(path: &Path) -> anyhow::Result<Array2<f32>> {
    let file = std::fs::File::open(path).with_context(|| path.display().to_string())?;
    Array2::read_npy(file).with_context(|| path.display().to_string())
}

/// Squared differences where both values are known.
#[derive(Default)]
struct Difference {
    squares: f64,
    count: u64,
}

impl Difference {
    fn add(&mut self, made: f32, exact: f32) {
        if !made.is_nan() && !exact.is_nan() {
            self.squares += f64::from(made - exact).powi(2);
            self.count += 1;
        }
    }

    fn rms_of_255(&self) -> f64 {
        255.0 * (self.squares / self.count as f64).sqrt()
    }
}

/// Detection alone, on decoded photographs.
fn detected(set: &PhotoSet, truths: &[Truth], working_size_px: u32, settings: &Settings) -> anyhow::Result<Row> {
    let options = DetectOptions { working_size_px, ..DetectOptions::default() };
    let mut errors = Vec::new();
    let mut seconds = Vec::new();
    let mut work = 0;
    for (photo, truth) in set.photos.iter().zip(truths) {
        let picture = Photograph::read(&photo.path).with_context(|| photo.file.clone())?;
        let (width, height) = (picture.image.width(), picture.image.height());
        let shrunk = (f64::from(working_size_px) / f64::from(width.max(height))).min(1.0);
        work += (f64::from(width) * f64::from(height) * shrunk * shrunk) as u64;
        let mut times = Vec::new();
        for repeat in 0..settings.repeats {
            let start = Instant::now();
            let found = detect(&picture.image, &options);
            times.push(start.elapsed().as_secs_f64());
            if repeat == 0 {
                let best = found.nails.iter().map(|n| n.outline.iou(&truth.outline)).fold(0.0, f64::max);
                errors.push(1.0 - best);
            }
        }
        seconds.push(median(times));
    }
    let count = set.photos.len();
    Ok(Row {
        job: "photos",
        setting: format!("detect on {working_size_px} px"),
        error: errors.iter().sum::<f64>() / count as f64,
        error_unit: OUTLINE_ERROR.to_owned(),
        run_s: median(seconds),
        work: work / count as u64,
    })
}
