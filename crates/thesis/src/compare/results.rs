//! `comparisons.csv` and Fig. 105-113.

use crate::compare::comparison::Comparison;
use crate::compare::report::CompareReport;
use lunula::files::Staging;
use lunula::job::Outputs;
use lunula::predictor::{BarSeries, Bars, PredictorError, draw_bars};
use lunula::stages::Stages;
use lunula::table::{Column, TableWriter, Value};

/// `comparisons.csv` and Fig. 105-113.
pub(super) fn write(report: &mut CompareReport, out: &Outputs, stages: &Stages) -> Result<Staging, PredictorError> {
    let folder = &out.out;
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
        let bars = [compared(one, people)];
        staging.draw(&format!("fig-{}", one.figure), |png, svg| draw_bars(&bars, png, svg))
    };
    if out.figures {
        report.pictures =
            stages.time("figures", || report.comparisons.iter().map(draw).collect::<Result<Vec<_>, _>>())?;
    }
    Ok(staging)
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
