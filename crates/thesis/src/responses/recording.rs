//! A recording of one subject whose force or angle goes up and down, with all photodiodes.
//!
//! In: a table with `time_s`, `P1`.. in volts and forces or angles, as `lunula align` writes it, or a raw log whose LED
//! goes on and off (3.1.2c). Out: [`Recording`], NaN where something is missing. A photodiode's value in a row in which
//! the sensor had a fault is missing.

use std::path::{Path, PathBuf};

use super::{DRIVES, ResponsesError};
use lunula::log::{Channel, LogReading};
use lunula::table::{Table, TableError};

/// A recording, row by row; NaN where something is missing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Recording {
    /// The file's name.
    pub(crate) name: String,
    /// Seconds.
    pub(crate) time_s: Vec<f64>,
    /// Volts of each photodiode, in the order of their numbers.
    pub(crate) outputs: Vec<Channel>,
    /// Forces and angles.
    pub(crate) moves: Vec<Channel>,
    /// Rows whose photodiodes had a fault and are not used.
    pub(crate) faulty: usize,
    /// What was done to a raw log, and what is worth saying.
    pub(crate) notes: Vec<String>,
}

impl Recording {
    /// Reads a recording that has `drive`, called `name`.
    ///
    /// # Errors
    /// [`ResponsesError`] where the file can't be read or a column is missing.
    pub(crate) fn read(path: &Path, name: &str, drive: &str) -> Result<Self, ResponsesError> {
        let raw = LogReading::default().is_log(path)?;
        let mut found = if raw { Self::of_log(path, name)? } else { Self::of_table(path, name)? };
        found.outputs.sort_by_key(|channel| number_of(&channel.name));
        let refused = |what: String| ResponsesError::Columns { path: PathBuf::from(name), what };
        if found.outputs.is_empty() {
            return Err(refused("has no photodiodes; their columns are called P1, P2, ..".to_owned()));
        }
        if found.of(drive).is_none() {
            let have: Vec<&str> = found.moves.iter().map(|channel| channel.name.as_str()).collect();
            let what = format!(
                "has no column {drive}, which is to go up and down; name another by `drive` (it has: {}){}",
                if have.is_empty() { "neither forces nor angles".to_owned() } else { have.join(", ") },
                if drive.ends_with("_deg") { ", or give the set that `lunula align` labels" } else { "" }
            );
            return Err(refused(what));
        }
        Ok(found)
    }

    /// A force or angle.
    #[must_use]
    pub(crate) fn of(&self, name: &str) -> Option<&[f64]> {
        self.moves.iter().find(|channel| channel.name == name).map(|channel| channel.values.as_slice())
    }

    fn of_table(path: &Path, name: &str) -> Result<Self, ResponsesError> {
        let table = Table::read(path)?;
        if !table.has("time_s") {
            let what = "has no column time_s; cycles are found by time".to_owned();
            return Err(ResponsesError::Columns { path: PathBuf::from(name), what });
        }
        let channels = |wanted: &dyn Fn(&str) -> bool| -> Result<Vec<Channel>, TableError> {
            let names = table.names().iter().filter(|name| wanted(name));
            names.map(|name| Ok(Channel { name: name.clone(), values: table.values(name)? })).collect()
        };
        let mut outputs = channels(&is_photodiode)?;
        let moves = channels(&|name| DRIVES.contains(&name))?;
        let mut faulty = vec![false; table.rows()];
        if table.has("sensor_status") {
            table.each_text("sensor_status", |row, text| faulty[row] = !matches!(text, "" | "ok"))?;
        }
        let count = forget(&mut outputs, &faulty);
        Ok(Self {
            name: name.to_owned(),
            time_s: table.values("time_s")?,
            outputs,
            moves,
            faulty: count,
            notes: Vec::new(),
        })
    }

    fn of_log(path: &Path, name: &str) -> Result<Self, ResponsesError> {
        let lit = LogReading::default().lit_rows(path)?.samples;
        let mut outputs: Vec<Channel> =
            lit.photodiodes.into_iter().filter(|channel| is_photodiode(&channel.name)).collect();
        let faulty: Vec<bool> = lit.faults.iter().map(|words| !words.is_empty()).collect();
        let count = forget(&mut outputs, &faulty);
        Ok(Self {
            name: name.to_owned(),
            time_s: lit.time_s,
            outputs,
            moves: lit.forces,
            faulty: count,
            notes: lit.notes,
        })
    }
}

/// Marks rows with a fault as missing; returns how many.
fn forget(outputs: &mut [Channel], faulty: &[bool]) -> usize {
    for channel in outputs {
        channel.values.iter_mut().zip(faulty).filter(|(_, faulty)| **faulty).for_each(|(value, _)| *value = f64::NAN);
    }
    faulty.iter().filter(|faulty| **faulty).count()
}

/// Whether a column is a photodiode's: P1, P2, ..
pub(crate) fn is_photodiode(name: &str) -> bool {
    number_of(name).is_some()
}

fn number_of(name: &str) -> Option<u32> {
    name.strip_prefix('P')?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, drive: &str) -> Result<Recording, ResponsesError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("set.csv");
        std::fs::write(&path, text).unwrap();
        Recording::read(&path, "set.csv", drive)
    }

    #[test]
    fn columns_may_stand_in_any_order_and_missing_is_missing() {
        let found =
            read("P2,sensor_status,Fz_N,P1,time_s\n2,ok,-1,1,0\n,ok,,1.5,0.1\n3,saturated: P2,-2,1,0.2\n", "Fz_N");
        let found = found.unwrap();
        let names: Vec<&str> = found.outputs.iter().map(|channel| channel.name.as_str()).collect();
        assert_eq!((names, found.faulty), (vec!["P1", "P2"], 1));
        assert_eq!(found.outputs[0].values[..2], [1.0, 1.5]);
        assert!(found.outputs[1].values[1].is_nan() && found.outputs[1].values[2].is_nan());
        assert!(found.of("Fz_N").unwrap()[1].is_nan());
    }

    #[test]
    fn a_raw_log_is_brought_to_the_leds_own_light() {
        let rows: String =
            (0..20).map(|k| format!("{},{},{},{}\n", f64::from(k) / 25.0, k % 2, 1 + k % 2, -k)).collect();
        let found = read(&format!("time_s,led,P1,Fz_N\n{rows}"), "Fz_N").unwrap();
        assert_eq!(found.time_s.len(), 10);
        let (last, before) = found.outputs[0].values.split_last().unwrap();
        assert!(before.iter().all(|value| (value - 1.0).abs() < 1e-9), "{found:?}");
        // After the last lit sample no unlit one measures the ambient light.
        assert!(last.is_nan() && found.faulty == 1);
    }

    #[test]
    fn what_is_not_there_is_named() {
        let no_drive = read("time_s,P1,Fx_N\n0,1,2\n", "J2_deg").unwrap_err().to_string();
        assert!(no_drive.contains("set.csv") && no_drive.contains("J2_deg") && no_drive.contains("Fx_N"), "{no_drive}");
        assert!(read("time_s,Fx_N\n0,1\n", "Fx_N").unwrap_err().to_string().contains("P1, P2"));
        assert!(read("P1,Fx_N\n0,1\n", "Fx_N").unwrap_err().to_string().contains("time_s"));
    }
}
