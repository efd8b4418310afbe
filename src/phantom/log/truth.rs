//! What is true of a log, as tables: each row's, and each contact's.

use std::path::Path;

use super::lines::{CONTACT, FORCES, photodiodes};
use super::{LogOptions, Row};
use crate::phantom::motion::finger::JOINTS;
use crate::table::{Column, TableError, TableWriter, Value};
use crate::words::Words;

fn says_contact(options: &LogOptions) -> bool {
    options.contact || options.contacts().is_some()
}

pub(super) fn true_columns(options: &LogOptions) -> Vec<Column> {
    let mut columns = vec![Column::integer("sample"), Column::number("time_s"), Column::number("log_s")];
    columns.push(Column::integer("led"));
    columns.extend(says_contact(options).then(|| Column::integer(CONTACT)));
    columns.extend(JOINTS.map(|joint| Column::number(format!("{joint}_deg"))));
    columns.extend(FORCES.map(Column::number));
    columns.extend(
        ["", "_static", "_unlit"].into_iter().flat_map(|suffix| photodiodes(options, suffix)).map(Column::number),
    );
    columns
}

pub(super) fn true_cells(options: &LogOptions, row: &Row) -> Vec<Value<'static>> {
    let mut cells = vec![Value::Integer(row.sample as i64), Value::Number(row.scene_s), Value::Number(row.log_s)];
    cells.push(Value::Integer(row.lit.into()));
    cells.extend(says_contact(options).then(|| Value::Integer(row.contact.into())));
    cells.extend(row.touch.angles_rad.map(|angle| Value::Number(angle.to_degrees())));
    cells.extend(row.touch.forces_n.map(Value::Number));
    for volts in [row.led_v, row.static_v, row.unlit_v] {
        cells.extend(volts[..options.channels()].iter().copied().map(Value::Number));
    }
    cells
}

/// Writes the contacts and near misses of a log whose finger makes them; those that its first and last sample cut are
/// left out.
pub(super) fn write_contacts(options: &LogOptions, path: &Path) -> Result<(), TableError> {
    let Some(contacts) = options.contacts() else { return Ok(()) };
    let mut columns = vec![Column::text("kind")];
    columns.extend(["start_s", "end_s", "log_start_s", "log_end_s", "peak_N"].map(Column::number));
    let mut table = TableWriter::create(path, path, columns, &[])?;
    let within = -options.lead_s..=options.seconds + options.trail_s;
    for contact in contacts.until(options.seconds) {
        let [start_s, end_s] = contact.span_s();
        if !within.contains(&start_s) || !within.contains(&end_s) {
            continue;
        }
        let mut cells = vec![Value::Text(contact.kind.word())];
        cells.extend([start_s, end_s, options.log_s(start_s), options.log_s(end_s), contact.peak_n].map(Value::Number));
        table.write(&cells)?;
    }
    table.finish()
}
