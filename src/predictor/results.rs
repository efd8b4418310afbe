//! What evaluate, analyse, prune and compare write into their folder: tables, pictures and the report `run.json`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use ndarray::Array2;
use serde::Serialize;

use super::analyse::AnalyseReport;
use super::compare::{CompareReport, Comparison};
use super::error::PredictorError;
use super::evaluate::{EvaluateReport, Predicted};
use super::figures::{
    self, BarSeries, Bars, MagnitudeBin, Modes, SubsetSeries, draw_bars, draw_best_subsets, draw_error_by_magnitude,
    draw_modes, draw_over_time, draw_scatter,
};
use super::merit_table::{MERIT, evaluated, merit_table};
use super::prune::{PruneReport, PruneRow};
use crate::files::Staging;
use crate::stages::{Stage, Stages, Step};
use crate::table::{Column, TableWriter, Value};

/// A folder for a job's results, and which of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FolderOutputs {
    /// The folder.
    pub folder: PathBuf,
    /// Whether what is a row a row of the recordings is written: the table of predictions.
    pub rows: bool,
    /// Whether pictures are drawn.
    pub figures: bool,
    /// Whether the report is written, with its times and the files' places.
    pub report: bool,
}

impl FolderOutputs {
    /// All there is.
    #[must_use]
    pub fn all(folder: PathBuf) -> Self {
        Self { folder, rows: true, figures: true, report: true }
    }

    /// A step of plans for the pictures; `what` they show.
    pub(super) fn figures_step(outputs: Option<&Self>, what: &str) -> Step {
        match outputs {
            None => Step::new("figures", false, "no --out".to_owned()),
            Some(outputs) if outputs.figures => Step::new("figures", true, what.to_owned()),
            Some(_) => Step::new("figures", false, "not asked for".to_owned()),
        }
    }

    /// A step of plans for a table that is always written where there is a folder.
    pub(super) fn table_step(outputs: Option<&Self>, what: &str) -> Step {
        let there = outputs.is_some();
        Step::new("tables", there, if there { what } else { "no --out" }.to_owned())
    }
}

/// Draws a picture as PNG and SVG; tells where the PNG will stand.
fn picture(
    staging: &Staging,
    out: &Path,
    name: &str,
    draw: impl FnOnce(&Path, &Path) -> anyhow::Result<()>,
) -> Result<std::path::PathBuf, PredictorError> {
    let [png, svg] = ["png", "svg"].map(|ending| format!("{name}.{ending}"));
    draw(&staging.place(&png)?, &staging.place(&svg)?).map_err(|why| staging.refused(&png, format!("{why:#}")))?;
    Ok(out.join(png))
}

/// Writes the report and puts everything into its place.
fn finish<R: Serialize>(
    staging: Staging,
    out: &FolderOutputs,
    report: &mut R,
    timed: impl FnOnce(&mut R, Vec<Stage>, f64),
    stages: &Stages,
    start: Instant,
) -> Result<(), PredictorError> {
    timed(report, stages.list(), start.elapsed().as_secs_f64());
    if out.report {
        let text = serde_json::to_string_pretty(report).expect("plain data with names as keys") + "\n";
        staging.write("run.json", text.as_bytes())?;
    }
    staging.commit()?;
    Ok(())
}

/// `merit.csv`, `predicted.csv`, predicted against measured over time and as scatter, errors by size, held-out parts.
pub(super) fn evaluation(
    report: &mut EvaluateReport,
    shown: &Predicted,
    out: &FolderOutputs,
    stages: &Stages,
    start: Instant,
) -> Result<(), PredictorError> {
    let folder = &out.folder;
    let staging = Staging::new(folder)?;
    let merit = staging.place(MERIT)?;
    stages.time("write", || merit_table(&merit, &folder.join(MERIT), &evaluated(report)))?;
    if out.rows {
        stages.time("write", || predicted_table(&staging, folder, shown))?;
    }
    if out.figures {
        report.pictures = stages.time("figures", || evaluation_pictures(&staging, folder, report, shown))?;
    }
    let timed = |report: &mut EvaluateReport, stages, wall_s| (report.stages, report.wall_s) = (stages, wall_s);
    finish(staging, out, report, timed, stages, start)
}

