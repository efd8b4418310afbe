//! One nail, worn and filmed: what photodiodes on it and a camera over it see, and how well each predicts force (2.3,
//! 2.4, 7.2); and the nail under rising force (Fig. 5).
//!
//! In, of one person: recordings that were filmed while the sensor was worn, each a log of the sensor with forces and
//! the camera photodiodes that `lunula nailvideo` made of its video, at the same places; the log's clock is the
//! video's. Some recordings are trained on, others are held out. Out, in a folder: `film.csv`, for each force the RMSE
//! of a linear model of the sensor and of one of the camera on the recordings held out, and their ratio; `traces`, both
//! over each other; `rmse`, the errors as bars; `labelled/`, the camera's sets with the forces; `numbers.json`.
//!
//! The camera's rows are its frames, with the force at their time; the sensor's are its samples. A frame in which any
//! photodiode is missing is no row, and counted. What is not determined: the delay between log and video.

mod draw;
mod kind;
mod pair;
mod rising;
#[cfg(test)]
pub(crate) mod tests;

use std::path::{Path, PathBuf};

use anyhow::Context;
use lunula_predictor::{FORCES, Kind, Predictor, Recipe};
use serde::Serialize;

use crate::Numbers;
use crate::compare::rmse;
pub(crate) use kind::{FilmJob, RisingJob};
use lunula::files::Staging;
use lunula::predictor::{Wanted, read_data};
use lunula::table::{Column, TableWriter, Value};
use pair::{Pair, Traces};
#[cfg(test)]
pub(crate) use rising::rising;

/// The errors of one force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Errors {
    /// `Fx_N`.
    pub(crate) target: String,
    /// RMSE of the sensor's model on what is held out, N.
    pub(crate) sensor: f64,
    /// Of the camera's model.
    pub(crate) camera: f64,
}

/// What came out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct FilmFigures {
    /// By force.
    pub(crate) errors: Vec<Errors>,
    /// Of each photodiode held out: correlation of the sensor's volts with the camera's values.
    pub(crate) correlations: Vec<(String, Option<f64>)>,
    /// Frames without all photodiodes, which are no rows.
    pub(crate) frames_left_out: usize,
}

impl FilmFigures {
    /// For the page.
    fn numbers(&self) -> Numbers {
        let mut numbers = Numbers::default();
        for Errors { target, sensor, camera } in &self.errors {
            numbers.set(format!("{target}.sensor_rmse"), *sensor);
            numbers.set(format!("{target}.camera_rmse"), *camera);
            numbers.set(format!("{target}.camera_over_sensor"), camera / sensor);
        }
        for (name, correlation) in &self.correlations {
            numbers.set(format!("{name}.correlation"), *correlation);
        }
        let known = self.correlations.iter().map(|(_, correlation)| *correlation);
        let least = known.reduce(|a, b| Some(a?.min(b?))).flatten();
        numbers.set("least_correlation", least);
        numbers
    }
}

/// Trains on some recordings, judges on others; the results go into `out`.
///
/// # Errors
/// A file that can't be read, rows that determine no model, a folder that can't be written to.
pub(crate) fn film(training: &[Pair], held_out: &[Pair], out: &Path) -> anyhow::Result<FilmFigures> {
    let staging = Staging::new(out)?;
    let mut left_out = 0;
    let mut label = |pairs: &[Pair], of: &str| -> anyhow::Result<Vec<PathBuf>> {
        let one = |(k, pair): (usize, &Pair)| {
            let path = staging.place(&format!("labelled/{of}-{}.csv", k + 1))?;
            left_out += pair.label(&path)?;
            Ok(path)
        };
        pairs.iter().enumerate().map(one).collect()
    };
    let camera = [label(training, "training")?, label(held_out, "held-out")?];
    let sensor = [training, held_out].map(|pairs| pairs.iter().map(|pair| pair.log.clone()).collect::<Vec<_>>());
    let (of_sensor, of_camera) = (errors(&sensor).context("the sensor")?, errors(&camera).context("the camera")?);
    let of = |(target, (sensor, camera)): (&&str, (f64, f64))| Errors { target: (*target).to_owned(), sensor, camera };
    let found = FORCES.iter().zip(of_sensor.into_iter().zip(of_camera)).map(of).collect();
    let first = held_out.first().context("no recording is held out")?;
    let traces = Traces::of(first)?;
    let figures = FilmFigures { errors: found, correlations: traces.correlations(), frames_left_out: left_out };
    table(&figures, &staging, out)?;
    draw::traces(&traces, &staging)?;
    draw::errors(&figures.errors, &staging)?;
    staging.write("numbers.json", figures.numbers().to_text().as_bytes())?;
    staging.commit()?;
    Ok(figures)
}

/// RMSE of each force on the second files, of a linear model of the first.
fn errors([training, held_out]: &[Vec<PathBuf>; 2]) -> anyhow::Result<Vec<f64>> {
    let wanted = Wanted { targets: FORCES.map(str::to_owned).to_vec(), ..Wanted::default() };
    let fitted = Predictor::fit(&read_data(training, &wanted)?.data, None, &Recipe::new(Kind::Linear))?;
    let all = rmse(Some(&fitted), &read_data(held_out, &wanted)?.data)?;
    all.into_iter().map(|one| one.context("no row is held out")).collect()
}

fn table(figures: &FilmFigures, staging: &Staging, out: &Path) -> anyhow::Result<()> {
    let name = "film.csv";
    let mut columns = vec![Column::text("target")];
    columns.extend(["sensor_rmse_N", "camera_rmse_N", "camera_over_sensor"].map(Column::number));
    let mut table = TableWriter::create(&staging.place(name)?, &out.join(name), columns, &[])?;
    for Errors { target, sensor, camera } in &figures.errors {
        let numbers = [*sensor, *camera, camera / sensor].map(Value::Number);
        table.write(&[&[Value::Text(target)], &numbers[..]].concat())?;
    }
    Ok(table.finish()?)
}
