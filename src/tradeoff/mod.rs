//! Error against run time: a job run over its settings on scenes whose truth is known.
//!
//! It calls the same entry as the command line, so that a figure on a curve is the figure a user gets.

pub mod align;
pub mod hemodynamics;
pub mod photos;
pub mod posture;
pub mod predictor;
pub mod recipe;

use std::path::Path;

use anyhow::Context;

use crate::figure::{Axis, Plot, Point, Series, draw_log_log};

/// What a peer's setting begins with.
pub(crate) const PEER: &str = "OpenCV";

/// One measured setting: a row of `tradeoff.csv`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Row {
    /// Which job.
    pub job: &'static str,
    /// Which setting of it.
    pub setting: String,
    /// How wrong.
    pub error: f64,
    /// What the error is, and its unit.
    pub error_unit: String,
    /// Seconds on one thread per input, of the stage that the setting changes; the median over repeats.
    pub run_s: f64,
    /// What was done per input, a count that no clock disturbs.
    pub work: u64,
}

/// Writes `tradeoff.csv`, `tradeoff.png` and `tradeoff.svg`: a panel for each kind of error.
///
/// # Errors
/// Where a file can't be written, or there is nothing to draw.
pub fn write(rows: &[Row], title: &str, out: &Path) -> anyhow::Result<()> {
    write_panels(rows, &panels(rows, title), out)
}

/// The same with panels of one's own.
fn write_panels(rows: &[Row], panels: &[Plot], out: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    let table = out.join("tradeoff.csv");
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    crate::files::write_whole(&table, &writer.into_inner().context("tradeoff.csv")?)?;
    draw_log_log(panels, &out.join("tradeoff.png"), &out.join("tradeoff.svg"))
}

fn panels(rows: &[Row], title: &str) -> Vec<Plot> {
    let mut units: Vec<&str> = Vec::new();
    for row in rows {
        if !units.contains(&row.error_unit.as_str()) {
            units.push(&row.error_unit);
        }
    }
    units
        .into_iter()
        .map(|unit| Plot {
            title: format!("{title}: error against run time"),
            x: Axis { label: "seconds an input, of the stage alone".into() },
            y: Axis { label: unit.to_owned() },
            series: ["lunula", PEER].into_iter().filter_map(|name| series(rows, unit, name)).collect(),
        })
        .collect()
}

/// The points of one kind of error, of lunula's settings or of its peer's; none where there are none.
fn series(rows: &[Row], unit: &str, name: &str) -> Option<Series> {
    let points: Vec<Point> = rows
        .iter()
        .filter(|row| row.error_unit == unit && row.setting.starts_with(PEER) == (name == PEER))
        .map(|row| Point { x: row.run_s, y: row.error, label: row.setting.clone() })
        .collect();
    (!points.is_empty()).then(|| Series { name: name.to_owned(), points })
}

/// The middle one of several, NaN of none.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => values[n / 2],
        n => (values[n / 2 - 1] + values[n / 2]) / 2.0,
    }
}
