//! A scene to files: frames are drawn in parallel and encoded in order, and everything is put in its place at the end.

use std::fs;
use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::scene::TICKS_PER_S;
use super::{FrameTruth, MarkerStatus, Scene, Siting, VideoOptions};
use crate::files::Staging;
use crate::job::Watch;
use crate::phantom::scene::place::{Error, refused, staged, write_record};
use crate::phantom::scene::reel::draw_and_encode;
use crate::table::{Column, TableWriter, Value};
use crate::video::{Encoder, Encoding, Picture};

/// The file that says that a folder was written here.
const RECORD: &str = "truth/scene.json";
/// Only where there is a clock.
const CLOCK: &str = "truth/clock.csv";
/// The record first: where it stands, what is of one run and what of another is made again.
const RESULTS: [&str; 6] = [RECORD, "video.mp4", "markers.toml", "truth/joints.csv", "truth/tracks.csv", CLOCK];

/// Seconds spent. Drawing and encoding run side by side.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Stages {
    /// Drawing the frames, summed over the threads.
    pub draw_s: f64,
    /// Handing them to the encoder.
    pub encode_s: f64,
    /// Writing what is in `truth`.
    pub truth_s: f64,
    /// From beginning to end.
    pub total_s: f64,
}

/// A video that was written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// Frames.
    pub frames: usize,
    /// From the first frame to the last.
    pub seconds: f64,
    /// Distractors that found a place.
    pub distractors: usize,
    /// Bytes of the video.
    pub bytes: u64,
    /// Where the time went.
    pub stages: Stages,
}

impl VideoOptions {
    /// The files of the video, relative to its folder.
    pub(in crate::phantom) fn files(&self) -> Vec<String> {
        RESULTS.into_iter().filter(|name| self.clock.is_some() || *name != CLOCK).map(str::to_owned).collect()
    }
}

/// Writes `scene` under `out`; a synthetic video written there before is replaced, a log stays.
///
/// # Errors
/// [`Error`]; what stood under `out` before is as it was.
pub fn write(scene: &Scene, out: &Path) -> Result<Summary, Error> {
    write_watched(scene, out, &Watch::nobody())
}

/// As [`write()`], watched: the ticks count frames.
///
/// # Errors
/// [`Error`]; what stood under `out` before is as it was.
pub fn write_watched(scene: &Scene, out: &Path, watch: &Watch<'_>) -> Result<Summary, Error> {
    let begin = Instant::now();
    let staging = staged(out, &RESULTS, RECORD, "a synthetic video's")?;
    let mut summary = write_staged(scene, staging, watch)?;
    summary.stages.total_s = begin.elapsed().as_secs_f64();
    Ok(summary)
}

fn write_staged(scene: &Scene, staging: Staging, watch: &Watch<'_>) -> Result<Summary, Error> {
    let stage = staging.path();
    let truth = stage.join("truth");
    fs::create_dir(&truth).map_err(refused(&truth))?;
    let mut stages = Stages::default();
    let video = stage.join("video.mp4");
    encode(scene, &video, watch, &mut stages)?;
    let start = Instant::now();
    write_truth(scene, &truth)?;
    write_record(&stage.join(RECORD), &record_of(scene))?;
    let markers = stage.join("markers.toml");
    fs::write(&markers, scene.markers_toml()).map_err(refused(&markers))?;
    stages.truth_s = start.elapsed().as_secs_f64();
    let bytes = fs::metadata(&video).map_err(refused(&video))?.len();
    staging.commit_exactly(&RESULTS)?;
    let frames = scene.frames();
    Ok(Summary { frames, seconds: scene.time_s(frames - 1), distractors: scene.distractors.len(), bytes, stages })
}

fn encode(scene: &Scene, path: &Path, watch: &Watch<'_>, stages: &mut Stages) -> Result<(), Error> {
    let options = scene.options();
    let encoding = Encoding {
        matrix: options.matrix,
        chroma_site: options.stated_siting.map(Siting::place),
        turn: options.turn,
        codec: options.codec,
        crf: options.crf,
        preset: options.preset,
        ticks_per_s: TICKS_PER_S,
        ticks_a_picture: (f64::from(TICKS_PER_S) / options.fps).round() as i64,
        ..Encoding::new(options.format())
    };
    let mut encoder = Encoder::create(path, &encoding)?;
    let draw = |frame: usize| {
        let start = Instant::now();
        (scene.picture(frame), start.elapsed().as_secs_f64())
    };
    let encode = |frame: usize, (picture, draw_s): (Picture, f64)| {
        let start = Instant::now();
        encoder.push(&picture, scene.ticks[frame])?;
        stages.encode_s += start.elapsed().as_secs_f64();
        stages.draw_s += draw_s;
        Ok(())
    };
    draw_and_encode(scene.frames(), draw, encode, watch)?;
    let start = Instant::now();
    encoder.finish()?;
    stages.encode_s += start.elapsed().as_secs_f64();
    Ok(())
}

