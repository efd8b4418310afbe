//! A log and its truth to files; everything is put in its place at the end.

use std::fs;
use std::path::Path;
use std::time::Instant;

use serde::Serialize;

use super::angles::write_angles;
use super::doing::shift_rad;
use super::lines::{cells, columns};
use super::truth::{true_cells, true_columns, write_contacts};
use super::{LogOptions, LogScene, SensorModel};
use crate::files::Staging;
use crate::phantom::scene::place::{Error, refused, staged, write_record};
use crate::table::TableWriter;

/// The file that says that a log was written here.
const RECORD: &str = "truth/log.json";
/// The record first: where it stands, what is of one run and what of another is made again. Contacts are of few.
const RESULTS: [&str; 5] = [RECORD, "log.csv", "truth/log.csv", "truth/angles.csv", CONTACTS];
const CONTACTS: &str = "truth/contacts.csv";

/// A log that was written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// Rows.
    pub rows: usize,
    /// Rows with the LED on.
    pub lit: usize,
    /// Seconds spent on taking the samples and writing them.
    pub write_s: f64,
}

/// The files of a log, relative to its folder.
pub(in crate::phantom) fn files(options: &LogOptions) -> Vec<String> {
    let made = |name: &&str| *name != CONTACTS || options.contacts().is_some();
    RESULTS.into_iter().filter(made).map(str::to_owned).collect()
}

/// Writes `scene` under `out`; a synthetic log written there before is replaced, a video stays.
///
/// # Errors
/// [`Error`]; what stood under `out` before is as it was.
pub fn write(scene: &LogScene, out: &Path) -> Result<Summary, Error> {
    let begin = Instant::now();
    let staging = staged(out, &RESULTS, RECORD, "a synthetic log's")?;
    let [rows, lit] = write_staged(scene, staging)?;
    Ok(Summary { rows, lit, write_s: begin.elapsed().as_secs_f64() })
}

/// Rows, and how many are lit.
fn write_staged(scene: &LogScene, staging: Staging) -> Result<[usize; 2], Error> {
    let truth = staging.path().join("truth");
    fs::create_dir(&truth).map_err(refused(&truth))?;
    let [record, log, true_log, angles, contacts] = RESULTS.map(|name| staging.path().join(name));
    let counts = write_rows(scene, &log, &true_log)?;
    write_angles(scene, &angles)?;
    write_contacts(scene.options(), &contacts)?;
    write_record(&record, &record_of(scene, counts[0]))?;
    staging.commit_exactly(&RESULTS)?;
    Ok(counts)
}

/// Writes each row and its truth as it is taken.
pub(in crate::phantom) fn write_rows(scene: &LogScene, log: &Path, true_log: &Path) -> Result<[usize; 2], Error> {
    let options = scene.options();
    let mut table = TableWriter::create(log, log, columns(options), &[])?;
    let mut truth = TableWriter::create(true_log, true_log, true_columns(options), &[])?;
    let mut date = String::new();
    let [mut rows, mut lit] = [0, 0];
    for row in scene.samples() {
        table.write(&cells(options, &row, &mut date))?;
        truth.write(&true_cells(options, &row))?;
        rows += 1;
        lit += usize::from(row.lit);
    }
    table.finish()?;
    truth.finish()?;
    Ok([rows, lit])
}

fn record_of(scene: &LogScene, rows: usize) -> serde_json::Value {
    let options = scene.options();
    let mut record = serde_json::json!({
        "options": options,
        "rows": rows,
        "ambient": options.ambient(),
        "wander": options.wander(),
    });
    match options.sensor {
        SensorModel::Formulae => record["photodiodes"] = serde_json::json!(scene.sensor()),
        SensorModel::Nail => record["positions"] = serde_json::json!(options.places()),
    }
    if options.posture_shift_rad != 0.0 {
        // Beside what was allowed, what it was.
        record["posture_shift_deg"] = shift_rad(options).map(f64::to_degrees).into_iter().collect();
    }
    if let Some(disturbances) = options.disturbances() {
        record["disturbances"] = serde_json::json!(disturbances);
    }
    record
}
