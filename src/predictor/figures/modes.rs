//! Singular values and modes of a Jacobian (Fig. 98): which combinations of forces depend on which combinations of
//! photodiodes.

use std::path::Path;

use ndarray::ArrayView2;

use super::{quantity, three_digits};
use crate::figure::{Bar, Chart, Item, draw_panels};

/// Width and heights of panels, pixels.
const PANEL_PX: u32 = 470;
const HEIGHTS_PX: [u32; 2] = [330, 360];

/// The singular value decomposition J = U S V^T.
#[derive(Debug, Clone, Copy)]
pub(in crate::predictor) struct Modes<'a> {
    /// Names of the targets: `Fz_N`, `J2_deg`.
    pub targets: &'a [String],
    /// Names of the photodiodes.
    pub inputs: &'a [String],
    /// Singular values, the largest first.
    pub values: &'a [f64],
    /// Their unit, as `N/V`; empty where it is none.
    pub unit: &'a str,
    /// U: targets x modes.
    pub of_targets: ArrayView2<'a, f64>,
    /// V: photodiodes x modes.
    pub of_inputs: ArrayView2<'a, f64>,
}

/// Draws a column of panels for each mode: the contributions of the targets above those of the photodiodes.
pub(in crate::predictor) fn draw_modes(modes: &Modes<'_>, png: &Path, svg: &Path) -> anyhow::Result<()> {
    let count = modes.values.len();
    let unit = if modes.unit.is_empty() { String::new() } else { format!(" {}", modes.unit) };
    let short = |name: &String| quantity(name).split(',').next().unwrap_or_default().to_owned();
    let targets: Vec<String> = modes.targets.iter().map(short).collect();
    let upper = (0..count).map(|k| {
        let value = modes.values[k];
        let sigma =
            if value.is_finite() { format!("= {}{unit}", three_digits(value)) } else { "is not known".to_owned() };
        let title = format!("mode {}: \u{3c3} {sigma}", k + 1);
        panel(title, "part of the outputs", &targets, modes.of_targets.column(k).iter().copied(), [0, k])
    });
    let lower = (0..count).map(|k| {
        panel(String::new(), "part of the photodiodes", modes.inputs, modes.of_inputs.column(k).iter().copied(), [1, k])
    });
    let charts: Vec<Chart> = upper.chain(lower).collect();
    draw_panels(&charts, count, PANEL_PX, png, svg)
}

fn panel(
    title: String,
    y: &str,
    names: &[String],
    values: impl Iterator<Item = f64>,
    [row, column]: [usize; 2],
) -> Chart {
    let bars = values.enumerate().map(|(k, value)| Bar { at: k as f64, width: 0.7, value, error: None }).collect();
    let last = names.len().max(1) as f64 - 0.5;
    Chart::new(
        title,
        "",
        // Panels beside the first have the same axis.
        if column == 0 { y } else { " " },
        vec![
            Item::Room(vec![[-0.5, -1.0], [last, 1.0]]),
            Item::Names(names.iter().enumerate().map(|(k, name)| (k as f64, name.clone())).collect()),
            Item::Bars { name: None, bars, colour: row },
            Item::Line { name: None, runs: vec![vec![[-0.5, 0.0], [last, 0.0]]], colour: row, width: 1 },
        ],
        HEIGHTS_PX[row],
    )
}
