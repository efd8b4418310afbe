//! A scene to files: frames are drawn in parallel and encoded in order, and everything is put in its place at the end.

use std::fs;
use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::{FrameTruth, NailVideoOptions, Scene};
use crate::job::Watch;
use crate::phantom::log::write_rows;
use crate::phantom::photos::{annotation, write_npy};
use crate::phantom::scene::place::{Error, refused, staged, write_record};
use crate::phantom::scene::reel::draw_and_encode;
use crate::phantom::sensor::disc_samples;
use crate::phantom::video::{Siting, TICKS_PER_S};
use crate::table::{Column, TableWriter, Value};
use crate::video::{Encoder, Encoding, Picture};

/// The file that says that a folder was written here.
const RECORD: &str = "truth/nailvideo.json";
/// The folder of exact normalized pictures, with `--normalized`: their side, and over the nail's, as of photographs.
const NORMALIZED: &str = "truth/normalized";
const NORMALIZED_SIDE: (usize, f64) = (400, 1.25);
/// The record first: where it exists, what is of one run and what of another is made again.
const RESULTS: [&str; 9] = [
    RECORD,
    "video.mp4",
    "outline.json",
    "positions.toml",
    "log.csv",
    "truth/log.csv",
    "truth/frames.csv",
    "truth/presses.csv",
    NORMALIZED,
];

/// A video that was written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// Frames.
    pub frames: usize,
    /// Frames without the nail.
    pub gone: usize,
    /// Rows of the log.
    pub log_rows: usize,
    /// Bytes of the video.
    pub bytes: u64,
    /// From beginning to end, seconds.
    pub total_s: f64,
}

impl NailVideoOptions {
    /// The files of the video, relative to its folder.
    pub(in crate::phantom) fn files(&self) -> Vec<String> {
        let mut files: Vec<String> =
            RESULTS.iter().filter(|name| **name != NORMALIZED).map(|&n| n.to_owned()).collect();
        files.extend(self.normalized_frames().map(|frame| format!("{NORMALIZED}/{frame:06}.npy")));
        files
    }

    /// The frames whose normalized picture is written.
    fn normalized_frames(&self) -> impl Iterator<Item = usize> {
        let every = self.normalized_every;
        (0..self.frames()).filter(move |frame| every.is_some_and(|every| frame.is_multiple_of(every)))
    }
}

/// Writes `scene` under `out`; a synthetic nail video written there before is replaced.
///
/// # Errors
/// [`Error`]; what was under `out` before is as it was.
pub fn write(scene: &Scene, out: &Path) -> Result<Summary, Error> {
    write_watched(scene, out, &Watch::nobody())
}

/// As [`write()`], watched: the ticks count frames.
///
/// # Errors
/// [`Error`]; what was under `out` before is as it was.
pub fn write_watched(scene: &Scene, out: &Path, watch: &Watch<'_>) -> Result<Summary, Error> {
    let begin = Instant::now();
    let staging = staged(out, &RESULTS, RECORD, "a synthetic nail video's")?;
    let truth = staging.path().join("truth");
    fs::create_dir(&truth).map_err(refused(&truth))?;
    let [record, video, outline, positions, log, true_log, frames, presses, normalized] =
        RESULTS.map(|name| staging.path().join(name));
    encode(scene, &video, watch)?;
    annotation(&scene.nail, "video.mp4")?.write(&outline)?;
    let text = toml::to_string(&scene.positions).map_err(|error| refused(&positions)(std::io::Error::other(error)))?;
    fs::write(&positions, text).map_err(refused(&positions))?;
    let [log_rows, _] = write_rows(&scene.log, &log, &true_log)?;
    let gone = write_frames(scene, &frames)?;
    write_presses(scene.options(), &presses)?;
    write_record(&record, &record_of(scene))?;
    write_normalized(scene, &normalized)?;
    let bytes = fs::metadata(&video).map_err(refused(&video))?.len();
    staging.commit_exactly(&RESULTS)?;
    Ok(Summary { frames: scene.frames(), gone, log_rows, bytes, total_s: begin.elapsed().as_secs_f64() })
}

