//! Drawing a set and writing it down: photographs in parallel, maps in the subjects' order, everything put in place at
//! the end.

use std::{
    fs, io,
    path::{Path, PathBuf},
    time::Instant,
};

use image::{DynamicImage, ExtendedColorType, ImageEncoder, ImageFormat, codecs::jpeg::JpegEncoder};
use ndarray::Array2;
use ndarray_npy::{WritableElement, WriteNpyExt};
use rayon::prelude::*;
use serde::Serialize;

use super::{
    FileFormat, PhotoOptions,
    files::{REPLACED, RESULTS, annotation, only_own},
    maps::ExactMaps,
};
use crate::job::Watch;
use crate::phantom::{
    nail::Pose,
    scene::place::{Error, PHOTOS_RECORD as RECORD, refused, staged, write_record},
};

/// What is true of one photograph; a row of `truth/nails.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhotoTruth {
    /// The photograph, relative to `photos/`.
    pub file: String,
    /// Number of the nail on the photograph, from 1.
    pub nail: u32,
    /// The subject's name.
    pub subject: String,
    /// The pose's name.
    pub pose: &'static str,
    /// Middle of the nail's box, pixels.
    pub center_x_px: f64,
    /// Middle of the nail's box, pixels.
    pub center_y_px: f64,
    /// Extent along the axis, pixels.
    pub length_px: f64,
    /// Extent across the axis, pixels.
    pub width_px: f64,
    /// Axis clockwise from up, degrees.
    pub axis_deg: f64,
}

/// Seconds spent, summed over the threads but for `total_s`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Stages {
    /// Drawing the photographs.
    pub draw_s: f64,
    /// Encoding and writing them and their annotations.
    pub write_s: f64,
    /// The exact normalized pictures and maps.
    pub truth_s: f64,
    /// From beginning to end.
    pub total_s: f64,
}

/// A set that was written.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// The photographs in the order of the table: by pose, then subject.
    pub photographs: Vec<PhotoTruth>,
    /// Where the time went.
    pub stages: Stages,
}

fn folder(path: PathBuf) -> Result<PathBuf, Error> {
    fs::create_dir_all(&path).map_err(refused(&path))?;
    Ok(path)
}

/// Writes the set that `options` ask for under `out`; a set written there before is replaced, unless its folders hold
/// files of others or outlines that were changed since.
///
/// # Errors
/// [`Error`]; what stood under `out` before is as it was.
pub fn write(options: &PhotoOptions, out: &Path) -> Result<Summary, Error> {
    write_watched(options, out, &Watch::nobody())
}

/// As [`write()`], watched: the ticks count photographs.
///
/// # Errors
/// [`Error`]; what stood under `out` before is as it was.
pub fn write_watched(options: &PhotoOptions, out: &Path, watch: &Watch<'_>) -> Result<Summary, Error> {
    let begin = Instant::now();
    options.check()?;
    let staging = staged(out, &RESULTS, RECORD, "of a synthetic set")?;
    let replaces = out.join(RECORD).is_file();
    if replaces {
        only_own(options, out)?;
    }
    let mut summary = draw_all(options, staging.path(), watch)?;
    staging.commit_exactly(if replaces { &REPLACED } else { &RESULTS })?;
    summary.stages.total_s = begin.elapsed().as_secs_f64();
    Ok(summary)
}

fn draw_all(options: &PhotoOptions, stage: &Path, watch: &Watch<'_>) -> Result<Summary, Error> {
    for pose in &options.poses {
        for place in ["photos", "truth/outlines", "truth/normalized"] {
            if options.truth_normalized || !place.ends_with("normalized") {
                folder(stage.join(place).join(pose.name()))?;
            }
        }
    }
    let maps_folder = folder(stage.join("truth/maps"))?;
    let all = options.poses.len() * options.subjects as usize;
    let mut summary = Summary { photographs: Vec::with_capacity(all), stages: Stages::default() };
    let at_once = 2 * rayon::current_num_threads();
    for &pose in &options.poses {
        let mut maps = ExactMaps::new(options.size);
        let subjects: Vec<u32> = (0..options.subjects).collect();
        for batch in subjects.chunks(at_once) {
            let drawn: Vec<Drawn> =
                batch.par_iter().map(|&subject| draw_one(options, stage, subject, pose)).collect::<Result<_, _>>()?;
            for one in drawn {
                let begin = Instant::now();
                maps.add(&one.normalized);
                summary.photographs.push(one.truth);
                summary.stages.draw_s += one.stages.draw_s;
                summary.stages.write_s += one.stages.write_s;
                summary.stages.truth_s += one.stages.truth_s + begin.elapsed().as_secs_f64();
            }
            (watch.tick)(summary.photographs.len() as u64, Some(all as u64));
            watch.go_on()?;
        }
        write_npy(&maps_folder.join(format!("{pose}-mean.npy")), &maps.mean())?;
        write_npy(&maps_folder.join(format!("{pose}-sd.npy")), &maps.sd())?;
        write_npy(&maps_folder.join(format!("{pose}-count.npy")), &maps.count)?;
    }
    write_table(&stage.join("truth/nails.csv"), &summary.photographs)?;
    write_record(&stage.join(RECORD), options)?;
    Ok(summary)
}

