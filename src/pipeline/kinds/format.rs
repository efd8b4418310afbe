//! The tables' formats.

use super::given::Given;
use crate::pipeline::KeyFault;
use crate::table::TableFormat;

/// The key that names a table's format.
pub(super) const FORMAT: &str = "format";

/// CSV where nothing is said.
pub(super) fn format(given: &mut Given) -> Result<TableFormat, KeyFault> {
    let choices = [("csv", TableFormat::Csv), ("parquet", TableFormat::Parquet)];
    Ok(given.choice(FORMAT, &choices)?.unwrap_or(TableFormat::Csv))
}

/// The name of a table, of the two that it can have.
pub(super) fn named(format: TableFormat, csv: &'static str, parquet: &'static str) -> &'static str {
    match format {
        TableFormat::Csv => csv,
        TableFormat::Parquet => parquet,
    }
}