/// Over time, scatter, errors by size, parts held out; tells where the PNGs will stand.
fn evaluation_pictures(
    staging: &Staging,
    folder: &Path,
    report: &EvaluateReport,
    shown: &Predicted,
) -> Result<Vec<PathBuf>, PredictorError> {
    let title = shown.title.as_str();
    let widths = shown.half_width.as_ref().map(|(half, level)| {
        let half = Array2::from_shape_fn(shown.values.dim(), |(_, target)| half[target]);
        ([&shown.values - &half, &shown.values + &half], *level)
    });
    let mut drawn = figures::Predicted::of(&shown.data, shown.values.view());
    drawn.interval = widths.as_ref().map(|([low, high], level)| ([low.view(), high.view()], *level));
    let mut pictures = vec![
        picture(staging, folder, "over-time", |png, svg| draw_over_time(&drawn, title, png, svg))?,
        picture(staging, folder, "scatter", |png, svg| draw_scatter(&drawn, title, png, svg))?,
    ];
    if let Some(found) = &report.by_magnitude {
        let bins: Vec<MagnitudeBin> = found
            .bins
            .iter()
            .map(|bin| MagnitudeBin {
                from: bin.from,
                to: Some(bin.to),
                rows: bin.merit.rows,
                rmse: bin.merit.rmse.0.iter().map(|(_, rmse)| rmse.is_finite().then_some(*rmse)).collect(),
            })
            .collect();
        let unit = if found.of.ends_with("_deg") { "degrees" } else { "N" };
        pictures.push(picture(staging, folder, "by-magnitude", |png, svg| {
            draw_error_by_magnitude(title, unit, shown.data.targets(), &bins, png, svg)
        })?);
    }
    if let Some(found) = &report.held_out {
        let names = std::iter::once("all".to_owned()).chain(found.parts.iter().map(|part| part.name.clone()));
        let merits: Vec<_> =
            std::iter::once(Some(&found.pooled)).chain(found.parts.iter().map(|part| part.merit.as_ref())).collect();
        let one = |(target, name): (usize, &String)| BarSeries {
            name: name.clone(),
            values: merits.iter().map(|merit| merit.map(|merit| merit.rmse.0[target].1)).collect(),
            errors: Vec::new(),
        };
        let bars = Bars {
            title: format!("{title}: each part held out in turn"),
            x_label: "held out".to_owned(),
            y_label: "RMSE".to_owned(),
            groups: names.collect(),
            series: shown.data.targets().iter().enumerate().map(one).collect(),
        };
        pictures.push(picture(staging, folder, "held-out", |png, svg| draw_bars(&bars, png, svg))?);
    }
    Ok(pictures)
}

fn predicted_table(staging: &Staging, folder: &Path, shown: &Predicted) -> Result<(), PredictorError> {
    let name = "predicted.csv";
    let targets = shown.data.targets();
    let mut columns = vec![Column::number("time_s")];
    columns.extend(targets.iter().map(Column::number));
    columns.extend(targets.iter().map(|target| Column::number(format!("{target}_predicted"))));
    columns.extend(["recording", "session", "subject"].map(Column::text));
    let mut table = TableWriter::create(&staging.place(name)?, &folder.join(name), columns, &[])?;
    let recordings = shown.data.recordings();
    table.write_rows(shown.data.rows(), &|row, write| {
        let one = &recordings[recordings.partition_point(|one| one.rows.end <= row)];
        let mut cells = vec![Value::Number(shown.data.time_s()[row])];
        cells.extend(shown.data.y().row(row).iter().chain(shown.values.row(row)).map(|value| Value::Number(*value)));
        cells.extend([&one.name, &one.session, &one.subject].map(|text| Value::Text(text)));
        write(&cells);
    })?;
    Ok(table.finish()?)
}