fn encode(scene: &Scene, path: &Path, watch: &Watch<'_>) -> Result<(), Error> {
    let options = scene.options();
    let usual = Encoding::new(options.format());
    let encoding = Encoding {
        matrix: options.coding.matrix(),
        chroma_site: Some(Siting::Left.place()),
        codec: options.coding.codec,
        crf: options.crf,
        preset: options.coding.known_preset().unwrap_or(usual.preset),
        ticks_per_s: TICKS_PER_S,
        ticks_a_picture: (f64::from(TICKS_PER_S) / options.fps).round() as i64,
        ..usual
    };
    let mut encoder = Encoder::create(path, &encoding)?;
    let encode = |frame: usize, picture: Picture| encoder.push(&picture, options.ticks(frame));
    draw_and_encode(scene.frames(), |frame| scene.picture(frame), encode, watch)?;
    Ok(encoder.finish()?)
}

/// Writes the table of the frames; returns how many are without the nail.
fn write_frames(scene: &Scene, path: &Path) -> Result<usize, Error> {
    let samples = disc_samples();
    let truths: Vec<FrameTruth> =
        (0..scene.frames()).into_par_iter().map(|frame| scene.truth_of(frame, &samples)).collect();
    let named = |suffix: &str| -> Vec<Column> {
        let photodiodes = scene.positions.photodiodes.iter();
        photodiodes.map(|place| Column::number(format!("{}{suffix}", place.name))).collect()
    };
    let mut columns = vec![Column::integer("frame"), Column::number("time_s")];
    columns.extend(["a", "b", "c", "d", "e", "f", "Fx_N", "Fy_N", "Fz_N", "J2_deg"].map(Column::number));
    columns.extend(["", "_hidden"].into_iter().flat_map(named));
    columns.push(Column::text("status"));
    columns.extend(["_red", "_blue"].into_iter().flat_map(named));
    columns.extend(["light_red", "light_green", "light_blue"].map(Column::number));
    let mut table = TableWriter::create(path, path, columns, &[])?;
    for (frame, truth) in truths.iter().enumerate() {
        let mut cells = vec![Value::Integer(frame as i64), Value::Number(truth.time_s)];
        match truth.motion {
            Some(motion) => cells.extend(motion.0.map(Value::Number)),
            None => cells.extend([Value::Missing; 6]),
        }
        cells.extend(truth.touch.forces_n.map(Value::Number));
        cells.push(Value::Number(truth.touch.angles_rad[1].to_degrees()));
        cells.extend(truth.photodiodes.iter().map(|colour| Value::Number(colour[1])));
        cells.extend(truth.hidden.iter().copied().map(Value::Number));
        cells.push(Value::Text(if truth.gone { "gone" } else { "ok" }));
        for channel in [0, 2] {
            cells.extend(truth.photodiodes.iter().map(|colour| Value::Number(colour[channel])));
        }
        cells.extend(truth.light.map(Value::Number));
        table.write(&cells)?;
    }
    table.finish()?;
    Ok(truths.iter().filter(|truth| truth.gone).count())
}

fn write_presses(options: &NailVideoOptions, path: &Path) -> Result<(), Error> {
    let mut columns = vec![Column::integer("press")];
    columns.extend(["onset_s", "release_s", "peak_N"].map(Column::number));
    let mut table = TableWriter::create(path, path, columns, &[])?;
    let end_s = options.frames() as f64 / options.fps;
    for (number, press) in options.presses().iter().flat_map(|presses| presses.until(end_s)).enumerate() {
        let times = [press.onset_s, press.release_s].map(Value::Number);
        let [onset_s, release_s] = times;
        table.write(&[Value::Integer(number as i64 + 1), onset_s, release_s, Value::Number(options.press_n)])?;
    }
    Ok(table.finish()?)
}

/// Writes the exact normalized pictures, in the first light.
fn write_normalized(scene: &Scene, folder: &Path) -> Result<(), Error> {
    let frames: Vec<usize> = scene.options().normalized_frames().collect();
    if frames.is_empty() {
        return Ok(());
    }
    fs::create_dir(folder).map_err(refused(folder))?;
    let (side, margin) = NORMALIZED_SIDE;
    frames.into_par_iter().try_for_each(|frame| {
        let field = scene.nail.field().at_moment(scene.weights(frame));
        write_npy(&folder.join(format!("{frame:06}.npy")), &scene.nail.normalized_of(&field, side, margin))
    })
}

fn record_of(scene: &Scene) -> serde_json::Value {
    serde_json::json!({
        "options": scene.options(),
        "frames": scene.frames(),
        "ticks_per_s": TICKS_PER_S,
        "positions": scene.positions(),
        "nail_width_px": scene.nail().width_px(),
        "nail_length_px": scene.nail().length_px(),
        "log": scene.log.options(),
    })
}
