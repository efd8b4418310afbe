//! Pictures of the predictors: predicted against measured (Fig. 94-97, 99-104), modes of the linear model (Fig. 98),
//! eigennails, bars that compare models and sets (Fig. 105-113), errors over the number of photodiodes and of training
//! rows.
//!
//! In: plain numbers with their names; NaN is not known and leaves a gap. Out: a PNG and an SVG, or the charts
//! of one. The same numbers give the same bytes. Many rows are thinned, files do not grow with them.

mod bars;
mod curves;
mod modes;
mod nails;
mod over_time;
mod predicted;
mod scatter;
#[cfg(test)]
mod tests;

pub(super) use bars::error_by_magnitude;
pub use bars::{BarSeries, Bars, draw_bars};
pub(super) use curves::{LearningSeries, Subset, best_subsets, learning_curve};
pub(super) use modes::{Modes, draw_modes};
pub(super) use nails::draw_nails;
pub(super) use over_time::over_time;
pub(super) use predicted::Predicted;
pub(super) use scatter::draw_scatter;

/// Width of pictures that are one panel wide, pixels.
pub(super) const WIDTH: u32 = 1400;

/// `Fz, N` of the column `Fz_N`, `J2, degrees` of `J2_deg`; other names as they are.
fn quantity(column: &str) -> String {
    match column.rsplit_once('_') {
        Some((name, "N")) => format!("{name}, N"),
        Some((name, "deg")) => format!("{name}, degrees"),
        _ => column.to_owned(),
    }
}

/// The unit of a column, with a space before it; empty where its name does not tell.
fn unit(column: &str) -> &'static str {
    match column.rsplit_once('_') {
        Some((_, "N")) => " N",
        Some((_, "deg")) => " degrees",
        _ => "",
    }
}

fn three_digits(value: f64) -> String {
    let size = value.abs();
    let text = if size == 0.0 || !size.is_finite() {
        return value.to_string();
    } else if (1e-3..1e5).contains(&size) {
        let decimals = (2 - size.log10().floor() as i32).clamp(0, 5) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.2e}")
    };
    text.replace('-', "\u{2212}")
}
