//! Pictures of the hemodynamic model: responses over time, static curves, fits.

mod over_time;

pub(super) use over_time::draw_response;
pub use over_time::{Curve, Panel, draw_over_time, over_time};

use crate::figure::{Chart, Item};

/// Width of a picture.
pub const WIDTH: u32 = 1100;
pub(super) const HEIGHT: u32 = 340;
/// A newton on a square centimetre, Pa.
pub const N_PER_CM2: f64 = 1e4;

/// A panel with these axes.
pub fn chart(title: &str, x: &str, y: &str, items: Vec<Item>) -> Chart {
    Chart::new(title, x, y, items, HEIGHT)
}

/// A line of one stretch, 2 pixels wide.
pub fn line(name: Option<&str>, points: Vec<[f64; 2]>, colour: usize) -> Item {
    Item::Line { name: name.map(str::to_owned), runs: vec![points], colour, width: 2 }
}
