//! `halves` in a pipeline: the first and the second half of a labelled set, as tables: what 5.3.2 trains the posture
//! predictor on and validates it on (Fig. 101 to 104).
//!
//! In: a table with `time_s` and `J2_deg`. Out: `first.csv` and `second.csv`, its rows up to the middle of the time in
//! which J2 is known and from there on, its cells as they are. A row without a time is in neither.

use std::path::Path;

use anyhow::ensure;
use clap::Args;
use serde::Serialize;

use lunula::files::Staging;
use lunula::job::{Demand, Facts, Foreseen, Job, Kind, Made, Order, Part, Role, Takes, Work};
use lunula::predictor::POSTURE;
use lunula::stages::Step;
use lunula::table::{Column, Table, TableWriter, Value};

/// A stage of a pipeline.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct HalvesJob {}

#[derive(Debug, Serialize)]
struct HalvesFigures {
    rows: [usize; 2],
}

const NAMES: [&str; 2] = ["first", "second"];
const FILES: [&str; 2] = ["first.csv", "second.csv"];

impl Job for HalvesJob {
    const KIND: Kind = Kind::of::<Self>(
        "halves",
        &[Role::new("set", Takes::One, "a labelled set, as `align` makes it")],
        &[Part::new(NAMES[0], FILES[0]), Part::new(NAMES[1], FILES[1])],
    );

    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        Demand { parts: ["training"].into(), joints: own.joints.clone(), clock: own.clock }
    }

    fn steps(&self, _inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(vec![Step::new("halves", true, "before and after the middle of its time".to_owned())])
    }

    fn facts(&self, inputs: &[Foreseen], _demand: &Demand) -> Facts {
        inputs.first().map(|first| first.facts).unwrap_or_default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let bytes: u64 = inputs.iter().map(|input| input.bytes(1 << 20)).sum();
        ((32 << 20) + 8 * bytes, 0.01 + 3e-8 * bytes as f64)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let set = work.needed("set")?;
        let figures = || Ok(HalvesFigures { rows: halves(&set.path, work.folder)? });
        let report = work.report::<Self, _>(order.said, "halves", figures)?;
        Ok(report.made(Vec::new()))
    }
}

/// Writes both halves; gives how many rows each has.
fn halves(set: &Path, out: &Path) -> anyhow::Result<[usize; 2]> {
    let table = Table::read(set)?;
    let time_s = table.numbers_or_nan("time_s")?;
    let angles = table.numbers_or_nan(POSTURE)?;
    let is_known = |angle: &Option<f64>| angle.is_some_and(f64::is_finite);
    let known = || time_s.iter().zip(&angles).filter(|(_, angle)| is_known(angle)).filter_map(|(time_s, _)| *time_s);
    let (from_s, to_s) = (known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max));
    ensure!(from_s < to_s, "{}: J2_deg is known at one time at most; label it with `align`", set.display());
    let is_second = |time_s: f64| time_s > 0.5 * (from_s + to_s);
    let texts = table.names().iter().map(|name| table.texts(name)).collect::<Result<Vec<_>, _>>()?;
    let staging = Staging::new(out)?;
    let mut rows = [0; 2];
    for (half, file) in FILES.iter().enumerate() {
        let columns = table.names().iter().map(Column::text).collect();
        let mut written = TableWriter::create(&staging.place(file)?, &out.join(file), columns, table.facts())?;
        for (row, _) in time_s.iter().enumerate().filter(|(_, time)| time.is_some_and(|t| is_second(t) == (half == 1)))
        {
            let cells: Vec<Value<'_>> =
                texts.iter().map(|column| Value::Text(column[row].as_deref().unwrap_or_default())).collect();
            written.write(&cells)?;
            rows[half] += 1;
        }
        written.finish()?;
    }
    staging.commit()?;
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_parted_in_the_middle_of_the_labelled_time_and_stay_as_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let set = folder.path().join("set.csv");
        // Labelled from 10 to 20 s; the log began earlier.
        let text = "time_s,P1,J2_deg,label_status\n0,1.250,,before the video\n10,1.5,3.0,\n15,1.75,,gap: J2\n\
                    15.5,2,4.0,\n20,2.25,5.0,\n,9,9,\n";
        std::fs::write(&set, text).unwrap();
        let out = folder.path().join("out");
        assert_eq!(halves(&set, &out).unwrap(), [3, 2]);
        let read = |file: &str| std::fs::read_to_string(out.join(file)).unwrap();
        let head = "time_s,P1,J2_deg,label_status\n";
        assert_eq!(read("first.csv"), format!("{head}0,1.250,,before the video\n10,1.5,3.0,\n15,1.75,,gap: J2\n"));
        assert_eq!(read("second.csv"), format!("{head}15.5,2,4.0,\n20,2.25,5.0,\n"));
    }

    #[test]
    fn a_set_without_labels_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let set = folder.path().join("set.csv");
        std::fs::write(&set, "time_s,P1,J2_deg\n0,1,\n1,1,2\n").unwrap();
        let why = halves(&set, folder.path()).unwrap_err().to_string();
        assert!(why.contains("set.csv: J2_deg is known at one time at most"), "{why}");
        assert!(!folder.path().join("first.csv").exists());
    }
}