/// `modes.csv` and Fig. 98.
pub(super) fn analysis(
    report: &mut AnalyseReport,
    out: &FolderOutputs,
    stages: &Stages,
    start: Instant,
) -> Result<(), PredictorError> {
    let folder = &out.folder;
    let staging = Staging::new(folder)?;
    let modes = &report.modes.modes;
    let names: Vec<&String> = report.targets.iter().chain(&report.inputs).collect();
    let mut columns = vec![Column::integer("mode"), Column::number("singular_value")];
    columns.extend(names.iter().map(|name| Column::number(*name)));
    let mut table = TableWriter::create(&staging.place("modes.csv")?, &folder.join("modes.csv"), columns, &[])?;
    for (k, mode) in modes.iter().enumerate() {
        let mut cells = vec![Value::Integer(k as i64 + 1), Value::Number(mode.singular_value)];
        cells.extend(mode.targets.0.iter().chain(&mode.inputs.0).map(|(_, value)| Value::Number(*value)));
        table.write(&cells)?;
    }
    table.finish()?;
    if out.figures {
        report.pictures = vec![stages.time("figures", || modes_picture(&staging, folder, report))?];
    }
    let timed = |report: &mut AnalyseReport, stages, wall_s| (report.stages, report.wall_s) = (stages, wall_s);
    finish(staging, out, report, timed, stages, start)
}

/// Fig. 98.
fn modes_picture(staging: &Staging, folder: &Path, report: &AnalyseReport) -> Result<PathBuf, PredictorError> {
    let modes = &report.modes.modes;
    let of = |by: fn(&super::analyse::ModelMode) -> &[(String, f64)], rows: usize| {
        Array2::from_shape_fn((rows, modes.len()), |(row, mode)| by(&modes[mode])[row].1)
    };
    let left = of(|mode| &mode.targets.0, report.targets.len());
    let right = of(|mode| &mode.inputs.0, report.inputs.len());
    let values: Vec<f64> = modes.iter().map(|mode| mode.singular_value).collect();
    let unit = lunula_predictor::unit_of(&report.targets[0]);
    let unit = if unit.is_empty() { String::new() } else { format!("{unit}/V") };
    let drawn = Modes {
        targets: &report.targets,
        inputs: &report.inputs,
        values: &values,
        unit: &unit,
        of_targets: left.view(),
        of_inputs: right.view(),
    };
    picture(staging, folder, "modes", |png, svg| draw_modes(&drawn, png, svg))
}

/// `subsets.csv`, Fig. 113 and the best subset of each size.
pub(super) fn pruning(
    report: &mut PruneReport,
    out: &FolderOutputs,
    stages: &Stages,
    start: Instant,
) -> Result<(), PredictorError> {
    let folder = &out.folder;
    let staging = Staging::new(folder)?;
    let mut columns = vec![Column::integer("photodiodes"), Column::text("inputs"), Column::integer("rank")];
    for kind in ["train", "validate"] {
        columns.extend(report.targets.iter().map(|target| Column::number(format!("{target}_{kind}_rmse"))));
    }
    columns.push(Column::number("score"));
    let mut table = TableWriter::create(&staging.place("subsets.csv")?, &folder.join("subsets.csv"), columns, &[])?;
    for row in &report.all {
        let inputs = row.inputs.join(" ");
        let mut cells =
            vec![Value::Integer(row.inputs.len() as i64), Value::Text(&inputs), Value::Integer(row.rank as i64)];
        for errors in [&row.train_rmse, &row.validate_rmse] {
            match errors {
                Some(errors) => cells.extend(errors.0.iter().map(|(_, value)| Value::Number(*value))),
                None => cells.extend(report.targets.iter().map(|_| Value::Missing)),
            }
        }
        cells.push(Value::from(row.score));
        table.write(&cells)?;
    }
    table.finish()?;
    let mut pictures = Vec::new();
    if out.figures && !report.without_one.is_empty() {
        let bars = without_one(report);
        pictures.push(
            stages
                .time("figures", || picture(&staging, folder, "without-one", |png, svg| draw_bars(&bars, png, svg)))?,
        );
    }
    let series = SubsetSeries {
        name: "mean of the targets".to_owned(),
        best: report
            .best_of_size
            .iter()
            .filter_map(|row| Some(figures::Subset { photodiodes: row.inputs.clone(), error: row.score? }))
            .collect(),
    };
    if out.figures && !series.best.is_empty() {
        let (title, label) = ("the best photodiodes of each number", "validation RMSE over the target's SD");
        pictures.push(stages.time("figures", || {
            picture(&staging, folder, "best-of-size", |png, svg| {
                draw_best_subsets(title, label, &report.inputs, &[series], png, svg)
            })
        })?);
    }
    report.pictures = pictures;
    let timed = |report: &mut PruneReport, stages, wall_s| (report.stages, report.wall_s) = (stages, wall_s);
    finish(staging, out, report, timed, stages, start)
}

