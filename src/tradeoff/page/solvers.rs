//! The curves of the hemodynamic model's solvers as panels: orders, modes, other programs.

use std::collections::BTreeSet;

use crate::figure::{Chart, Point};
use crate::tradeoff::hemodynamics::AUTO;
use crate::tradeoff::judge::Tradeoff;
use crate::tradeoff::measure::rows::Row;
use crate::tradeoff::page::curves::{Series, chart, marks};

/// Series of a panel; more than there are colours go to the next one.
const SERIES: usize = 5;

/// A setting is `series, label`.
fn split(row: &Row) -> (&str, &str) {
    row.setting.rsplit_once(", ").unwrap_or((&row.setting, ""))
}

fn series(rows: &[&Row], name: &str) -> Series {
    let own = rows.iter().filter(|row| split(row).0 == name);
    // Every third tolerance has its name beside it: with all of them nothing could be read.
    let named = |label: &str| {
        ["1e-3", "1e-6", "1e-9", "1e-12"].contains(&label) || [" s", " Hz"].iter().any(|unit| label.ends_with(unit))
    };
    let point = |row: &&Row| {
        let label = split(row).1;
        let label = if named(label) { label.to_owned() } else { String::new() };
        Point { x: row.run_s, y: row.error, label, x_range: None }
    };
    Series {
        name: name.to_owned(),
        points: own.map(point).collect(),
        peer: rows.iter().any(|row| split(row).0 == name && row.peer),
    }
}

fn names<'a>(rows: &[&'a Row]) -> Vec<&'a str> {
    let mut seen = BTreeSet::new();
    rows.iter().map(|row| split(row).0).filter(|name| seen.insert(*name)).collect()
}

/// Orders, modes, and other programs beside the default's method.
pub(in crate::tradeoff) fn solver_panels(tradeoff: &Tradeoff) -> Vec<Chart> {
    let curve = tradeoff.curves.first();
    let front = || curve.map(|curve| curve.front.clone()).unwrap_or_default();
    let axes = || ["seconds a response of 4 s".to_owned(), "|x - x_ref| / D".to_owned()];
    let plot =
        |title: &str, rows: &[&Row], series: Vec<Series>| chart(title.to_owned(), axes(), front(), series, marks(rows));
    let (peers, own): (Vec<&Row>, Vec<&Row>) = tradeoff.rows.iter().partition(|row| row.peer);
    let of = |name: &str| own.iter().copied().filter(|row| split(row).0 == name).collect::<Vec<_>>();
    let all = names(&own);
    let (orders, modes): (Vec<&str>, Vec<&str>) = all.iter().partition(|name| name.starts_with("full, "));
    let panel = |title: &str, names: &[&str]| {
        let shown: Vec<&Row> = names.iter().flat_map(|name| of(name)).collect();
        plot(title, &shown, names.iter().map(|name| series(&own, name)).collect())
    };
    let mut panels = vec![panel("Orders of the method, steps", &orders), panel("Modes", &modes)];
    for (k, some) in names(&peers).chunks(SERIES).enumerate() {
        let lunula = std::iter::once(series(&own, AUTO));
        let all = lunula.chain(some.iter().map(|name| series(&peers, name))).collect();
        panels.push(plot(if k == 0 { "Other programs" } else { "More of them" }, &of(AUTO), all));
    }
    panels
}