/// One photograph, written, and what the maps and the table need of it.
struct Drawn {
    truth: PhotoTruth,
    normalized: Array2<f32>,
    stages: Stages,
}

fn draw_one(options: &PhotoOptions, stage: &Path, subject: u32, pose: Pose) -> Result<Drawn, Error> {
    let name = options.subject_name(subject);
    let scene = options.scene(subject, pose);
    let mut stages = Stages::default();

    let begin = Instant::now();
    let picture = scene.render(&options.render_options(subject, pose))?;
    stages.draw_s = begin.elapsed().as_secs_f64();

    let begin = Instant::now();
    let file = format!("{name}.{}", options.format.extension());
    let photos = stage.join("photos").join(pose.name());
    encode(&picture, options.format, &photos.join(&file))?;
    drop(picture);
    if options.annotate {
        annotation(&scene, &file)?.write(&photos.join(format!("{name}.json")))?;
    }
    let above = format!("../../../photos/{pose}/{file}");
    annotation(&scene, &above)?.write(&stage.join(format!("truth/outlines/{pose}/{name}.json")))?;
    stages.write_s = begin.elapsed().as_secs_f64();

    let begin = Instant::now();
    let normalized = scene.normalized(options.size, options.margin);
    if options.truth_normalized {
        write_npy(&stage.join(format!("truth/normalized/{pose}/{name}.npy")), &normalized)?;
    }
    stages.truth_s = begin.elapsed().as_secs_f64();

    let [center_x_px, center_y_px] = scene.camera.centre_px;
    let truth = PhotoTruth {
        file: format!("{pose}/{file}"),
        nail: 1,
        subject: name,
        pose: pose.name(),
        center_x_px,
        center_y_px,
        length_px: scene.length_px(),
        width_px: scene.width_px(),
        axis_deg: scene.axis().clockwise_deg(),
    };
    Ok(Drawn { truth, normalized, stages })
}

fn encode(picture: &DynamicImage, format: FileFormat, path: &Path) -> Result<(), Error> {
    let failed = |source| Error::Encode { path: path.to_owned(), source };
    let mut bytes = Vec::new();
    let mut cursor = io::Cursor::new(&mut bytes);
    match format {
        FileFormat::Png => picture.write_to(&mut cursor, ImageFormat::Png).map_err(failed)?,
        FileFormat::Tif => picture.write_to(&mut cursor, ImageFormat::Tiff).map_err(failed)?,
        FileFormat::Bmp => picture.write_to(&mut cursor, ImageFormat::Bmp).map_err(failed)?,
        FileFormat::Jpg => {
            let colour = if picture.color().has_color() { ExtendedColorType::Rgb8 } else { ExtendedColorType::L8 };
            JpegEncoder::new_with_quality(&mut cursor, 95)
                .write_image(picture.as_bytes(), picture.width(), picture.height(), colour)
                .map_err(failed)?;
        }
    }
    Ok(fs::write(path, bytes).map_err(refused(path))?)
}

pub(in crate::phantom) fn write_npy<T: WritableElement>(path: &Path, array: &Array2<T>) -> Result<(), Error> {
    let mut bytes = Vec::new();
    array.write_npy(&mut bytes).map_err(|e| refused(path)(io::Error::other(e)))?;
    Ok(fs::write(path, bytes).map_err(refused(path))?)
}

fn write_table(path: &Path, rows: &[PhotoTruth]) -> Result<(), Error> {
    let mut writer = csv::Writer::from_path(path).map_err(|e| refused(path)(e.into()))?;
    for row in rows {
        writer.serialize(row).map_err(|e| refused(path)(e.into()))?;
    }
    Ok(writer.flush().map_err(refused(path))?)
}