/// Fig. 113's bars.
fn without_one(report: &PruneReport) -> Bars {
    let removed = |row: &PruneRow| {
        report.inputs.iter().find(|name| !row.inputs.contains(name)).map_or("none".to_owned(), Clone::clone)
    };
    let one = |(target, name): (usize, &String)| BarSeries {
        name: name.clone(),
        values: report.without_one.iter().map(|row| row.validate_rmse.as_ref().map(|by| by.0[target].1)).collect(),
        errors: Vec::new(),
    };
    Bars {
        title: "the linear model on validation recordings without a photodiode".to_owned(),
        x_label: "removed".to_owned(),
        y_label: "validation RMSE".to_owned(),
        groups: report.without_one.iter().map(removed).collect(),
        series: report.targets.iter().enumerate().map(one).collect(),
    }
}

/// `comparisons.csv` and Fig. 105-113.
pub(super) fn comparison(
    report: &mut CompareReport,
    out: &FolderOutputs,
    stages: &Stages,
    start: Instant,
) -> Result<(), PredictorError> {
    let folder = &out.folder;
    let staging = Staging::new(folder)?;
    let name = "comparisons.csv";
    let mut columns = ["figure", "group", "series", "unit"].map(Column::text).to_vec();
    columns.extend(["rmse_mean", "rmse_sd"].map(Column::number));
    columns.push(Column::integer("people"));
    let mut table = TableWriter::create(&staging.place(name)?, &folder.join(name), columns, &[])?;
    for one in &report.comparisons {
        for (group, cells) in one.groups.iter().zip(&one.cells) {
            for (series, cell) in one.series.iter().zip(cells) {
                let known = cell.values.iter().flatten().count();
                let [figure, group, series, unit] = [&one.figure, group, series, one.unit].map(Value::Text);
                let (mean, sd) = (Value::from(cell.mean), Value::from(cell.sd));
                table.write(&[figure, group, series, unit, mean, sd, Value::Integer(known as i64)])?;
            }
        }
    }
    table.finish()?;
    let people = report.people.len();
    let draw = |one: &Comparison| {
        let bars = compared(one, people);
        picture(&staging, folder, &format!("fig-{}", one.figure), |png, svg| draw_bars(&bars, png, svg))
    };
    if out.figures {
        report.pictures =
            stages.time("figures", || report.comparisons.iter().map(draw).collect::<Result<Vec<_>, _>>())?;
    }
    let timed = |report: &mut CompareReport, stages, wall_s| (report.stages, report.wall_s) = (stages, wall_s);
    finish(staging, out, report, timed, stages, start)
}

/// A figure's bars: the mean over people, marked with their SD.
fn compared(one: &Comparison, people: usize) -> Bars {
    let series = |(k, name): (usize, &String)| BarSeries {
        name: name.clone(),
        values: one.cells.iter().map(|cells| cells[k].mean).collect(),
        errors: one.cells.iter().map(|cells| cells[k].sd).collect(),
    };
    Bars {
        title: one.title.clone(),
        x_label: if one.groups[0] == "none" { "removed".to_owned() } else { String::new() },
        y_label: format!("RMSE, {} (mean and SD of {people})", one.unit),
        groups: one.groups.clone(),
        series: one.series.iter().enumerate().map(series).collect(),
    }
}
