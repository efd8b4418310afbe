//! The rows of a table of subjects and sessions.

use std::path::Path;

use super::{World, plain};
use crate::job::Keys;
use crate::table::Table;

/// A table's rows, as text.
pub(super) struct Rows {
    /// The columns' names, in order.
    pub(super) columns: Vec<String>,
    /// Each row's cells, and its place.
    pub(super) rows: Vec<(Vec<String>, String)>,
    /// The folder that its cells are relative to, with `/`, as the pipeline file names it.
    pub(super) folder: String,
    /// Whether it is a generated one.
    pub(super) generated: bool,
}

/// Reads the table that the pipeline file calls `named`.
pub(super) fn read(named: &str, world: &World<'_>) -> Result<Rows, String> {
    let inside = named.strip_prefix("{phantom}/").map(plain);
    let table = match &inside {
        None => Table::read(&world.at(named)).map_err(|why| why.to_string())?,
        Some(path) => {
            let catalogue = world
                .catalogue
                .ok_or("`{phantom}` is named, but there is no [phantom]; add it, or name your own table")?;
            let text = catalogue.tables.get(path).ok_or_else(|| {
                let known: Vec<&str> = catalogue.tables.keys().map(String::as_str).collect();
                format!("`{named}` is no table of the generated recordings; they have {}", known.join(", "))
            })?;
            Table::of_csv(Path::new(named), text).map_err(|why| why.to_string())?
        }
    };
    let columns = table.names().to_vec();
    let mut rows: Vec<(Vec<String>, String)> =
        (0..table.rows()).map(|row| (Vec::with_capacity(columns.len()), table.row_place(row))).collect();
    for column in &columns {
        table.each_text(column, |row, text| rows[row].0.push(text.to_owned())).map_err(|why| why.to_string())?;
    }
    let path = inside.clone().unwrap_or_else(|| named.to_owned());
    let folder = path.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
    Ok(Rows { columns, rows, folder, generated: inside.is_some() })
}

impl Rows {
    /// Whether a column's cells all look like files' names; a column without any does not.
    pub(super) fn looks_like_files(&self, column: usize) -> bool {
        let mut cells =
            self.rows.iter().map(|(cells, _)| cells[column].as_str()).filter(|cell| !cell.is_empty()).peekable();
        cells.peek().is_some() && cells.all(is_like_a_file)
    }

    /// A row's cells by column, without the empty ones.
    pub(super) fn known(&self, row: usize, columns: impl Iterator<Item = usize>) -> Keys {
        let cells = &self.rows[row].0;
        let known = columns.filter(|&column| !cells[column].is_empty());
        Keys(known.map(|column| (self.columns[column].clone(), cells[column].clone())).collect())
    }
}

/// `video/S01.mp4`, `log.csv`, but not `1.5`.
fn is_like_a_file(cell: &str) -> bool {
    let ending = cell.rsplit_once('.').map(|(_, ending)| ending);
    let is_ending = |ending: &str| {
        ending.len() <= 8
            && ending.starts_with(|c: char| c.is_ascii_alphabetic())
            && ending.chars().all(|c| c.is_ascii_alphanumeric())
    };
    cell.contains('/') || ending.is_some_and(is_ending)
}
