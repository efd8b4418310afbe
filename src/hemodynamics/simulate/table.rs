//! The table of a run: `time_s,xC1_m,..,xV_m,vC1_mps,..,vV_mps,VP1,..`, and the loads where they are wanted.

use std::path::Path;

use lunula_hemodynamics::{Inputs, Loads, Parameters};

use crate::hemodynamics::given::{BLOOD, PRESSED, TIME, state_columns};
use crate::hemodynamics::{HemodynamicsError, Response};
use crate::table::{Column, TableWriter, Value};

/// Writes the table that is to stand at `path` to `at`.
pub(super) fn write(
    parameters: &Parameters,
    response: &Response,
    loads: Option<&Loads>,
    at: &Path,
    path: &Path,
) -> Result<(), HemodynamicsError> {
    let units = parameters.units().len();
    let [x, v] = state_columns(units);
    let mut columns = vec![Column::number(TIME)];
    columns.extend(x.into_iter().chain(v).map(Column::number));
    columns.extend((1..=units).map(|i| Column::number(format!("VP{i}"))));
    if loads.is_some() {
        columns.extend(PRESSED.into_iter().chain(BLOOD).map(Column::number));
    }
    let facts = [
        ("lunula", env!("CARGO_PKG_VERSION")),
        (
            "x",
            "displacements of the walls from the nominal diameters, metres; capillaries C from proximal to distal, \
             vein V",
        ),
        ("v", "their velocities, metres a second"),
        ("VP", "photodiodes, volts"),
    ];
    let facts = facts.map(|(key, value)| (key.to_owned(), value.to_owned()));
    let mut table = TableWriter::create(at, path, columns, &facts)?;
    table.write_rows(response.rows(), &|row, write| {
        let mut cells = vec![Value::Number(response.times_s[row])];
        cells.extend((0..=units).map(|j| Value::Number(response.displacement_m(parameters, row, j))));
        cells.extend((0..=units).map(|j| Value::Number(response.velocity_mps(parameters, row, j))));
        cells.extend((0..units).map(|i| Value::Number(response.volts[row * units + i])));
        if let Some(loads) = loads {
            let Inputs { proximal_pa, distal_pa, upstream_pa, downstream_pa } = loads.at(response.times_s[row]);
            cells.extend([proximal_pa, distal_pa, upstream_pa, downstream_pa].map(Value::Number));
        }
        write(&cells);
    })?;
    Ok(table.finish()?)
}
