//! `responses.csv`: averages over cycles, a row for each bin, direction and photodiode.

use std::path::Path;

use super::ResponsesError;
use super::curve::Curve;
use lunula::files::Staging;
use lunula::table::{Column, TableWriter, Value};

/// Writes the table.
pub(super) fn write(staging: &Staging, out: &Path, curves: &[(String, Curve)]) -> Result<(), ResponsesError> {
    let name = "responses.csv";
    let columns = vec![
        Column::text("photodiode"),
        Column::text("direction"),
        Column::rounded("at", 6),
        Column::rounded("mean_V", 9),
        Column::rounded("sd_V", 9),
        Column::integer("legs"),
    ];
    let mut table = TableWriter::create(&staging.place(name)?, &out.join(name), columns, &[])?;
    for (photodiode, curve) in curves {
        for (direction, points) in [("rising", &curve.rising), ("falling", &curve.falling)] {
            for (at, point) in curve.at.iter().zip(points) {
                table.write(&[
                    Value::Text(photodiode),
                    Value::Text(direction),
                    Value::Number(*at),
                    Value::from(point.map(|point| point.mean)),
                    Value::from(point.and_then(|point| point.sd)),
                    Value::Integer(point.map_or(0, |point| point.legs as i64)),
                ])?;
            }
        }
    }
    table.finish()?;
    Ok(())
}
