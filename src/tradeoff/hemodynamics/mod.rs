//! The hemodynamic model over its solvers' settings: error against run time on step responses, and stability maps.
//!
//! Twenty responses of 4 s with 400 outputs each: steps of 0.1 to 1.0 N/cm2, released at 2 s, proximal and distal (Fig. 76, 77). The error
//! is the largest `|x - x_ref| / D` of any wall at any output; the reference is the full model by the method of order 13 at its tightest
//! tolerance, which tests of the crate tie to trajectories of 60 digits. Peers' figures come from a table that their own bench wrote.

mod maps;
mod modes;
mod peers;

use std::path::Path;

use anyhow::Context;

use super::{Row, write_panels};
use crate::figure::{Axis, Plot, Point, Series};

pub use maps::{Map, stability};
pub use modes::{Settings, measure};
pub use peers::read_peers;

/// What the error is.
pub(super) const ERROR: &str = "largest |x - x_ref| / D over 20 step responses, full model";

/// Series of a panel; more than there are colours go to the next one.
const SERIES: usize = 5;

/// Writes the table and picture of the modes and peers, and of the maps.
///
/// # Errors
/// Where a file can't be written.
pub fn write(rows: &[Row], peers: &[Row], maps: &[Map], out: &Path) -> anyhow::Result<()> {
    let all: Vec<Row> = rows.iter().chain(peers).cloned().collect();
    write_panels(&all, &panels(rows, peers), out)?;
    maps::write(maps, out).with_context(|| out.display().to_string())
}

/// A setting is `series, label`.
fn split(row: &Row) -> (&str, &str) {
    row.setting.rsplit_once(", ").unwrap_or((&row.setting, ""))
}

fn series(rows: &[Row], name: &str) -> Series {
    let own = rows.iter().filter(|row| split(row).0 == name);
    // Every third tolerance has its name beside it: with all of them nothing could be read.
    let named = |label: &str| {
        ["1e-3", "1e-6", "1e-9", "1e-12"].contains(&label) || [" s", " Hz"].iter().any(|unit| label.ends_with(unit))
    };
    let point = |row: &Row| {
        let label = split(row).1;
        let label = if named(label) { label.to_owned() } else { String::new() };
        Point { x: row.run_s, y: row.error, label }
    };
    Series { name: name.to_owned(), points: own.map(point).collect() }
}

fn names(rows: &[Row]) -> Vec<&str> {
    let mut names = Vec::new();
    for name in rows.iter().map(|row| split(row).0) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

fn panels(rows: &[Row], peers: &[Row]) -> Vec<Plot> {
    let plot = |title: &str, series: Vec<Series>| Plot {
        title: title.to_owned(),
        x: Axis { label: "seconds a response of 4 s".into() },
        y: Axis { label: "|x - x_ref| / D".into() },
        series,
    };
    let own = names(rows);
    let (orders, modes): (Vec<&str>, Vec<&str>) = own.iter().partition(|name| name.starts_with("full, "));
    let mut panels = vec![
        plot("Orders of the method, steps", orders.iter().map(|name| series(rows, name)).collect()),
        plot("Modes", modes.iter().map(|name| series(rows, name)).collect()),
    ];
    for (k, some) in names(peers).chunks(SERIES).enumerate() {
        let lunula = series(rows, modes::AUTO);
        let all = std::iter::once(lunula).chain(some.iter().map(|name| series(peers, name))).collect();
        panels.push(plot(if k == 0 { "Peers" } else { "More peers" }, all));
    }
    panels
}
