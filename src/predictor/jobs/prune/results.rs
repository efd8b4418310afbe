//! `subsets.csv`, Fig. 113 and the best subset of each size.

use std::path::Path;

use crate::figure::draw_charts;
use crate::files::Staging;
use crate::job::Outputs;
use crate::predictor::error::PredictorError;
use crate::predictor::figures::{BarSeries, Bars, Subset, WIDTH, best_subsets, draw_bars};
use crate::predictor::jobs::prune::report::{PruneReport, PruneRow};
use crate::stages::Stages;
use crate::table::{Column, TableWriter, Value};

/// `subsets.csv`, Fig. 113 and the best subset of each size.
pub(super) fn write(report: &mut PruneReport, out: &Outputs, stages: &Stages) -> Result<Staging, PredictorError> {
    let folder = &out.out;
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
        let drawn = stages.time("figures", || staging.draw("without-one", |png, svg| draw_bars(&[bars], png, svg)));
        pictures.push(drawn?);
    }
    let subset = |row: &PruneRow| Some(Subset { photodiodes: row.inputs.clone(), error: row.score? });
    let best: Vec<Subset> = report.best_of_size.iter().filter_map(subset).collect();
    if out.figures && !best.is_empty() {
        let (title, label) = ("the best photodiodes of each number", "validation RMSE over the target's SD");
        let chart = best_subsets(title, label, &report.inputs, "mean of the targets", &best);
        let draw = |png: &Path, svg: &Path| draw_charts(&[chart], WIDTH, png, svg);
        pictures.push(stages.time("figures", || staging.draw("best-of-size", draw))?);
    }
    report.pictures = pictures;
    Ok(staging)
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
