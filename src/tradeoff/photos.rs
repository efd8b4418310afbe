//! The photos job over its settings: how values are resampled, and how large a picture detection searches.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, ensure};
use geo::{Contains, Point};
use ndarray::Array2;
use rayon::prelude::*;

use crate::job::Watch;
use crate::npy;
use crate::photo::outline::{Axis, DetectOptions, Drawn, Outline, OutlineOptions, Sources, detect, read_annotated};
use crate::photo::{
    NailFrame, Normalization, Outputs, Photo, PhotoSet, Photograph, PhotosOptions, Resample, run as run_photos,
};
use crate::tradeoff::measure::rows::{Measured, Row};
use crate::tradeoff::measure::timing::{Effort, Run, in_turns};

/// How values between pixels come about: job and choice.
pub const RESAMPLING: (&str, &str) = ("photos", "resampling");
/// How large a picture is searched.
pub(super) const DETECTION: (&str, &str) = ("photos", "detection");
/// Root mean square difference inside the nail.
const PICTURE_ERROR: &str = "normalized picture inside the nail, RMS of 255";
/// The same of nails with few pixels.
pub(super) const SMALL_PICTURE_ERROR: &str = "normalized picture, nails of 20 to 30 px, RMS of 255";
/// Root mean square difference over the pixels of all poses' maps.
const MAP_ERRORS: [(&str, &str); 2] = [("mean", "map of the mean, RMS of 255"), ("sd", "map of the SD, RMS of 255")];
/// Why the SD has no error.
const NO_SD: &str =
    "left out, as there is none; it needs two subjects in a pose (--subjects 2, or an --input that has them)";
/// Of all nails, a missed one counting as 1.
pub(super) const OUTLINE_ERROR: &str = "detected outline, mean of 1 - IoU (missed = 1)";
const RESAMPLE: [Resample; 3] = [Resample::Nearest, Resample::Linear, Resample::Cubic];
/// Longest sides that detection searches, pixels; the default beside them.
const WORKING_PX: [u32; 4] = [128, 200, 320, 640];

/// What is measured.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The set of photographs.
    pub set: PathBuf,
    /// Its truth, as `lunula phantom photos` writes it.
    pub truth: PathBuf,
    /// A set of small nails and its truth.
    pub small: Option<(PathBuf, PathBuf)>,
    /// How much.
    pub effort: Effort,
}

/// What `lunula photos` resamples with.
pub(super) fn resampling_default() -> String {
    resampling(Resample::default())
}

/// What `lunula photos` searches.
pub(super) fn detection_default() -> String {
    detection(DetectOptions::default().working_size_px)
}

fn resampling(resample: Resample) -> String {
    format!("resample {}", kernel(resample))
}

fn kernel(resample: Resample) -> &'static str {
    match resample {
        Resample::Nearest => "nearest",
        Resample::Linear => "linear",
        Resample::Cubic => "cubic",
    }
}

fn detection(working_size_px: u32) -> String {
    format!("detect on {working_size_px} px")
}

#[derive(Debug)]
struct Truth {
    outline: Outline,
    normalized: Array2<f32>,
    inside: Vec<bool>,
}

/// A set with its truth in memory.
#[derive(Debug)]
pub struct Scene {
    set: PhotoSet,
    folder: PathBuf,
    truth: PathBuf,
    truths: Vec<Truth>,
    /// Whether its nails are small.
    small: bool,
}

impl Scene {
    fn read(folder: &Path, truth: &Path, small: bool) -> anyhow::Result<Self> {
        let set = PhotoSet::open(folder, &[])?;
        let truths = set.photos.par_iter().map(|photo| read_truth(photo, truth)).collect::<anyhow::Result<_>>()?;
        Ok(Self { set, folder: folder.to_owned(), truth: truth.to_owned(), truths, small })
    }

