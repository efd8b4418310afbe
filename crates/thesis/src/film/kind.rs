//! `film` in a pipeline: a sensor and a camera on one nail; and `rising`: the nail under rising force.

use clap::Args;
use serde::Serialize;

use super::rising::rising;
use super::{FilmFigures, Pair, film};
use lunula::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Role, Takes, Work};
use lunula::stages::Step;

/// A stage that compares a sensor with a camera.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct FilmJob {}

impl Job for FilmJob {
    const KIND: Kind = Kind::of::<Self>(
        "film",
        &[
            Role::new("sensor", Takes::Many, "logs of the sensor, with forces, to train on"),
            Role::new("camera", Takes::Many, "`nailvideo`'s photodiodes of the same recordings"),
            Role::new("sensor_test", Takes::Many, "logs that are held out"),
            Role::new("camera_test", Takes::Many, "`nailvideo`'s photodiodes of those"),
        ],
        &[Part::new("film", ""), Part::new("table", "film.csv")],
    );

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let count = |role: &str| inputs.iter().filter(|input| input.role == role).count();
        let of = |role: &str| format!("{} recordings, each worn and filmed", count(role));
        Ok(vec![Step::new("linear models", true, of("sensor")), Step::new("errors", true, of("sensor_test"))])
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        (96_000_000, 0.3 + 0.1 * inputs.len() as f64)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let (training, held_out) = (pairs(work, "sensor", "camera")?, pairs(work, "sensor_test", "camera_test")?);
        let figures = || film(&training, &held_out, work.folder);
        let mut report = work.report::<Self, FilmFigures>(order.said, "film", figures)?;
        if report.frames_left_out > 0 {
            report.notes.push(format!("{} frames lack a photodiode or a force", report.frames_left_out));
        }
        Ok(report.made(Vec::new()))
    }
}

/// Logs and videos of the same keys.
fn pairs(work: &Work<'_>, sensor: &str, camera: &str) -> anyhow::Result<Vec<Pair>> {
    let of = |log: &lunula::job::At| {
        let mut own = work.of(camera).filter(|at| at.keys == log.keys);
        match (own.next(), own.next()) {
            (Some(at), None) => Ok(Pair { log: log.path.clone(), camera: at.path.clone() }),
            (first, _) => {
                let found = if first.is_some() { "several" } else { "none" };
                anyhow::bail!("{}: of `{camera}`, {found} has its keys; name one video for each log", log.name)
            }
        }
    };
    work.of(sensor).map(of).collect()
}

/// A stage that shows a nail under rising force.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct RisingJob {}

#[derive(Debug, Serialize)]
struct RisingFigures {
    forces_n: Vec<f64>,
}

impl Job for RisingJob {
    const KIND: Kind = Kind::of::<Self>(
        "rising",
        &[
            Role::new("frames", Takes::One, "`nailvideo`'s part `frames`"),
            Role::new("photodiodes", Takes::One, "its photodiodes, which have the frames' times"),
            Role::new("log", Takes::One, "the log with Fz_N, on the video's clock"),
        ],
        &[Part::new("sheet", "")],
    );

    fn steps(&self, _inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(vec![Step::new("sheet", true, "frames near each force, until the greatest".to_owned())])
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (128_000_000, 1.0)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let [frames, photodiodes, log] = ["frames", "photodiodes", "log"].map(|role| work.needed(role));
        let (frames, photodiodes, log) = (&frames?.path, &photodiodes?.path, &log?.path);
        let figures = || Ok(RisingFigures { forces_n: rising(frames, photodiodes, log, work.folder)? });
        let report = work.report::<Self, _>(order.said, "sheet", figures)?;
        Ok(report.made(Vec::new()))
    }
}
