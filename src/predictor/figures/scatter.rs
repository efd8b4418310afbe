//! Predicted against measured, a square panel a target, with the line on which they are the same (Fig. 95, 97, 100,
//! 102, 104).

use std::path::Path;

use super::{Predicted, quantity, three_digits, unit};
use crate::figure::{Chart, Item, draw_panels};
use crate::median::ends;

/// Width and height of a panel, pixels: the axes are square within it.
const PANEL_PX: (u32, u32) = (536, 534);
const COLUMNS: usize = 3;
/// Points are drawn once in each of so many times so many places of a panel.
const PLACES: f64 = 150.0;

/// Draws predicted against measured, the RMSE in each title. Of points in the same place one is drawn.
///
/// # Errors
/// Nothing was measured, or a file that can't be written.
pub(in crate::predictor) fn draw_scatter(
    all: &Predicted<'_>,
    title: &str,
    png: &Path,
    svg: &Path,
) -> anyhow::Result<()> {
    let Some(measured) = all.measured else { anyhow::bail!("nothing was measured to draw predictions against") };
    let panel = |target: usize| {
        let column = &all.targets[target];
        let pairs = measured.column(target).into_iter().zip(all.predicted.column(target));
        let points: Vec<[f64; 2]> =
            pairs.map(|(m, p)| [*m, *p]).filter(|p| p[0].is_finite() && p[1].is_finite()).collect();
        let name = quantity(column);
        let (short, _) = name.split_once(',').unwrap_or((&name, ""));
        let rmse = all
            .rmse(target)
            .map_or("no row is known".to_owned(), |(rmse, _)| format!("RMSE {}{}", three_digits(rmse), unit(column)));
        let before = if target == 0 && !title.is_empty() { format!("{title}: ") } else { String::new() };
        Chart::new(
            format!("{before}{short}, {rmse}"),
            format!("measured {name}"),
            format!("predicted {name}"),
            vec![Item::Dots { name: None, points: thinned(points), colour: 0 }, Item::Diagonal { name: None }],
            PANEL_PX.1,
        )
    };
    let charts: Vec<Chart> = (0..all.targets.len()).map(panel).collect();
    draw_panels(&charts, COLUMNS, PANEL_PX.0, png, svg)
}

/// One point in each place, the first; in the points' own order.
fn thinned(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let [x, y] = [0, 1].map(|of| ends(points.iter().map(|p| p[of])));
    let (low, high) = (x[0].min(y[0]), x[1].max(y[1]));
    let place = |value: f64| ((value / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0) * PLACES) as u32;
    let mut seen = std::collections::BTreeSet::new();
    points.into_iter().filter(|p| seen.insert((place(p[0]), place(p[1])))).collect()
}
