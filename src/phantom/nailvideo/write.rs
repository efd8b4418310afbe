//! A scene to files: frames are drawn in parallel and encoded in order, and everything is put in its place at the end.

use std::fs;
use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use serde_json::json;

use super::{Faults, FrameTruth, NailVideoOptions, Scene};
use crate::job::{Facts, Watch};
use crate::phantom::log::{S_PER_MS, write_rows};
use crate::phantom::photos::{annotation, write_npy};
use crate::phantom::scene::place::{Error, refused, staged, write_record};
use crate::phantom::scene::recording::{Cost, Generated, Written, sorted};
use crate::phantom::scene::reel::{TICKS_PER_S, film};
use crate::phantom::sensor::disc_samples;
use crate::phantom::video::Siting;
use crate::table::{Column, TableWriter, Value};
use crate::video::Encoding;

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

/// Seconds on one thread a pixel of a frame; measured with a development build, 12 s of 640x480.
const FRAME_S_PER_PX: f64 = 1.2e-7;

impl NailVideoOptions {
    /// The frames whose normalized picture is written.
    fn normalized_frames(&self) -> impl Iterator<Item = usize> {
        let every = self.normalized_every;
        (0..self.frames()).filter(move |frame| every.is_some_and(|every| frame.is_multiple_of(every)))
    }
}

impl Generated for NailVideoOptions {
    fn check(&self) -> Result<(), Faults> {
        self.check()
    }

    fn options(&self) -> serde_json::Value {
        json!({ "nailvideo": self })
    }

    fn files(&self) -> Vec<String> {
        let always = RESULTS.into_iter().filter(|name| *name != NORMALIZED).map(str::to_owned);
        sorted(always.chain(self.normalized_frames().map(|frame| format!("{NORMALIZED}/{frame:06}.npy"))))
    }

    fn facts(&self, file: &str) -> Facts {
        if file == "log.csv" {
            Facts { led: Some(false), forces: Some(true), ..Facts::default() }
        } else {
            Facts::default()
        }
    }

    fn cost(&self) -> Cost {
        let size = [self.size.0, self.size.1].map(f64::from);
        let Cost { memory, seconds } = Cost::of_pictures(size, self.frames() as f64, FRAME_S_PER_PX);
        Cost { memory, seconds: seconds + S_PER_MS * 1e3 * (self.seconds() + 10.0) }
    }

    fn write_watched(&self, folder: &Path, watch: &Watch<'_>) -> Result<Written, Error> {
        let scene = Scene::new(self.clone())?;
        let begin = Instant::now();
        let staging = staged(folder, &RESULTS, RECORD, "a synthetic nail video's")?;
        let [record, video, outline, positions, log, true_log, frames, presses, normalized] =
            RESULTS.map(|name| staging.path().join(name));
        let usual = Encoding::new(self.format());
        let encoding = Encoding {
            matrix: self.coding.matrix(),
            chroma_site: Some(Siting::Left.place()),
            codec: self.coding.codec,
            crf: self.crf,
            preset: self.coding.known_preset().unwrap_or(usual.preset),
            ..usual
        };
        let (draw, ticks) = (|frame: usize| scene.picture(frame), |frame: usize| self.ticks(frame));
        film(&video, (encoding, self.fps), scene.frames(), draw, ticks, watch)?;
        annotation(&scene.nail, "video.mp4")?.write(&outline)?;
        let text =
            toml::to_string(&scene.positions).map_err(|error| refused(&positions)(std::io::Error::other(error)))?;
        fs::write(&positions, text).map_err(refused(&positions))?;
        let [log_rows, _] = write_rows(&scene.log, &log, &true_log)?;
        let gone = write_frames(&scene, &frames)?;
        write_presses(self, &presses)?;
        write_record(&record, &record_of(&scene))?;
        write_normalized(&scene, &normalized)?;
        let bytes = fs::metadata(&video).map_err(refused(&video))?.len();
        staging.commit_exactly(&RESULTS)?;
        let (count, total_s) = (scene.frames(), begin.elapsed().as_secs_f64());
        let figures = json!({
            "options": self,
            "frames": count,
            "gone": gone,
            "log_rows": log_rows,
            "bytes": bytes,
            "total_s": total_s,
        });
        Ok(Written { count, figures, total_s, warnings: Vec::new() })
    }
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
    json!({
        "options": scene.options(),
        "frames": scene.frames(),
        "ticks_per_s": TICKS_PER_S,
        "positions": scene.positions(),
        "nail_width_px": scene.nail().width_px(),
        "nail_length_px": scene.nail().length_px(),
        "log": scene.log.options(),
    })
}
