//! An evaluation's tables and pictures.

use std::path::{Path, PathBuf};

use lunula_predictor::Eigennails;
use ndarray::Array2;

use crate::figure::draw_charts;
use crate::files::Staging;
use crate::job::Outputs;
use crate::predictor::error::PredictorError;
use crate::predictor::figures::{
    self, BarSeries, Bars, WIDTH, draw_bars, draw_nails, draw_scatter, error_by_magnitude, over_time,
};
use crate::predictor::jobs::evaluate::report::{EvaluateReport, Magnitudes, Predicted, Splits};
use crate::predictor::jobs::evaluate::splits::way;
use crate::predictor::merit::table::{MERIT, MeritRows, merit_table};
use crate::stages::Stages;
use crate::table::{Column, TableWriter, Value};

/// `merit.csv`, `predicted.csv`, predicted against measured over time and as scatter, errors by size, held-out parts.
pub(super) fn write(
    report: &mut EvaluateReport,
    shown: &Predicted,
    eigennails: Option<&Eigennails>,
    out: &Outputs,
    stages: &Stages,
) -> Result<Staging, PredictorError> {
    let folder = &out.out;
    let staging = Staging::new(folder)?;
    let merit = staging.place(MERIT)?;
    stages.time("write", || merit_table(&merit, &folder.join(MERIT), &evaluated(report)))?;
    if out.rows {
        stages.time("write", || predicted_table(&staging, folder, shown))?;
    }
    if let Some(found) = &report.splits {
        stages.time("write", || splits_table(&staging, folder, found))?;
    }
    if out.figures {
        let mut pictures = stages.time("figures", || evaluation_pictures(&staging, report, shown))?;
        if let Some(model) = eigennails {
            let names: Vec<String> = shown.data.inputs().to_vec();
            pictures.push(staging.draw("eigennails", |png, svg| draw_nails(model, &names, png, svg))?);
        }
        report.pictures = pictures;
    }
    Ok(staging)
}

/// Over time, scatter, errors by size, parts held out; returns where the PNGs will be.
fn evaluation_pictures(
    staging: &Staging,
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
        staging.draw("over-time", |png, svg| draw_charts(&over_time(&drawn, title), WIDTH, png, svg))?,
        staging.draw("scatter", |png, svg| draw_scatter(&drawn, title, png, svg))?,
    ];
    if let Some(found) = &report.by_magnitude {
        let unit = if found.of.ends_with("_deg") { "degrees" } else { "N" };
        let bars = error_by_magnitude(title, unit, shown.data.targets(), &found.bins);
        pictures.push(staging.draw("by-magnitude", |png, svg| draw_bars(&[bars], png, svg))?);
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
        pictures.push(staging.draw("held-out", |png, svg| draw_bars(&[bars], png, svg))?);
    }
    if let Some(found) = &report.splits {
        let charts: Vec<Bars> = shown.data.targets().iter().map(|target| split_bars(found, target)).collect();
        pictures.push(staging.draw("splits", |png, svg| draw_bars(&charts, png, svg))?);
    }
    Ok(pictures)
}

/// A target's errors by each way that holds something out, with half the width of their intervals.
fn split_bars(found: &Splits, target: &str) -> Bars {
    let there: Vec<_> = found.ways.iter().filter(|split| split.parts > 0 && split.same_as.is_none()).collect();
    let methods = there.first().map_or(&[][..], |split| &split.methods[..]);
    let of = |split: &&lunula_predictor::Split, method: usize| {
        split.methods[method].targets.iter().find(|one| one.name == target).cloned()
    };
    let series = |(method, one): (usize, &lunula_predictor::MethodScore)| BarSeries {
        name: one.method.clone(),
        values: there.iter().map(|split| Some(of(split, method)?.rmse).filter(|rmse| rmse.is_finite())).collect(),
        errors: there.iter().map(|split| of(split, method)?.interval.map(|[low, high]| 0.5 * (high - low))).collect(),
    };
    Bars {
        title: format!("{target}: what is held out decides what looks good (marks: as wide as the 95 % intervals)"),
        x_label: "held out (intervals by rows are about these recordings only, the others about new ones)".to_owned(),
        y_label: format!("RMSE {}", lunula_predictor::unit_of(target)),
        groups: there.iter().map(|split| format!("{}\n{} parts", way(split.by), split.parts)).collect(),
        series: methods.iter().enumerate().map(series).collect(),
    }
}

/// `splits.csv`: a row for each way, method and target.
fn splits_table(staging: &Staging, folder: &Path, found: &Splits) -> Result<(), PredictorError> {
    let name = "splits.csv";
    let mut columns =
        vec![Column::text("by"), Column::integer("parts"), Column::text("method"), Column::text("target")];
    columns.push(Column::integer("rows"));
    columns.extend(["rmse", "rmse_low", "rmse_high"].map(Column::number));
    columns.extend(["beats_mean", "fault"].map(Column::text));
    let mut table = TableWriter::create(&staging.place(name)?, &folder.join(name), columns, &[])?;
    for split in &found.ways {
        let (by, parts) = (Value::Text(way(split.by)), Value::Integer(split.parts as i64));
        let none = Value::Number(f64::NAN);
        if let Some(fault) = &split.fault {
            let empty = Value::Text("");
            table.write(&[by, parts, empty, empty, Value::Integer(0), none, none, none, empty, Value::Text(fault)])?;
        }
        for one in &split.methods {
            let fault = Value::Text(one.fault.as_deref().unwrap_or_default());
            let (method, rows) = (Value::Text(&one.method), Value::Integer(one.rows as i64));
            if one.targets.is_empty() {
                table.write(&[by, parts, method, Value::Text(""), rows, none, none, none, Value::Text(""), fault])?;
            }
            for target in &one.targets {
                let ends = target.interval.unwrap_or([f64::NAN; 2]).map(Value::Number);
                let beats = target.beats_mean.map_or("", |beats| if beats { "yes" } else { "no" });
                let (name, rmse) = (Value::Text(&target.name), Value::Number(target.rmse));
                table.write(&[by, parts, method, name, rows, rmse, ends[0], ends[1], Value::Text(beats), fault])?;
            }
        }
    }
    Ok(table.finish()?)
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

/// All rows of an evaluation's table.
fn evaluated(report: &EvaluateReport) -> Vec<MeritRows<'_>> {
    let mut all = vec![MeritRows { within: report.coverage.as_ref(), ..MeritRows::new("all", &report.merit) }];
    all.extend(report.recordings.iter().map(|one| MeritRows {
        name: one.recording.clone(),
        session: &one.session,
        subject: &one.subject,
        ..MeritRows::new("recording", &one.merit)
    }));
    if let Some(Magnitudes { of, bins }) = &report.by_magnitude {
        let name = |from: f64, to: f64| format!("{of} {from}..{to}");
        all.extend(
            bins.iter().map(|bin| MeritRows { name: name(bin.from, bin.to), ..MeritRows::new("size", &bin.merit) }),
        );
    }
    all.extend(report.without_friction.iter().map(|merit| MeritRows::new("without friction", merit)));
    if let Some(found) = &report.held_out {
        all.push(MeritRows::new("held out", &found.pooled));
        let parts = found.parts.iter().filter_map(|part| Some((part, part.merit.as_ref()?)));
        all.extend(
            parts.map(|(part, merit)| MeritRows { name: part.name.clone(), ..MeritRows::new("part held out", merit) }),
        );
    }
    all
}
