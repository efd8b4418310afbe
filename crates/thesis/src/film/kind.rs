//! `film` in a pipeline: a sensor and a camera on one nail; and `rising`: the nail under rising force.

use std::time::Instant;

use serde::Serialize;

use super::rising::rising;
use super::{FilmFigures, Pair, film};
use lunula::job::{
    Demand, Foreseen, Job, Kind, Made, NoOptions, OptionFault, Order, Part, Report, Role, Takes, Work, keys, prepare,
};
use lunula::stages::{Stages, Step};

/// A stage that compares a sensor with a camera.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FilmJob;

impl Job for FilmJob {
    const KIND: Kind = Kind {
        name: "film",
        roles: &[
            Role { name: "sensor", takes: Takes::Many, about: "logs of the sensor, with forces, to train on" },
            Role { name: "camera", takes: Takes::Many, about: "`nailvideo`'s photodiodes of the same recordings" },
            Role { name: "sensor_test", takes: Takes::Many, about: "logs that are held out" },
            Role { name: "camera_test", takes: Takes::Many, about: "`nailvideo`'s photodiodes of those" },
        ],
        parts: &[
            Part { name: "film", file: "", only_if_wanted: false },
            Part { name: "table", file: "film.csv", only_if_wanted: false },
        ],
        revision: 1,
        keys: keys::<NoOptions>,
        prepare: prepare::<Self>,
    };

    type Options = NoOptions;

    fn new(_options: NoOptions) -> Result<Self, OptionFault> {
        Ok(Self)
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let count = |role: &str| inputs.iter().filter(|input| input.role == role).count();
        let of = |role: &str| format!("{} recordings, each worn and filmed", count(role));
        Ok(vec![Step::new("linear models", true, of("sensor")), Step::new("errors", true, of("sensor_test"))])
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        (96_000_000, 0.3 + 0.1 * inputs.len() as f64)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let (start, stages) = (Instant::now(), Stages::default());
        let (training, held_out) = (pairs(work, "sensor", "camera")?, pairs(work, "sensor_test", "camera_test")?);
        let report = work.run(order.said, |watch| -> anyhow::Result<_> {
            let figures: FilmFigures = stages.time("film", || film(&training, &held_out, work.folder))?;
            let mut report = Report::new("film", watch, figures);
            if report.frames_left_out > 0 {
                report.notes.push(format!("{} frames lack a photodiode or a force", report.frames_left_out));
            }
            Ok(report.timed(&stages, start))
        })?;
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
#[derive(Debug, Clone, Copy)]
pub(crate) struct RisingJob;

#[derive(Debug, Serialize)]
struct RisingFigures {
    forces_n: Vec<f64>,
}

impl Job for RisingJob {
    const KIND: Kind = Kind {
        name: "rising",
        roles: &[
            Role { name: "frames", takes: Takes::One, about: "`nailvideo`'s part `frames`" },
            Role { name: "photodiodes", takes: Takes::One, about: "its photodiodes, which have the frames' times" },
            Role { name: "log", takes: Takes::One, about: "the log with Fz_N, on the video's clock" },
        ],
        parts: &[Part { name: "sheet", file: "", only_if_wanted: false }],
        revision: 1,
        keys: keys::<NoOptions>,
        prepare: prepare::<Self>,
    };

    type Options = NoOptions;

    fn new(_options: NoOptions) -> Result<Self, OptionFault> {
        Ok(Self)
    }

    fn steps(&self, _inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(vec![Step::new("sheet", true, "frames near each force, until the greatest".to_owned())])
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (128_000_000, 1.0)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let (start, stages) = (Instant::now(), Stages::default());
        let [frames, photodiodes, log] = ["frames", "photodiodes", "log"].map(|role| work.needed(role));
        let (frames, photodiodes, log) = (&frames?.path, &photodiodes?.path, &log?.path);
        let report = work.run(order.said, |watch| -> anyhow::Result<_> {
            let forces_n = stages.time("sheet", || rising(frames, photodiodes, log, work.folder))?;
            Ok(Report::new("rising", watch, RisingFigures { forces_n }).timed(&stages, start))
        })?;
        Ok(report.made(Vec::new()))
    }
}
