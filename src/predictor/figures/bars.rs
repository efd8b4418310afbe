//! Bars in groups, with error marks (Fig. 105-113): models by targets, "none, P1 .. P8 removed", errors by the size of
//! the force.

use std::path::Path;

use super::{WIDTH, three_digits};
use crate::figure::{Bar, Chart, Item, draw_charts};
use crate::predictor::merit::figures::BinMerit;

/// Of a group's width, what its bars take.
const TAKEN: f64 = 0.8;
/// Height of the picture, pixels.
const HEIGHT_PX: u32 = 560;

/// A chart of bars in groups.
#[derive(Debug, Clone, Default)]
pub struct Bars {
    /// Above the axes.
    pub title: String,
    /// Below the groups; empty for nothing.
    pub x_label: String,
    /// What the bars' height is, with the unit.
    pub y_label: String,
    /// The groups' names; a name may have several lines.
    pub groups: Vec<String>,
    /// In every group one bar of each.
    pub series: Vec<BarSeries>,
}

/// The bars of one colour, one per group.
#[derive(Debug, Clone, Default)]
pub struct BarSeries {
    /// For the legend.
    pub name: String,
    /// A value a group; none is not known and has no bar.
    pub values: Vec<Option<f64>>,
    /// A standard error, or what else the caption says, a group; may be empty.
    pub errors: Vec<Option<f64>>,
}

/// Draws charts of bars, one below the other.
///
/// # Errors
/// A file that can't be written.
pub fn draw_bars(all: &[Bars], png: &Path, svg: &Path) -> anyhow::Result<()> {
    let charts: Vec<Chart> = all.iter().map(chart).collect();
    draw_charts(&charts, WIDTH, png, svg)
}

fn chart(bars: &Bars) -> Chart {
    let width = TAKEN / bars.series.len().max(1) as f64;
    let last = bars.groups.len().max(1) as f64 - 0.5;
    let mut items = vec![
        Item::Room(vec![[-0.5, 0.0], [last, 0.0]]),
        Item::Names(bars.groups.iter().enumerate().map(|(k, name)| (k as f64, name.clone())).collect()),
    ];
    for (colour, series) in bars.series.iter().enumerate() {
        let aside = -0.5 * TAKEN + (colour as f64 + 0.5) * width;
        let bar = |(group, value): (usize, &Option<f64>)| {
            let value = (*value)?;
            let error = series.errors.get(group).copied().flatten().filter(|error| error.is_finite());
            let error = error.map(|error| [value - error, value + error]);
            Some(Bar { at: group as f64 + aside, width: 0.92 * width, value, error })
        };
        let known = series.values.iter().take(bars.groups.len()).enumerate().filter_map(bar).collect();
        items.push(Item::Bars { name: Some(series.name.clone()), bars: known, colour });
    }
    Chart::new(bars.title.clone(), bars.x_label.clone(), bars.y_label.clone(), items, HEIGHT_PX).from_zero()
}

/// The RMSE of each target by the size of the force, in `unit` (`N`).
pub(in crate::predictor) fn error_by_magnitude(title: &str, unit: &str, targets: &[String], bins: &[BinMerit]) -> Bars {
    let group = |bin: &BinMerit| format!("{} to {} {unit}\n{} rows", plain(bin.from), plain(bin.to), bin.merit.rows);
    let series = |(k, name): (usize, &String)| BarSeries {
        name: name.clone(),
        values: bins.iter().map(|bin| Some(bin.merit.rmse.0[k].1).filter(|rmse| rmse.is_finite())).collect(),
        errors: Vec::new(),
    };
    Bars {
        title: title.to_owned(),
        x_label: "size of what was measured".to_owned(),
        y_label: format!("RMSE, {unit}"),
        groups: bins.iter().map(group).collect(),
        series: targets.iter().enumerate().map(series).collect(),
    }
}

/// Three digits without the zeros at their end.
fn plain(value: f64) -> String {
    let text = three_digits(value);
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