    /// The folder of the photographs.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// How wrong the results of another program are, each error by its unit: `out` holds `normalized/POSE/SUBJECT.png`
    /// and `maps/`, as `lunula photos` writes them.
    ///
    /// # Errors
    /// A result that is missing or of another size, with its name.
    pub fn errors(&self, out: &Path) -> anyhow::Result<Vec<(&'static str, f64)>> {
        let name = |photo: &Photo| format!("normalized/{}/{}.png", photo.pose, photo.subject);
        errors(self, out, self.set.photos.iter().map(name).enumerate())
    }
}

/// The sets of `settings` with their truths.
///
/// # Errors
/// A set or truth that can't be read, with its file.
pub fn scenes(settings: &Settings) -> anyhow::Result<Vec<Scene>> {
    let small = settings.small.as_ref().map(|(set, truth)| Scene::read(set, truth, true));
    std::iter::once(Scene::read(&settings.set, &settings.truth, false)).chain(small).collect()
}

/// The kernels by name, with the samples that a normalized picture takes with each.
#[must_use]
pub fn kernels() -> [(&'static str, u64); 3] {
    RESAMPLE.map(|resample| (kernel(resample), taps(resample)))
}

/// Measures every setting. Without a pose of two subjects there is no SD to be wrong: its curve is
/// left out, and [`Measured::refused`] says so.
///
/// # Errors
/// A set or truth that can't be read, with its file; [`Interrupted`](crate::job::Interrupted).
pub fn measure(settings: &Settings) -> anyhow::Result<Measured> {
    let scenes = scenes(settings)?;
    let effort = &settings.effort;
    let mut measured = Measured::default();
    // One thread, as the times of all jobs here are.
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for scene in &scenes {
        let found = in_turns(&RESAMPLE, effort, |&resample, first| one.install(|| resampled(scene, resample, first)))?;
        for (resample, found) in RESAMPLE.into_iter().zip(found) {
            let (time, errors) = found?;
            let row = |(unit, error)| Row::own(RESAMPLING, &resampling(resample), (error, unit), time, taps(resample));
            measured.rows.extend(errors.into_iter().map(row));
        }
    }
    let [_, (_, of_sd)] = MAP_ERRORS;
    if measured.rows.iter().all(|row| row.error_unit != of_sd) {
        measured.refused.push(format!("{of_sd}: {NO_SD}"));
    }
    let mut sizes = WORKING_PX.to_vec();
    let default = DetectOptions::default().working_size_px;
    if !sizes.contains(&default) {
        sizes.push(default);
    }
    let pictures: Vec<Photograph> = scenes[0].set.photos.iter().map(read_picture).collect::<anyhow::Result<_>>()?;
    let found = in_turns(&sizes, effort, |&px, _| detected(&pictures, &scenes[0].truths, px))?;
    for (px, found) in sizes.into_iter().zip(found) {
        let (time, (error, work)) = found?;
        measured.rows.push(Row::own(DETECTION, &detection(px), (error, OUTLINE_ERROR), time, work));
    }
    Ok(measured)
}

/// Samples of a photograph that a normalized picture takes.
fn taps(resample: Resample) -> u64 {
    let each: u64 = match resample {
        Resample::Nearest => 1,
        Resample::Linear => 4,
        Resample::Cubic => 16,
    };
    let size = Normalization::default().size as u64;
    each * size * size
}

fn read_picture(photo: &Photo) -> anyhow::Result<Photograph> {
    Photograph::read(&photo.path).with_context(|| photo.file.clone())
}

fn read_truth(photo: &Photo, truth: &Path) -> anyhow::Result<Truth> {
    let name = format!("{}/{}", photo.pose, photo.subject);
    let picture = read_picture(photo)?;
    let file = truth.join(format!("outlines/{name}.json"));
    let nail = read_annotated(&file, &picture, Drawn::Auto)?.nails.swap_remove(0);
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

/// Errors, each with its name.
type Errors = Vec<(&'static str, f64)>;

/// The whole job with drawn outlines: the time of the only stage that the setting changes, and the errors of its
/// results.
fn resampled(scene: &Scene, resample: Resample, first: bool) -> Run<Errors> {
    let normalization = Normalization { resample, ..Normalization::default() };
    let outlines = OutlineOptions { sources: Sources::Annotated, ..OutlineOptions::default() };
    let options = PhotosOptions { normalization, outlines, ..PhotosOptions::default() };
    let out = tempfile::tempdir()?;
    let report = run_photos(&scene.set, &options, &Outputs::maps(out.path()), &Watch::nobody())?;
    let stage = report.stages.iter().find(|s| s.stage == "normalize").context("nothing was normalized")?;
    let seconds = stage.thread_s / stage.runs as f64;
    if !first {
        return Ok((seconds, None));
    }
    let named = report.nails.iter().filter_map(|row| Some((row.photo, row.normalized.clone()?)));
    Ok((seconds, Some(errors(scene, out.path(), named)?)))
}

/// Of the normalized pictures, each a photograph's, and of the maps under `out`.
fn errors(scene: &Scene, out: &Path, pictures: impl Iterator<Item = (usize, String)>) -> anyhow::Result<Errors> {
    let mut difference = Difference::default();
    for (photo, name) in pictures {
        let picture = image::open(out.join(&name)).with_context(|| name.clone())?.to_luma16();
        let truth = &scene.truths[photo];
        let made = picture.iter().map(|&level| f32::from(level) / 65535.0);
        for ((made, exact), _) in made.zip(&truth.normalized).zip(&truth.inside).filter(|(_, inside)| **inside) {
            difference.add(made, *exact);
        }
    }
    let what = if scene.small { SMALL_PICTURE_ERROR } else { PICTURE_ERROR };
    let mut errors = vec![(what, difference.rms_of_255().context("no nail was normalized")?)];
    if scene.small {
        return Ok(errors);
    }
    for (kind, unit) in MAP_ERRORS {
        let mut difference = Difference::default();
        for pose in scene.set.poses() {
            let name = format!("maps/{pose}-{kind}.npy");
            let (made, exact) = (read_map(&out.join(&name))?, read_map(&scene.truth.join(&name))?);
            ensure!(made.dim() == exact.dim(), "{name}: {:?} and {:?} pixels", made.dim(), exact.dim());
            made.iter().zip(&exact).for_each(|(made, exact)| difference.add(*made, *exact));
        }
        errors.extend(difference.rms_of_255().map(|error| (unit, error)));
    }
    Ok(errors)
}

fn read_map(path: &Path) -> anyhow::Result<Array2<f32>> {
    npy::read(path).map_err(|why| anyhow::anyhow!("{}: {why}", path.display()))
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

    /// None where nothing was compared.
    fn rms_of_255(&self) -> Option<f64> {
        (self.count > 0).then(|| 255.0 * (self.squares / self.count as f64).sqrt())
    }
}

/// Detection alone, on decoded photographs: seconds a photograph, the mean error and pixels searched.
fn detected(pictures: &[Photograph], truths: &[Truth], working_size_px: u32) -> Run<(f64, u64)> {
    let options = DetectOptions { working_size_px, ..DetectOptions::default() };
    let (mut errors, mut work, mut seconds) = (0.0, 0, 0.0);
    for (picture, truth) in pictures.iter().zip(truths) {
        let (width, height) = (f64::from(picture.image.width()), f64::from(picture.image.height()));
        let shrunk = (f64::from(working_size_px) / width.max(height)).min(1.0);
        work += (width * height * shrunk * shrunk) as u64;
        let start = Instant::now();
        let found = detect(&picture.image, &options)?;
        seconds += start.elapsed().as_secs_f64();
        errors += 1.0 - found.nails.iter().map(|n| n.outline.iou(&truth.outline)).fold(0.0, f64::max);
    }
    let count = pictures.len();
    Ok((seconds / count as f64, Some((errors / count as f64, work / count as u64))))
}
