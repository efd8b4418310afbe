//! The scenes that jobs are measured on where the user has none: generated, with exact truth. In a hurry smaller ones.

use std::path::{Path, PathBuf};

use anyhow::Context;

use crate::phantom::Generated as _;
use crate::phantom::log::{LogOptions, Protocol};
use crate::phantom::nail::Pose;
use crate::phantom::photos::PhotoOptions;
use crate::phantom::screen::Clock;
use crate::phantom::trajectory::Trajectory;
use crate::phantom::video::VideoOptions;
use crate::tradeoff::measure::plan::Plan;
use crate::tradeoff::predictor::switch;
use crate::tradeoff::{align, photos, posture, predictor};

const POSES: [Pose; 4] = [Pose::Nominal, Pose::Normal, Pose::LateralPositive, Pose::Extension];
/// Width and height of photographs of nails of 20 to 30 px.
const SMALL: (u32, u32) = (64, 48);

/// Photographs, and small ones.
pub(in crate::tradeoff) fn photos(plan: &Plan, folder: &Path) -> anyhow::Result<photos::Settings> {
    let options =
        PhotoOptions { seed: plan.seed, subjects: plan.subjects, poses: POSES.to_vec(), ..PhotoOptions::default() };
    options.write(folder)?;
    let small = folder.join("small");
    PhotoOptions { width: SMALL.0, height: SMALL.1, ..options }.write(&small)?;
    Ok(photos::Settings {
        set: folder.join("photos"),
        truth: folder.join("truth"),
        small: Some((small.join("photos"), small.join("truth"))),
        effort: plan.effort.clone(),
    })
}

/// How long the video of the plan's preset is.
pub(in crate::tradeoff) fn seconds(plan: &Plan) -> f64 {
    let whole = VideoOptions::new(plan.preset).seconds;
    if plan.effort.quick { 0.2 * whole } else { whole }
}

/// That video.
pub(in crate::tradeoff) fn posture(plan: &Plan, folder: &Path) -> anyhow::Result<posture::Settings> {
    let options = VideoOptions { seed: plan.seed, seconds: seconds(plan), ..VideoOptions::new(plan.preset) };
    options.write(folder)?;
    Ok(posture_of(folder, folder.join("truth"), plan))
}

/// A folder with `video.mp4` and `markers.toml`.
pub(in crate::tradeoff) fn posture_of(folder: &Path, truth: PathBuf, plan: &Plan) -> posture::Settings {
    let [video, markers] = ["video.mp4", "markers.toml"].map(|name| folder.join(name));
    posture::Settings { video, markers, truth, effort: plan.effort.clone() }
}

/// A video with a clock and irregular frames, and a log, of random movement.
pub(in crate::tradeoff) fn align(plan: &Plan, folder: &Path) -> anyhow::Result<align::Settings> {
    let Plan { seed, seconds, .. } = *plan;
    let (clock, trajectory) = (Clock::default(), Trajectory::Random { hz: 0.1, seed });
    let log = LogOptions {
        seed,
        seconds,
        trajectory: trajectory.clone(),
        clock_offset_s: clock.offset_s,
        ..LogOptions::default()
    };
    let video =
        VideoOptions { seed, seconds, trajectory, jitter: 0.4, clock: Some(clock), ..VideoOptions::sized(640, 360) };
    video.write(folder)?;
    log.write(folder)?;
    Ok(align_of(folder, folder.join("truth"), plan))
}

/// A folder with `video.mp4`, `markers.toml` and `log.csv`.
pub(in crate::tradeoff) fn align_of(folder: &Path, truth: PathBuf, plan: &Plan) -> align::Settings {
    let [video, markers, log] = ["video.mp4", "markers.toml", "log.csv"].map(|name| folder.join(name));
    align::Settings { video, markers, log, truth, effort: plan.effort.clone() }
}

/// Two spirals to train on, and random movement to tell the error on.
pub(in crate::tradeoff) fn predictor(plan: &Plan, folder: &Path) -> anyhow::Result<predictor::Settings> {
    let seed = plan.seed.wrapping_mul(3);
    let scenes =
        [("train/1", Protocol::Touch, 0), ("train/2", Protocol::Touch, 1), ("truth/1", Protocol::TouchRandom, 2)];
    for (name, protocol, next) in scenes {
        LogOptions::of(protocol, seed.wrapping_add(next)).write(&folder.join(name))?;
    }
    predictor_of(&folder.join("train"), &folder.join("truth"), plan)
}

/// Folders of recordings.
pub(in crate::tradeoff) fn predictor_of(train: &Path, test: &Path, plan: &Plan) -> anyhow::Result<predictor::Settings> {
    Ok(predictor::Settings { train: recordings(train)?, test: recordings(test)?, effort: plan.effort.clone() })
}

/// Presses and rest of one sensor: a recording of each to train on, four of each to choose thresholds by and to judge.
pub(in crate::tradeoff) fn switch(plan: &Plan, folder: &Path) -> anyhow::Result<switch::Settings> {
    let share = if plan.effort.quick { 0.25 } else { 1.0 };
    let mut seed = plan.seed.wrapping_mul(10);
    for (name, pairs) in [("train", 1), ("test", 4)] {
        for pair in 1..=pairs {
            for (protocol, kind, seconds) in [(Protocol::Contacts, "press", 600.0), (Protocol::Rest, "rest", 3600.0)] {
                seed = seed.wrapping_add(1);
                let options = LogOptions { seconds: share * seconds, contact: true, ..LogOptions::of(protocol, seed) };
                options.write(&folder.join(format!("{name}/{pair}-{kind}")))?;
            }
        }
    }
    switch_of(&folder.join("train"), &folder.join("test"), plan)
}

/// Folders of recordings; of those to be judged on, the first half by name chooses thresholds.
pub(in crate::tradeoff) fn switch_of(train: &Path, test: &Path, plan: &Plan) -> anyhow::Result<switch::Settings> {
    let mut choose = recordings(test)?;
    anyhow::ensure!(choose.len() > 1, "{}: one recording can't choose thresholds and judge them", test.display());
    let judge = choose.split_off(choose.len() / 2);
    Ok(switch::Settings { train: recordings(train)?, choose, judge, effort: plan.effort.clone() })
}

/// The tables and logs of a folder, and the logs of its folders, by name.
fn recordings(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for path in crate::input::list(folder).with_context(|| folder.display().to_string())? {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        if path.join("log.csv").is_file() {
            found.push(path.join("log.csv"));
        } else if path.is_file() && ["csv", "parquet", "gz"].contains(&ending) {
            found.push(path);
        }
    }
    anyhow::ensure!(!found.is_empty(), "{}: holds no recordings (.csv, .parquet)", folder.display());
    Ok(found)
}
