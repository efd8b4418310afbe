//! An evaluation's tables and pictures.

use std::path::{Path, PathBuf};

use ndarray::Array2;

use crate::files::Staging;
use crate::predictor::error::PredictorError;
use crate::predictor::figures::{
    self, BarSeries, Bars, MagnitudeBin, draw_bars, draw_error_by_magnitude, draw_over_time, draw_scatter,
};
use crate::predictor::jobs::evaluate::report::{EvaluateReport, Magnitudes, Predicted};
use crate::predictor::merit::table::{MERIT, MeritRows, merit_table};
use crate::predictor::outputs::{FolderOutputs, picture};
use crate::stages::Stages;
use crate::table::{Column, TableWriter, Value};

/// `merit.csv`, `predicted.csv`, predicted against measured over time and as scatter, errors by size, held-out parts.
pub(super) fn write(
    report: &mut EvaluateReport,
    shown: &Predicted,
    out: &FolderOutputs,
    stages: &Stages,
) -> Result<Staging, PredictorError> {
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
    Ok(staging)
}

/// Over time, scatter, errors by size, parts held out; returns where the PNGs will be.
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
