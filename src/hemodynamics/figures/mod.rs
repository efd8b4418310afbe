//! Pictures of the hemodynamic model: responses over time, static curves, fits, stability maps.

mod over_time;

pub(super) use over_time::{Curve, Panel, draw_over_time, draw_response, over_time};

use crate::figure::{Axis, Chart, Item};

pub(super) const WIDTH: u32 = 1100;
pub(super) const HEIGHT: u32 = 340;
/// A newton on a square centimetre, Pa.
pub(super) const N_PER_CM2: f64 = 1e4;

pub(super) fn chart(title: &str, x: &str, y: &str, items: Vec<Item>) -> Chart {
    let axis = |label: &str| Axis { label: label.to_owned() };
    Chart { title: title.to_owned(), x: axis(x), y: axis(y), from_zero: false, items, height: HEIGHT }
}

pub(super) fn line(name: Option<&str>, points: Vec<[f64; 2]>, colour: usize) -> Item {
    Item::Line { name: name.map(str::to_owned), runs: vec![points], colour, width: 2 }
}
