//! A log and its truth to files; everything is put in its place at the end.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::Serialize;
use thiserror::Error;

use super::angles::write_angles;
use super::{LogOptions, LogScene, Row, Stamps};
use crate::files::{Staging, WriteError};
use crate::phantom::motion::finger::JOINTS;
use crate::phantom::scene::place::{Unwritten, in_the_way, refused};
use crate::phantom::sensor::CHANNELS;
use crate::table::{Column, TableError, TableWriter, Value};

/// The file that says that a log was written here.
const RECORD: &str = "truth/log.json";
/// The record first: where it stands, what is of one run and what of another is made again.
const RESULTS: [&str; 4] = [RECORD, "log.csv", "truth/log.csv", "truth/angles.csv"];
const FORCES: [&str; 3] = ["Fx_N", "Fy_N", "Fz_N"];
/// Decimals of stamps, of readings (a step of the converter is 0.00015 V) and of forces (steps of 0.0008 N).
const STAMP_DECIMALS: usize = 6;
const READING_DECIMALS: usize = 6;
const FORCE_DECIMALS: usize = 4;

/// Why a log was not written.
#[derive(Debug, Error)]
pub enum Error {
    /// Something that this job did not write stands in the way.
    #[error("{} stands already and is no synthetic log's; choose another --out", .0.display())]
    InTheWay(PathBuf),
    /// A file or folder could not be written.
    #[error(transparent)]
    Write(#[from] Unwritten),
    /// The results could not be put in their places.
    #[error(transparent)]
    Place(#[from] WriteError),
    /// A table could not be written.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// A log that was written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// Rows.
    pub rows: usize,
    /// Rows with the LED on.
    pub lit: usize,
    /// Seconds spent on writing.
    pub write_s: f64,
}

/// The files of a log, relative to its folder.
pub(in crate::phantom) fn files() -> Vec<String> {
    RESULTS.map(str::to_owned).to_vec()
}

/// Writes `scene` under `out`; a synthetic log written there before is replaced, a video stays.
///
/// # Errors
/// [`enum@Error`]; what stood under `out` before is as it was.
pub fn write(scene: &LogScene, out: &Path) -> Result<Summary, Error> {
    let begin = Instant::now();
    let staging = Staging::new(out)?;
    if let Some(place) = in_the_way(out, &RESULTS, RECORD) {
        return Err(Error::InTheWay(place));
    }
    write_staged(scene, staging)?;
    let lit = scene.rows().iter().filter(|row| row.lit).count();
    Ok(Summary { rows: scene.rows().len(), lit, write_s: begin.elapsed().as_secs_f64() })
}

fn write_staged(scene: &LogScene, staging: Staging) -> Result<(), Error> {
    let truth = staging.path().join("truth");
    fs::create_dir(&truth).map_err(refused(&truth))?;
    let [record, log, true_log, angles] = RESULTS.map(|name| staging.path().join(name));
    write_log(scene, &log)?;
    write_truth(scene, &true_log)?;
    write_angles(scene, &angles)?;
    write_record(scene, &record)?;
    Ok(staging.commit_exactly(&RESULTS)?)
}

fn photodiodes(suffix: &str) -> impl Iterator<Item = String> {
    (1..=CHANNELS).map(move |k| format!("P{k}{suffix}"))
}

fn write_log(scene: &LogScene, path: &Path) -> Result<(), Error> {
    let options = scene.options();
    let mut columns = vec![match options.stamps {
        Stamps::Seconds | Stamps::Epoch => Column::rounded("time_s", STAMP_DECIMALS),
        Stamps::Datetime => Column::text("time"),
    }];
    if options.led {
        columns.push(Column::integer("led"));
    }
    columns.extend(photodiodes("").map(|name| Column::rounded(name, READING_DECIMALS)));
    columns.extend(FORCES.map(|name| Column::rounded(name, FORCE_DECIMALS)));
    let mut table = TableWriter::create(path, path, columns, &[])?;
    for row in scene.rows() {
        let date;
        let mut cells = vec![match options.stamps {
            Stamps::Seconds => Value::Number(row.stamp_s),
            Stamps::Epoch => Value::Number(LogOptions::MIDNIGHT_S as f64 + row.stamp_s),
            Stamps::Datetime => {
                date = date_and_time(row.stamp_s);
                Value::Text(&date)
            }
        }];
        if options.led {
            cells.push(Value::Integer(row.lit.into()));
        }
        cells.extend(row.read_v.iter().chain(&row.forces_read_n).map(|&value| Value::Number(value)));
        table.write(&cells)?;
    }
    Ok(table.finish()?)
}

/// The date and time of day that a clock shows at `clock_s` seconds from the midnight of [`LogOptions::DATE`] on.
fn date_and_time(clock_s: f64) -> String {
    let (year, month, day) = LogOptions::DATE;
    let since = jiff::SignedDuration::from_micros((clock_s * 1e6).round() as i64);
    let shown = jiff::civil::date(year, month, day).at(0, 0, 0, 0).saturating_add(since);
    format!("{shown:.6}")
}

fn write_truth(scene: &LogScene, path: &Path) -> Result<(), Error> {
    let mut columns = vec![Column::integer("sample"), Column::number("time_s"), Column::number("log_s")];
    columns.push(Column::integer("led"));
    columns.extend(JOINTS.map(|joint| Column::number(format!("{joint}_deg"))));
    columns.extend(FORCES.map(Column::number));
    columns.extend(["", "_static", "_unlit"].into_iter().flat_map(photodiodes).map(Column::number));
    let mut table = TableWriter::create(path, path, columns, &[])?;
    let cells = |row: &Row| {
        let mut cells = vec![Value::Integer(row.sample as i64), Value::Number(row.scene_s), Value::Number(row.log_s)];
        cells.push(Value::Integer(row.lit.into()));
        cells.extend(row.touch.angles_rad.map(|angle| Value::Number(angle.to_degrees())));
        cells.extend(row.touch.forces_n.map(Value::Number));
        cells.extend([row.led_v, row.static_v, row.unlit_v].into_iter().flatten().map(Value::Number));
        cells
    };
    for row in scene.rows() {
        table.write(&cells(row))?;
    }
    Ok(table.finish()?)
}

fn write_record(scene: &LogScene, path: &Path) -> Result<(), Error> {
    let mut record = serde_json::json!({
        "options": scene.options(),
        "rows": scene.rows().len(),
        "photodiodes": scene.sensor(),
        "ambient": scene.ambient(),
        "wander": scene.wander(),
    });
    if scene.options().posture_shift_rad != 0.0 {
        // Beside what was allowed, what it was.
        record["posture_shift_deg"] = scene.posture_shift_rad().map(f64::to_degrees).into_iter().collect();
    }
    let text = serde_json::to_vec_pretty(&record).map_err(|error| refused(path)(error.into()))?;
    Ok(fs::write(path, text).map_err(refused(path))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_is_followed_by_the_next() {
        assert_eq!(date_and_time(0.0), "2026-03-14T00:00:00.000000");
        assert_eq!(date_and_time(86_399.999_999_6), "2026-03-15T00:00:00.000000");
        assert_eq!(date_and_time(-0.25), "2026-03-13T23:59:59.750000");
        assert_eq!(date_and_time(34_013.589_793), "2026-03-14T09:26:53.589793");
        assert_eq!(date_and_time(86_400.0 * (365.0 + 365.0 - 14.0)), "2028-02-28T00:00:00.000000");
        assert_eq!(date_and_time(86_400.0 * (365.0 + 365.0 - 13.0)), "2028-02-29T00:00:00.000000");
    }
}
