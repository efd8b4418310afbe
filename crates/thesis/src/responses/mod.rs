//! How photodiodes answer to a force or to bending that goes up and down slowly (3.3, Fig. 23 to 34).
//!
//! In: recordings of one subject, and which force or angle goes up and down. Out, in a folder: forces (or angles) over
//! time (`moves`, Fig. 23, 26, 29), outputs over time at their places on the nail (`outputs`, Fig. 24, 27, 30, 32),
//! outputs averaged over cycles (`averages`, Fig. 25, 28, 31, 34), for bending J3 over J2 (`coupling`, Fig. 33), each
//! as PNG and SVG; `responses.csv`, the averages; `numbers.json`, what the thesis' words speak of (`measure`).
//!
//! Cycles are found from the driving signal itself (`cycles`). Of several recordings, all cycles are averaged together
//! and the first is drawn over time; bending is drawn over one cycle, as Fig. 32 is.

mod curve;
mod cycles;
mod figures;
mod kind;
mod measure;
mod places;
mod recording;
mod sensor;
mod table;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;
use serde::Serialize;

use super::Numbers;
pub(crate) use curve::{Curve, Source};
pub(crate) use cycles::Cycles;
use lunula::files::{Staging, WriteError};
use lunula::job::{Interrupted, Report, Watch};
use lunula::log::LogError;
use lunula::predictor::DataFile;
use lunula::stages::{Stages, Step, left_out};
use lunula::table::TableError;
pub(crate) use places::Places;
pub(crate) use recording::{Recording, is_photodiode};

/// Forces and angles that may go up and down.
pub(crate) const DRIVES: [&str; 6] = ["Fx_N", "Fy_N", "Fz_N", "J1_deg", "J2_deg", "J3_deg"];

/// Which signal, and how it is averaged.
#[derive(Debug, Clone, PartialEq, Args)]
pub(crate) struct ResponsesOptions {
    /// The force or angle that goes up and down
    #[arg(long, value_parser = PossibleValuesParser::new(DRIVES))]
    pub(crate) drive: String,
    /// Bins of its range
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u16).range(4..=200))]
    pub(crate) bins: u16,
    /// A row of photodiodes on the nail, from left to right; rows from distal to proximal [default: the thesis' eight]
    #[arg(long, value_parser = row)]
    pub(crate) places: Vec<Vec<String>>,
}

fn row(names: &str) -> Result<Vec<String>, String> {
    Ok(names.split(',').map(|name| name.trim().to_owned()).collect())
}

impl ResponsesOptions {
    /// Where the photodiodes are.
    ///
    /// # Errors
    /// A photodiode twice, or none at all.
    fn places(&self) -> Result<Places, String> {
        if self.places.is_empty() { Ok(Places::default()) } else { Places::checked(self.places.clone()) }
    }
}

/// The one table of steps.
fn steps(options: &ResponsesOptions) -> Vec<Step> {
    let bends = options.drive == "J2_deg";
    let coupling = if bends { "J3 over J2, where the recording has J3" } else { "only of J2" };
    vec![
        Step::new("cycles", true, format!("of {}", options.drive)),
        Step::new("averages", true, "over cycles, rising and falling".to_owned()),
        Step::new("coupling", bends, coupling.to_owned()),
    ]
}

/// What came out.
pub(crate) type ResponsesReport = Report<ResponsesFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ResponsesFigures {
    /// What went up and down.
    pub(crate) drive: String,
    /// Whole cycles, over all recordings.
    pub(crate) cycles: usize,
    pub(crate) range: [f64; 2],
    /// Numbers by name.
    pub(crate) numbers: Numbers,
}

/// Why there are no responses.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ResponsesError {
    #[error("{0}")]
    Request(String),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Log(#[from] LogError),
    #[error("{}: {what}", path.display())]
    Columns { path: PathBuf, what: String },
    #[error("{files}: {drive} makes no whole cycle ({why}); give a recording in which it goes there and back")]
    NoCycle {
        files: String,
        drive: String,
        /// What it does instead.
        why: String,
    },
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}

