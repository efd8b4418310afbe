//! The table of equilibria: `pf1_Pa,pf2_Pa,xC1_m,..,xV_m,VP1,..,branch,stable,tau_s,why`.

use std::path::Path;

use lunula_hemodynamics::Parameters;

use super::CurvePoint;
use crate::hemodynamics::HemodynamicsError;
use crate::hemodynamics::choices::Pressed;
use crate::hemodynamics::given::state_columns;
use crate::table::{Column, TableWriter, Value};

/// Why a row has no equilibrium.
const NONE: &str = "no equilibrium with open vessels";

/// Writes the table that is to stand at `path` to `at`.
pub(super) fn write(
    parameters: &Parameters,
    pressed: Pressed,
    points: &[CurvePoint],
    at: &Path,
    path: &Path,
) -> Result<(), HemodynamicsError> {
    let units = parameters.units().len();
    let [x, _] = state_columns(units);
    let mut columns: Vec<Column> = ["pf1_Pa", "pf2_Pa"].map(Column::number).to_vec();
    columns.extend(x.into_iter().map(Column::number));
    columns.extend((1..=units).map(|i| Column::number(format!("VP{i}"))));
    columns.extend([
        Column::integer("branch"),
        Column::integer("stable"),
        Column::number("tau_s"),
        Column::text("why"),
    ]);
    let facts = [
        ("lunula", env!("CARGO_PKG_VERSION")),
        ("x", "displacements of the walls from the nominal diameters, metres"),
        ("branch", "equilibria that go over into each other as the load changes have one number"),
        ("stable", "1: small changes die away; 0: they grow"),
        ("tau_s", "the slowest time constant, seconds"),
    ];
    let facts = facts.map(|(key, value)| (key.to_owned(), value.to_owned()));
    let mut table = TableWriter::create(at, path, columns, &facts)?;
    for point in points {
        let mut cells = pressed.of(point.load_pa).map(Value::Number).to_vec();
        match &point.lumens {
            Some(lumens) => {
                let moved = |(j, lumen): (usize, &f64)| parameters.wall(j).diameter_m * (lumen - 1.0);
                cells.extend(lumens.iter().enumerate().map(moved).map(Value::Number));
                cells.extend(point.volts.iter().copied().map(Value::Number));
            }
            None => cells.extend((0..2 * units + 1).map(|_| Value::Missing)),
        }
        cells.push(point.branch.map_or(Value::Missing, |branch| Value::Integer(branch as i64)));
        cells.push(point.stable.map_or(Value::Missing, |stable| Value::Integer(i64::from(stable))));
        cells.push(Value::from(point.slowest_s));
        cells.push(Value::Text(if point.lumens.is_none() { NONE } else { "" }));
        table.write(&cells)?;
    }
    Ok(table.finish()?)
}
