//! `skill.csv`: one row per finger and trial.

use std::path::Path;

use super::report::{MEASURES, SkillFigures};
use crate::files::Places;
use crate::live::error::LiveError;
use crate::table::{Column, TableWriter, Value};

/// The table's name.
pub(super) const TABLE: &str = "skill.csv";

/// Writes the table.
pub(super) fn write(figures: &SkillFigures, folder: &Path, places: &mut Places) -> Result<(), LiveError> {
    let path = folder.join(TABLE);
    let mut columns = ["subject", "trial", "recording", "finger"].map(Column::text).to_vec();
    columns.extend(["known_s", "unknown_s"].map(Column::number));
    columns.push(Column::integer("cut"));
    columns.extend(MEASURES.iter().map(|measure| Column::number(measure.name)));
    columns.push(Column::integer("rank"));
    let mut table = TableWriter::create(&places.place(&path)?, &path, columns, &[])?;
    for trial in &figures.trials {
        for one in &trial.fingers {
            let mut cells = vec![
                trial.subject.as_deref().map_or(Value::Missing, Value::Text),
                Value::Text(&trial.trial),
                Value::Text(&trial.recording),
                Value::Text(&one.finger),
                Value::Number(one.figures.known_s),
                Value::Number(one.figures.unknown_s),
                Value::Integer(one.figures.cut as i64),
            ];
            cells.extend(MEASURES.iter().map(|measure| Value::from((measure.of)(one))));
            cells.push(one.rank.map_or(Value::Missing, |rank| Value::Integer(rank as i64)));
            table.write(&cells)?;
        }
    }
    Ok(table.finish()?)
}