/// Finds the responses and writes them into `out`.
pub(crate) fn responses(
    files: &[DataFile],
    options: &ResponsesOptions,
    out: &Path,
    watch: &Watch<'_>,
) -> Result<ResponsesReport, ResponsesError> {
    let stages = Stages::default();
    if files.is_empty() {
        return Err(ResponsesError::Request("no recording is given; name at least one".to_owned()));
    }
    let places = options.places().map_err(|why| ResponsesError::Request(format!("places: {why}")))?;
    let read = |file: &DataFile| Recording::read(&file.path, &file.name, &options.drive);
    let recordings = stages.time("read", || files.iter().map(read).collect::<Result<Vec<_>, _>>())?;
    watch.go_on()?;
    let averages = stages.time("average", || Averages::of(&recordings, options))?;
    let mut numbers = averages.numbers(options);
    watch.go_on()?;
    let staging = Staging::new(out)?;
    stages.time("write", || table::write(&staging, out, &averages.curves))?;
    stages.time("figures", || averages.draw(&staging, options, &places, &mut numbers))?;
    staging.write("numbers.json", numbers.to_text().as_bytes())?;
    staging.commit()?;
    let Averages { cycles, range, warnings, notes, .. } = averages;
    let cycles = cycles.iter().map(Cycles::count).sum();
    let figures = ResponsesFigures { drive: options.drive.clone(), cycles, range, numbers };
    let left_out = left_out(steps(options));
    let report = Report { left_out, warnings, notes, ..Report::new("responses", watch, figures) };
    Ok(report.timed(&stages))
}

/// Recordings with their cycles and averages.
struct Averages<'a> {
    recordings: &'a [Recording],
    cycles: Vec<Cycles>,
    range: [f64; 2],
    /// Photodiodes that all recordings have.
    curves: Vec<(String, Curve)>,
    /// Forces that are to be held.
    held: Vec<(String, Curve)>,
    warnings: Vec<String>,
    notes: Vec<String>,
}

