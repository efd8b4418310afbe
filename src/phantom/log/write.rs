//! A log and its truth to files; everything is put in its place at the end.

use std::path::Path;
use std::time::Instant;

use serde_json::json;

use super::angles::write_angles;
use super::doing::shift_rad;
use super::lines::{cells, columns};
use super::truth::{true_cells, true_columns, write_contacts};
use super::{Faults, LogOptions, LogScene, SensorModel};
use crate::job::{Facts, Watch};
use crate::phantom::scene::place::{Error, staged, write_record};
use crate::phantom::scene::recording::{Cost, Generated, Written, sorted};
use crate::phantom::sensor::CHANNELS;
use crate::table::TableWriter;

/// The file that says that a log was written here.
const RECORD: &str = "truth/log.json";
/// The record first: where it stands, what is of one run and what of another is made again. Contacts are of few.
const RESULTS: [&str; 5] = [RECORD, "log.csv", "truth/log.csv", "truth/angles.csv", CONTACTS];
const CONTACTS: &str = "truth/contacts.csv";

/// Seconds on one thread a millisecond; measured with a release build on a Xeon of 2.1 GHz.
pub(in crate::phantom) const S_PER_MS: f64 = 8e-7;
/// Bytes of a row where the whole log is looked at before it is written.
const BYTES_PER_ROW: f64 = 32.0;

impl Generated for LogOptions {
    fn check(&self) -> Result<(), Faults> {
        self.check()
    }

    fn options(&self) -> serde_json::Value {
        json!({ "log": self })
    }

    fn files(&self) -> Vec<String> {
        sorted(RESULTS.into_iter().filter(|name| *name != CONTACTS || self.contacts().is_some()))
    }

    fn facts(&self, file: &str) -> Facts {
        match file {
            "log.csv" => Facts { led: Some(self.led), forces: Some(self.forces), ..Facts::default() },
            "truth/angles.csv" => Facts { clock: Some(true), ..Facts::default() },
            _ => Facts::default(),
        }
    }

    fn cost(&self) -> Cost {
        let span_s = self.lead_s + self.seconds + self.trail_s;
        let kept = if self.saturate { BYTES_PER_ROW * span_s * self.rate_hz } else { 0.0 };
        Cost::of(kept, S_PER_MS * 1e3 * (span_s + 10.0))
    }

    fn write_watched(&self, folder: &Path, _watch: &Watch<'_>) -> Result<Written, Error> {
        let begin = Instant::now();
        let scene = LogScene::new(self.clone())?;
        let start = Instant::now();
        let staging = staged(folder, &RESULTS, RECORD, "a synthetic log's")?;
        let [record, log, true_log, angles, contacts] = RESULTS.map(|name| staging.path().join(name));
        let [rows, lit] = write_rows(&scene, &log, &true_log)?;
        write_angles(&scene, &angles)?;
        write_contacts(self, &contacts)?;
        write_record(&record, &record_of(&scene, rows))?;
        staging.commit_exactly(&RESULTS)?;
        let (write_s, total_s) = (start.elapsed().as_secs_f64(), begin.elapsed().as_secs_f64());
        let figures = json!({
            "options": self,
            "rows": rows,
            "lit": lit,
            "photodiodes": CHANNELS,
            "stages": { "write_s": write_s, "total_s": total_s },
        });
        let none = (rows == 0).then(|| "the log has no rows: all were lost".to_owned());
        Ok(Written { count: rows, figures, total_s, warnings: none.into_iter().collect() })
    }
}

/// Writes each row and its truth as it is taken: how many there are, and how many are lit.
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
    let mut record = json!({
        "options": options,
        "rows": rows,
        "ambient": options.ambient(),
        "wander": options.wander(),
    });
    match options.sensor {
        SensorModel::Formulae => record["photodiodes"] = json!(scene.sensor()),
        SensorModel::Nail => record["positions"] = json!(options.places()),
    }
    if options.posture_shift_rad != 0.0 {
        // Beside what was allowed, what it was.
        record["posture_shift_deg"] = shift_rad(options).map(f64::to_degrees).into_iter().collect();
    }
    if let Some(disturbances) = options.disturbances() {
        record["disturbances"] = json!(disturbances);
    }
    record
}
