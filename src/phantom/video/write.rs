//! A scene to files: frames are drawn in parallel and encoded in order, and everything is put in its place at the end.

use std::fs;
use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use serde_json::json;

use super::{Faults, FrameTruth, MarkerStatus, Scene, Siting, VideoOptions};
use crate::job::{Facts, Watch};
use crate::phantom::scene::place::{Error, refused, staged, write_record};
use crate::phantom::scene::recording::{Cost, Generated, Written, sorted};
use crate::phantom::scene::reel::{TICKS_PER_S, film};
use crate::table::{Column, TableWriter, Value};
use crate::video::Encoding;

/// The file that says that a folder was written here.
const RECORD: &str = "truth/scene.json";
/// Only where there is a clock.
const CLOCK: &str = "truth/clock.csv";
/// The record first: where it stands, what is of one run and what of another is made again.
const RESULTS: [&str; 6] = [RECORD, "video.mp4", "markers.toml", "truth/joints.csv", "truth/tracks.csv", CLOCK];

/// Seconds on one thread a pixel of a frame; measured with a release build on a Xeon of 2.1 GHz.
const FRAME_S_PER_PX: f64 = 3.5e-8;

impl Generated for VideoOptions {
    fn check(&self) -> Result<(), Faults> {
        self.check()
    }

    fn options(&self) -> serde_json::Value {
        json!({ "video": self })
    }

    fn files(&self) -> Vec<String> {
        sorted(RESULTS.into_iter().filter(|name| self.clock.is_some() || *name != CLOCK))
    }

    fn facts(&self, file: &str) -> Facts {
        let clock = Some(self.clock.is_some());
        match file {
            "video.mp4" | "markers.toml" => {
                let distorted = Some(self.lens.is_some() || self.plane.is_some());
                Facts { clock, distorted, ..Facts::default() }
            }
            "truth/joints.csv" => Facts { clock, ..Facts::default() },
            _ => Facts::default(),
        }
    }

    fn cost(&self) -> Cost {
        Cost::of_pictures([self.width as f64, self.height as f64], self.frames() as f64, FRAME_S_PER_PX)
    }

    fn write_watched(&self, folder: &Path, watch: &Watch<'_>) -> Result<Written, Error> {
        let scene = Scene::new(self.clone())?;
        let begin = Instant::now();
        let staging = staged(folder, &RESULTS, RECORD, "a synthetic video's")?;
        let stage = staging.path();
        let video = stage.join("video.mp4");
        let encoding = Encoding {
            matrix: self.matrix,
            chroma_site: self.stated_siting.map(Siting::place),
            turn: self.turn,
            codec: self.codec,
            crf: self.crf,
            preset: self.preset,
            ..Encoding::new(self.format())
        };
        let (draw, ticks) = (|frame: usize| scene.picture(frame), |frame: usize| scene.ticks[frame]);
        let [draw_s, encode_s] = film(&video, (encoding, self.fps), scene.frames(), draw, ticks, watch)?;
        let start = Instant::now();
        write_truth(&scene, &stage.join("truth"))?;
        write_record(&stage.join(RECORD), &record_of(&scene))?;
        let markers = stage.join("markers.toml");
        fs::write(&markers, scene.markers_toml()).map_err(refused(&markers))?;
        let truth_s = start.elapsed().as_secs_f64();
        let bytes = fs::metadata(&video).map_err(refused(&video))?.len();
        staging.commit_exactly(&RESULTS)?;
        let total_s = begin.elapsed().as_secs_f64();
        let (frames, placed, wanted) = (scene.frames(), scene.distractors.len(), self.distractors);
        let fewer = (placed < wanted)
            .then(|| format!("only {placed} of {wanted} distractors found a place apart from the finger"));
        let figures = json!({
            "options": scene.options(),
            "frames": frames,
            "seconds": scene.time_s(frames - 1),
            "bytes": bytes,
            "stages": { "draw_s": draw_s, "encode_s": encode_s, "truth_s": truth_s, "total_s": total_s },
        });
        Ok(Written { count: frames, figures, total_s, warnings: fewer.into_iter().collect() })
    }
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
    json!({
        "options": scene.options(),
        "frames": scene.frames(),
        "ticks_per_s": TICKS_PER_S,
        "markers": scene.markers(),
        "distractors": scene.distractors,
    })
}
