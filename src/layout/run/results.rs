//! `layout.json` and `layout.csv`.

use super::report::LayoutFigures;
use crate::files::{Places, json_text};
use crate::layout::error::LayoutError;
use crate::table::{Column, TableWriter, Value};

/// The chosen places.
pub(super) const POSITIONS: &str = "layout.json";
/// Every method for every number of photodiodes.
pub(super) const TABLE: &str = "layout.csv";

/// Writes both.
pub(super) fn write(figures: &LayoutFigures, places: &mut Places) -> Result<(), LayoutError> {
    places.write(&figures.folder.join(POSITIONS), &json_text(&figures.chosen.positions))?;
    let path = figures.folder.join(TABLE);
    let mut columns = vec![Column::integer("k"), Column::text("method"), Column::number("error")];
    columns.extend(["left_out_error", "left_out_se", "left_out_low", "left_out_high"].map(Column::number));
    columns.extend([Column::text("proof"), Column::number("bound"), Column::text("places")]);
    let mut table = TableWriter::create(&places.place(&path)?, &path, columns, &[])?;
    for one in &figures.methods {
        let (proof, names) = (one.proof().unwrap_or_default(), one.places.join(" "));
        let left_out = |of: fn(&crate::layout::LeftOut) -> f64| Value::from(one.left_out.as_ref().map(of));
        table.write(&[
            Value::Integer(one.k as i64),
            Value::Text(one.method.word()),
            Value::Number(one.error),
            left_out(|own| own.error),
            left_out(|own| own.se),
            left_out(|own| own.interval[0]),
            left_out(|own| own.interval[1]),
            Value::Text(&proof),
            Value::from(one.bound),
            Value::Text(&names),
        ])?;
    }
    Ok(table.finish()?)
}
