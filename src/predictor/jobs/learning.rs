//! The error on validation recordings against how much was trained on (Fig. 105 to 107: one set, the other, both).
//!
//! In: the recordings trained on, in order, those reported on, and those on which a network stops early. Out: a table
//! and a picture: the first recording, the first two, .. all; and the first tenths of the time of each, as shorter
//! calibrations would have given.

use std::path::{Path, PathBuf};

use lunula_predictor::{
    Dataset, LearningPoint, Model, Recipe, learn_by_recordings, learn_by_share, predict, with_lags,
};

use crate::figure::draw_charts;
use crate::files::{Places, WriteError};
use crate::predictor::error::PredictorError;
use crate::predictor::figures::{LearningSeries, WIDTH, learning_curve};
use crate::table::{Column, TableWriter, Value};

const SHARES: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];

/// Errors over amounts of training data.
#[derive(Debug)]
pub(in crate::predictor) struct Points {
    targets: Vec<String>,
    by_share: Vec<LearningPoint>,
    by_recordings: Vec<LearningPoint>,
}

/// Fits the recipe to each amount; a network stops early on `stop`, as the model does, or on a part of the rows.
pub(in crate::predictor) fn points(
    recipe: &Recipe,
    train: &Dataset,
    validate: &Dataset,
    stop: Option<&Dataset>,
) -> Result<Points, PredictorError> {
    let lags = recipe.lags(train)?;
    let (train, validate) = (with_lags(train, lags.as_ref())?, with_lags(validate, lags.as_ref())?);
    let cone = recipe.cone(train.targets())?;
    let stop = stop.map(|stop| with_lags(stop, lags.as_ref())).transpose()?;
    let fit = |data: &Dataset| recipe.fit(data, stop.as_deref()).map(|fitted| fitted.model);
    let tell = |model: &Model, data: &Dataset| predict(model, cone.as_ref(), data.x().view());
    Ok(Points {
        targets: train.targets().to_vec(),
        by_share: learn_by_share(&train, &validate, &SHARES, fit, tell)?,
        by_recordings: learn_by_recordings(&train, &validate, fit, tell)?,
    })
}

/// Writes the table and the picture beside it; returns where that will be.
pub(in crate::predictor) fn write(
    points: &Points,
    table: &Path,
    places: &mut Places,
) -> Result<PathBuf, PredictorError> {
    let mut columns = vec![Column::integer("recordings"), Column::number("share"), Column::integer("rows")];
    columns.push(Column::number("trained_s"));
    for kind in ["train", "validate"] {
        columns.extend(points.targets.iter().map(|target| Column::number(format!("{target}_{kind}_rmse"))));
    }
    columns.push(Column::text("fault"));
    let mut writer = TableWriter::create(&places.place(table)?, table, columns, &[])?;
    for point in points.by_share.iter().chain(&points.by_recordings) {
        let mut cells = vec![Value::Integer(point.recordings as i64), Value::Number(point.share)];
        cells.extend([Value::Integer(point.rows as i64), Value::from(point.time_s)]);
        for scores in [&point.train, &point.held_out] {
            let rmse = |k: usize| scores.as_ref().map(|scores| scores.targets[k].rmse);
            cells.extend((0..points.targets.len()).map(|k| Value::from(rmse(k))));
        }
        cells.push(Value::Text(point.fault.as_deref().unwrap_or_default()));
        writer.write(&cells)?;
    }
    writer.finish()?;
    let [png, svg] = ["png", "svg"].map(|ending| table.with_extension(ending));
    let at = [places.place(&png)?, places.place(&svg)?];
    let series = [("shares of each recording", &points.by_share), ("recordings", &points.by_recordings)];
    let series: Vec<LearningSeries> = points
        .targets
        .iter()
        .enumerate()
        .flat_map(|(k, target)| {
            series.iter().map(move |(name, points)| LearningSeries {
                name: format!("{target}, {name}"),
                points: points
                    .iter()
                    .filter_map(|point| Some([point.rows as f64, point.held_out.as_ref()?.targets[k].rmse]))
                    .collect(),
            })
        })
        .collect();
    let chart = learning_curve("error on the validation recordings", "rows trained on", "RMSE", &series);
    draw_charts(&[chart], WIDTH, &at[0], &at[1])
        .map_err(|why| WriteError::File { path: png.clone(), why: format!("{why:#}") })?;
    Ok(png)
}
