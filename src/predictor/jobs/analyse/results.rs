//! `modes.csv` and Fig. 98.

use std::path::PathBuf;

use ndarray::Array2;

use crate::files::Staging;
use crate::job::Outputs;
use crate::predictor::error::PredictorError;
use crate::predictor::figures::{Modes, draw_modes};
use crate::predictor::jobs::analyse::report::{AnalyseReport, ModelMode};
use crate::stages::Stages;
use crate::table::{Column, TableWriter, Value};

/// `modes.csv` and Fig. 98.
pub(super) fn write(report: &mut AnalyseReport, out: &Outputs, stages: &Stages) -> Result<Staging, PredictorError> {
    let folder = &out.out;
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
        report.pictures = vec![stages.time("figures", || modes_picture(&staging, report))?];
    }
    Ok(staging)
}

fn modes_picture(staging: &Staging, report: &AnalyseReport) -> Result<PathBuf, PredictorError> {
    let modes = &report.modes.modes;
    let of = |by: fn(&ModelMode) -> &[(String, f64)], rows: usize| {
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
    Ok(staging.draw("modes", |png, svg| draw_modes(&drawn, png, svg))?)
}