fn word(status: MarkerStatus) -> &'static str {
    match status {
        MarkerStatus::Ok => "ok",
        MarkerStatus::Partial => "partial",
        MarkerStatus::Hidden => "hidden",
        MarkerStatus::Outside => "outside",
    }
}

fn write_truth(scene: &Scene, folder: &Path) -> Result<(), Error> {
    let truths: Vec<FrameTruth> = (0..scene.frames()).into_par_iter().map(|frame| scene.truth(frame)).collect();
    let first = [Column::integer("frame"), Column::number("time_s")];
    let rows = || truths.iter().enumerate().map(|(frame, truth)| (Value::Integer(frame as i64), truth));

    let layout = scene.options().finger.layout;
    let angles: Vec<Column> =
        layout.joints().into_iter().map(|(joint, _)| Column::number(format!("{joint}_deg"))).collect();
    let mut joints = start(folder, "joints.csv", &[&first[..], &[Column::number("clock_s")], &angles].concat())?;
    for (frame, truth) in rows() {
        let mut row = vec![frame, Value::Number(truth.time_s), truth.clock_s.into()];
        row.extend(truth.angles_rad.iter().map(|angle| Value::Number(angle.to_degrees())));
        joints.write(&row)?;
    }
    joints.finish()?;

    let [x, y, in_view] = ["x_px", "y_px", "in_view"].map(Column::number);
    let [marker, status] = ["marker", "status"].map(Column::text);
    let seen = if layout.painted() { vec!["seen_x_px", "seen_y_px"] } else { Vec::new() };
    let seen: Vec<Column> = seen.into_iter().map(Column::number).collect();
    let mut tracks = start(folder, "tracks.csv", &[&first[..], &[marker, x, y, in_view, status], &seen].concat())?;
    for (frame, truth) in rows() {
        for (marker, seen) in scene.markers().iter().zip(&truth.markers) {
            let [x, y] = seen.at_px.map(Value::Number);
            let (in_view, status) = (Value::Number(seen.in_view), word(seen.status).into());
            let mut row = vec![frame, Value::Number(truth.time_s), marker.name[..].into(), x, y, in_view, status];
            if layout.painted() {
                row.extend([0, 1].map(|axis| Value::from(seen.seen_px.map(|at| at[axis]))));
            }
            tracks.write(&row)?;
        }
    }
    tracks.finish()?;

    let Some(clock) = &scene.options().clock else { return Ok(()) };
    let [clock_s, shown_s] = ["clock_s", "shown_s"].map(Column::number);
    let more = [clock_s, Column::text("shown"), shown_s, Column::integer("changing"), Column::text("status")];
    let mut shows = start(folder, "clock.csv", &[&first[..], &more].concat())?;
    let late_s = scene.clock_late_s(clock);
    let half_s = 0.5 * scene.options().blur / scene.options().fps;
    for (at, (frame, truth)) in rows().enumerate() {
        let taken_s = truth.time_s + late_s;
        let (shown, shown_s) = clock.shown(taken_s);
        let changing = clock.shown(taken_s - half_s).0 != clock.shown(taken_s + half_s).0;
        let status = match clock {
            _ if scene.clock_hidden(at) => "hidden",
            _ if clock.stop_s.is_some_and(|stop_s| truth.time_s >= stop_s) => "stopped",
            _ if clock.jump.is_some_and(|jump| truth.time_s >= jump.at_s) => "jumped",
            _ => "ok",
        };
        let (shown, shown_s) = (Value::Text(&shown), Value::Number(shown_s));
        let changing = Value::Integer(i64::from(changing));
        let (time_s, clock_s) = (Value::Number(truth.time_s), truth.clock_s.into());
        shows.write(&[frame, time_s, clock_s, shown, shown_s, changing, status.into()])?;
    }
    Ok(shows.finish()?)
}

fn start(folder: &Path, name: &str, columns: &[Column]) -> Result<TableWriter, Error> {
    let path = folder.join(name);
    Ok(TableWriter::create(&path, &path, columns.to_vec(), &[])?)
}

fn record_of(scene: &Scene) -> serde_json::Value {
    serde_json::json!({
        "options": scene.options(),
        "frames": scene.frames(),
        "ticks_per_s": TICKS_PER_S,
        "markers": scene.markers(),
        "distractors": scene.distractors,
    })
}
