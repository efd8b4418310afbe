//! A recording that was worn and filmed: the log and the camera photodiodes, on one clock.

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use lunula_predictor::FORCES;

use crate::responses::is_photodiode;
use lunula::table::{Column, Table, TableWriter, Value};

/// A recording.
#[derive(Debug, Clone)]
pub(crate) struct Pair {
    /// `time_s`, photodiodes in volts, forces.
    pub(crate) log: PathBuf,
    /// `photodiodes.csv` of `lunula nailvideo`.
    pub(crate) camera: PathBuf,
}

/// Some columns of a table over its `time_s`, in its order; NaN where a cell is empty.
struct OverTime {
    time_s: Vec<f64>,
    names: Vec<String>,
    values: Vec<Vec<f64>>,
}

impl OverTime {
    fn read(path: &Path, wanted: impl Fn(&str) -> bool) -> anyhow::Result<Self> {
        let table = Table::read(path)?;
        let names: Vec<String> = table.names().iter().filter(|name| wanted(name)).cloned().collect();
        let values = names.iter().map(|name| table.values(name)).collect::<Result<_, _>>()?;
        let time_s = table.values("time_s")?;
        ensure!(time_s.is_sorted_by(|a, b| a < b), "{}: time_s has to grow from row to row", path.display());
        Ok(Self { time_s, names, values })
    }

    /// Between the rows before and after; NaN before the first and after the last.
    fn at(&self, column: usize, time_s: f64) -> f64 {
        let after = self.time_s.partition_point(|&own| own < time_s);
        let (values, times) = (&self.values[column], &self.time_s);
        match (after.checked_sub(1), times.get(after)) {
            (_, Some(&own)) if own == time_s => values[after],
            (Some(before), Some(&next)) => {
                let share = (time_s - times[before]) / (next - times[before]);
                values[before] + share * (values[after] - values[before])
            }
            _ => f64::NAN,
        }
    }
}

impl Pair {
    fn camera(&self) -> anyhow::Result<OverTime> {
        OverTime::read(&self.camera, is_photodiode)
    }

    /// Writes the camera's frames with the forces at their time; gives how many lack a photodiode or a force.
    pub(super) fn label(&self, to: &Path) -> anyhow::Result<usize> {
        let (camera, log) = (self.camera()?, OverTime::read(&self.log, |name| FORCES.contains(&name))?);
        ensure!(log.names.len() == FORCES.len(), "{}: has not all of {}", self.log.display(), FORCES.join(", "));
        let columns = ["time_s".to_owned()].into_iter().chain(camera.names.iter().chain(&log.names).cloned());
        let mut table = TableWriter::create(to, to, columns.map(Column::number).collect(), &[])?;
        let mut left_out = 0;
        for (row, &time_s) in camera.time_s.iter().enumerate() {
            let seen = camera.values.iter().map(|values| values[row]);
            let cells: Vec<f64> = seen.chain((0..log.names.len()).map(|column| log.at(column, time_s))).collect();
            if cells.iter().all(|cell| cell.is_finite()) {
                table.write(&[time_s].into_iter().chain(cells).map(Value::Number).collect::<Vec<_>>())?;
            } else {
                left_out += 1;
            }
        }
        table.finish()?;
        Ok(left_out)
    }
}

/// What both see at one place.
pub(super) struct Trace {
    pub(super) name: String,
    /// Time and volts of each sample.
    pub(super) sensor: Vec<[f64; 2]>,
    /// Time and value of each frame, by a straight line brought to the sensor's volts.
    pub(super) camera: Vec<[f64; 2]>,
    /// Correlation of the frames' values with the volts at their time.
    pub(super) correlation: Option<f64>,
}

/// Both sensors of a recording.
pub(super) struct Traces {
    pub(super) all: Vec<Trace>,
}

impl Traces {
    /// Of the photodiodes that both have.
    pub(super) fn of(pair: &Pair) -> anyhow::Result<Self> {
        let (camera, sensor) = (pair.camera()?, OverTime::read(&pair.log, is_photodiode)?);
        let mut all = Vec::new();
        for (column, name) in camera.names.iter().enumerate() {
            let Some(own) = sensor.names.iter().position(|other| other == name) else { continue };
            let both = camera.time_s.iter().zip(&camera.values[column]);
            let rows: Vec<[f64; 3]> = both.map(|(&time_s, &value)| [time_s, value, sensor.at(own, time_s)]).collect();
            let line = Line::through(rows.iter().filter(|row| row.iter().all(|cell| cell.is_finite())));
            let samples = sensor.time_s.iter().zip(&sensor.values[own]).map(|(&time_s, &volts)| [time_s, volts]);
            all.push(Trace {
                name: name.clone(),
                sensor: samples.collect(),
                camera: rows.iter().map(|[time_s, value, _]| [*time_s, line.at(*value)]).collect(),
                correlation: line.correlation,
            });
        }
        ensure!(!all.is_empty(), "{} and {}: no photodiode is in both", pair.log.display(), pair.camera.display());
        Ok(Self { all })
    }

    pub(super) fn correlations(&self) -> Vec<(String, Option<f64>)> {
        self.all.iter().map(|trace| (trace.name.clone(), trace.correlation)).collect()
    }
}

/// Volts over the camera's values, by least squares.
struct Line {
    middle: [f64; 2],
    slope: f64,
    correlation: Option<f64>,
}

impl Line {
    fn through<'a>(rows: impl Iterator<Item = &'a [f64; 3]> + Clone) -> Self {
        let n = rows.clone().count() as f64;
        let middle = [1, 2].map(|k| rows.clone().map(|row| row[k]).sum::<f64>() / n);
        let product = |a: usize, b: usize| -> f64 {
            rows.clone().map(|row| (row[a + 1] - middle[a]) * (row[b + 1] - middle[b])).sum()
        };
        let (xx, xy, yy) = (product(0, 0), product(0, 1), product(1, 1));
        let correlation = (xx > 0.0 && yy > 0.0).then(|| xy / (xx * yy).sqrt());
        Self { middle, slope: xy / xx, correlation }
    }

    fn at(&self, value: f64) -> f64 {
        self.middle[1] + self.slope * (value - self.middle[0])
    }
}

/// The pressing over time, for Fig. 5: of each of these times, newtons.
pub(super) fn pressing_n(log: &Path, times_s: &[f64]) -> anyhow::Result<Vec<f64>> {
    let found = OverTime::read(log, |name| name == "Fz_N")?;
    found.names.first().with_context(|| format!("{}: has no Fz_N", log.display()))?;
    Ok(times_s.iter().map(|&time_s| -found.at(0, time_s)).collect())
}
