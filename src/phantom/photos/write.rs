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
use serde_json::json;

use super::{
    FileFormat, PhotoOptions,
    files::{REPLACED, RESULTS, annotation, files, only_own},
    maps::ExactMaps,
};
use crate::job::{Facts, Watch};
use crate::phantom::{
    Faults,
    nail::Pose,
    scene::place::{Error, PHOTOS_RECORD as RECORD, refused, staged, write_record},
    scene::recording::{Cost, Generated, Written, sorted},
};

/// What is true of one photograph; a row of `truth/nails.csv`: `file` is relative to `photos/`.
#[derive(Serialize)]
struct PhotoTruth {
    file: String,
    /// Number of the nail on the photograph, from 1.
    nail: u32,
    subject: String,
    pose: &'static str,
    /// Middle of the nail's box.
    center_x_px: f64,
    center_y_px: f64,
    length_px: f64,
    width_px: f64,
    /// Axis clockwise from up.
    axis_deg: f64,
}

/// Seconds spent, summed over the threads: drawing the photographs, encoding and writing them and their annotations,
/// the exact normalized pictures and maps.
#[derive(Default, Serialize)]
struct Stages {
    draw_s: f64,
    write_s: f64,
    truth_s: f64,
}

/// Seconds on one thread a pixel; measured with a release build on a Xeon of 2.1 GHz.
const PHOTO_S_PER_PX: f64 = 4e-7;

impl Generated for PhotoOptions {
    fn check(&self) -> Result<(), Faults> {
        self.check()
    }

    fn options(&self) -> serde_json::Value {
        json!({ "photos": self })
    }

    fn files(&self) -> Vec<String> {
        sorted(files(self))
    }

    fn facts(&self, file: &str) -> Facts {
        if Path::new(file).starts_with("photos") {
            Facts { grey: Some(self.grey), outlined: Some(self.annotate), ..Facts::default() }
        } else {
            Facts::default()
        }
    }

    fn cost(&self) -> Cost {
        let all = f64::from(self.subjects) * self.poses.len() as f64;
        Cost::of_pictures([self.width, self.height].map(f64::from), all, PHOTO_S_PER_PX)
    }

    /// A set written there before is not replaced where its folders hold files of others or outlines that were changed
    /// since.
    fn write_watched(&self, out: &Path, watch: &Watch<'_>) -> Result<Written, Error> {
        let begin = Instant::now();
        self.check()?;
        let staging = staged(out, &RESULTS, RECORD, "of a synthetic set")?;
        let replaces = out.join(RECORD).is_file();
        if replaces {
            only_own(self, out)?;
        }
        let (count, stages) = draw_all(self, staging.path(), watch)?;
        staging.commit_exactly(if replaces { &REPLACED } else { &RESULTS })?;
        let total_s = begin.elapsed().as_secs_f64();
        let mut figures = json!({ "options": self, "photographs": count, "stages": stages });
        figures["stages"]["total_s"] = total_s.into();
        Ok(Written { count, figures, total_s, warnings: Vec::new() })
    }
}

fn folder(path: PathBuf) -> Result<PathBuf, Error> {
    fs::create_dir_all(&path).map_err(refused(&path))?;
    Ok(path)
}

/// How many photographs there are, and where the time went.
fn draw_all(options: &PhotoOptions, stage: &Path, watch: &Watch<'_>) -> Result<(usize, Stages), Error> {
    for pose in &options.poses {
        for place in ["photos", "truth/outlines", "truth/normalized"] {
            if options.truth_normalized || !place.ends_with("normalized") {
                folder(stage.join(place).join(pose.name()))?;
            }
        }
    }
    let maps_folder = folder(stage.join("truth/maps"))?;
    let all = options.poses.len() * options.subjects as usize;
    let (mut photographs, mut stages) = (Vec::with_capacity(all), Stages::default());
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
                photographs.push(one.truth);
                stages.draw_s += one.stages.draw_s;
                stages.write_s += one.stages.write_s;
                stages.truth_s += one.stages.truth_s + begin.elapsed().as_secs_f64();
            }
            (watch.tick)(photographs.len() as u64, Some(all as u64));
            watch.go_on()?;
        }
        write_npy(&maps_folder.join(format!("{pose}-mean.npy")), &maps.mean())?;
        write_npy(&maps_folder.join(format!("{pose}-sd.npy")), &maps.sd())?;
        write_npy(&maps_folder.join(format!("{pose}-count.npy")), &maps.count)?;
    }
    write_table(&stage.join("truth/nails.csv"), &photographs)?;
    write_record(&stage.join(RECORD), options)?;
    Ok((all, stages))
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