impl<'a> Averages<'a> {
    fn of(recordings: &'a [Recording], options: &ResponsesOptions) -> Result<Self, ResponsesError> {
        let drive = |one: &'a Recording| one.of(&options.drive).unwrap_or(&[]);
        let cycles: Vec<Cycles> = recordings.iter().map(|one| Cycles::of(&one.time_s, drive(one))).collect();
        let (mut warnings, mut notes) = (Vec::new(), Vec::new());
        for (one, cycles) in recordings.iter().zip(&cycles) {
            notes.extend(one.notes.iter().map(|note| format!("{}: {note}", one.name)));
            if one.faulty > 0 {
                notes.push(format!("{}: {} rows with a fault of the sensor are not used", one.name, one.faulty));
            }
            if cycles.cut > 0 {
                let what = "parts of cycles do not go all the way or have a gap, and are not used";
                notes.push(format!("{}: {} {what}", one.name, cycles.cut));
            }
        }
        let used: Vec<[f64; 2]> = cycles.iter().filter(|one| one.count() > 0).filter_map(|one| one.range).collect();
        let range = used.iter().copied().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let Some(range) = range else {
            let files = recordings.iter().map(|one| one.name.clone()).collect::<Vec<_>>().join(", ");
            let why = match cycles.iter().find_map(|one| one.range) {
                None => "no row has a time and its value".to_owned(),
                Some([low, high]) if low == high => format!("it stays at {low}"),
                Some([low, high]) => format!("it is between {low:.3} and {high:.3}, and never there and back"),
            };
            return Err(ResponsesError::NoCycle { files, drive: options.drive.clone(), why });
        };
        if cycles.iter().map(Cycles::count).sum::<usize>() == 1 {
            warnings.push("one cycle only: there is no spread over cycles".to_owned());
        }
        let curve = |of: &dyn Fn(&'a Recording) -> Option<&'a [f64]>| -> Option<Curve> {
            let sources = recordings
                .iter()
                .zip(&cycles)
                .map(|(one, cycles)| Some(Source { legs: &cycles.legs, drive: drive(one), output: of(one)? }));
            Some(Curve::of(&sources.collect::<Option<Vec<_>>>()?, range, usize::from(options.bins)))
        };
        let output = |one: &'a Recording, name: &str| -> Option<&'a [f64]> {
            one.outputs.iter().find(|channel| channel.name == name).map(|channel| channel.values.as_slice())
        };
        let names: Vec<&String> = recordings[0].outputs.iter().map(|channel| &channel.name).collect();
        let curves = names.into_iter().filter_map(|name| Some((name.clone(), curve(&|one| output(one, name))?)));
        let forces = DRIVES.iter().filter(|name| name.ends_with("_N") && **name != options.drive);
        let held = forces.filter_map(|name| Some(((*name).to_owned(), curve(&|one| one.of(name))?)));
        let (curves, held) = (curves.collect(), held.collect());
        Ok(Self { recordings, cycles, range, curves, held, warnings, notes })
    }

    fn numbers(&self, options: &ResponsesOptions) -> Numbers {
        let mut numbers = Numbers::default();
        numbers.set("cycles", self.cycles.iter().map(Cycles::count).sum::<usize>() as f64);
        let rates = self.cycles.iter().zip(self.recordings).filter_map(|(cycles, one)| cycles.rate_hz(&one.time_s));
        numbers.set("rate_hz", measure::mean(rates));
        numbers.set("from", self.range[0]);
        numbers.set("to", self.range[1]);
        let own: Vec<(String, Numbers)> =
            self.curves.iter().map(|(name, curve)| (name.clone(), measure::of_output(curve, &options.drive))).collect();
        numbers.0.extend(sensor::of_all(&own, &options.drive).0);
        for (name, curve) in &self.held {
            let values = || {
                let rows = self.recordings.iter().zip(&self.cycles).filter_map(|(one, cycles)| {
                    let values = one.of(name)?;
                    Some(cycles.legs.iter().flat_map(move |leg| &values[leg.rows.clone()]))
                });
                rows.flatten().copied().filter(|value| value.is_finite())
            };
            let mean = measure::mean(values());
            numbers.set(format!("{name}.mean"), mean);
            let squares = mean.and_then(|mean| measure::mean(values().map(|value| (value - mean).powi(2))));
            numbers.set(format!("{name}.sd"), squares.map(f64::sqrt));
            let own = measure::of_output(curve, &options.drive);
            numbers.set(format!("{name}.second_over_first"), own.get("second_over_first"));
        }
        numbers
    }

    fn draw(
        &self,
        staging: &Staging,
        options: &ResponsesOptions,
        places: &Places,
        numbers: &mut Numbers,
    ) -> Result<(), WriteError> {
        let first = &self.recordings[0];
        let bending = options.drive.ends_with("_deg");
        let (moving, y) = if bending { ("_deg", "angle, degrees") } else { ("_N", "force, N") };
        let signals: Vec<(&str, &[f64])> = first
            .moves
            .iter()
            .filter(|channel| channel.name.ends_with(moving))
            .map(|channel| (channel.name.as_str(), channel.values.as_slice()))
            .collect();
        staging.draw("moves", |png, svg| figures::moves(&first.time_s, &signals, y, png, svg))?;
        // One cycle of bending, as Fig. 32.
        let rows = match &self.cycles[0].legs[..] {
            [a, b, ..] if bending => a.rows.start..b.rows.end,
            _ => 0..first.time_s.len(),
        };
        let outputs: Vec<(String, &[f64])> =
            first.outputs.iter().map(|channel| (channel.name.clone(), &channel.values[rows.clone()])).collect();
        staging
            .draw("outputs", |png, svg| figures::outputs(&first.time_s[rows.clone()], &outputs, places, png, svg))?;
        staging.draw("averages", |png, svg| figures::averages(&self.curves, &options.drive, places, png, svg))?;
        if let (true, Some(j2), Some(j3)) = (bending, first.of("J2_deg"), first.of("J3_deg"))
            && let Some(([offset, slope], r2)) = straight(j2, j3)
        {
            numbers.set("coupling_slope", slope);
            numbers.set("coupling_r2", r2);
            staging.draw("coupling", |png, svg| figures::coupling(j2, j3, [offset, slope], r2, png, svg))?;
        }
        Ok(())
    }
}

/// The straight line through points, offset and slope, and its R2.
fn straight(x: &[f64], y: &[f64]) -> Option<([f64; 2], f64)> {
    let points: Vec<[f64; 2]> =
        x.iter().zip(y).filter(|(x, y)| x.is_finite() && y.is_finite()).map(|(&x, &y)| [x, y]).collect();
    let slope = measure::slope(&points)?;
    let [x, y] = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / points.len() as f64);
    let offset = y - slope * x;
    let left: f64 = points.iter().map(|p| (p[1] - offset - slope * p[0]).powi(2)).sum();
    let all: f64 = points.iter().map(|p| (p[1] - y).powi(2)).sum();
    (all > 0.0).then(|| ([offset, slope], 1.0 - left / all))
}
