//! Responses over time: loads, diameters, photodiodes.

use std::path::Path;

use lunula_hemodynamics::{Loads, Parameters, Site};

use super::{WIDTH, chart};
use crate::figure::{Item, Thinned, draw_charts};
use crate::hemodynamics::Response;

/// One line of a chart over time.
#[derive(Debug, Clone)]
pub struct Curve {
    /// For the legend; none: it is not in it.
    pub name: Option<String>,
    /// s.
    pub times_s: Vec<f64>,
    /// In the panel's unit; a break where a value is not finite.
    pub values: Vec<f64>,
    /// Which colour.
    pub colour: usize,
    /// How wide, pixels.
    pub width: u32,
}

/// Curves with one vertical axis.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Above the axes; may be empty.
    pub title: String,
    /// What the axis shows, with its unit.
    pub y: String,
    /// The lowest first.
    pub curves: Vec<Curve>,
}

/// A curve thinned to what a picture shows, extremes kept; a break where a value is not finite, nothing where its time
/// is not.
pub fn over_time(name: Option<String>, times_s: &[f64], values: &[f64], colour: usize, width: u32) -> Item {
    let mut thinned = Thinned::default();
    for (&time_s, &value) in times_s.iter().zip(values).filter(|(time_s, _)| time_s.is_finite()) {
        thinned.push(time_s, std::iter::once(value.is_finite().then_some([value, f64::NAN])));
    }
    Item::Line { name, runs: thinned.curve(0), colour, width }
}

impl Curve {
    fn item(&self) -> Item {
        over_time(self.name.clone(), &self.times_s, &self.values, self.colour, self.width)
    }
}

/// Panels below each other over the same time.
pub fn draw_over_time(panels: &[Panel], png: &Path, svg: &Path) -> anyhow::Result<()> {
    let last = panels.len() - 1;
    let of = |(k, panel): (usize, &Panel)| {
        let x = if k == last { "time, s" } else { "" };
        chart(&panel.title, x, &panel.y, panel.curves.iter().map(Curve::item).collect())
    };
    draw_charts(&panels.iter().enumerate().map(of).collect::<Vec<_>>(), WIDTH, png, svg)
}

/// One run: what presses, how wide the vessels are, what the photodiodes tell.
pub(in crate::hemodynamics) fn draw_response(
    parameters: &Parameters,
    loads: &Loads,
    response: &Response,
    png: &Path,
    svg: &Path,
) -> anyhow::Result<()> {
    let units = parameters.units().len();
    let curve = |name: String, values: Vec<f64>, colour: usize| Curve {
        name: Some(name),
        times_s: response.times_s.clone(),
        values,
        colour,
        width: 2,
    };
    let inputs: Vec<_> = response.times_s.iter().map(|&time_s| loads.at(time_s)).collect();
    let load = |name: &str, of: fn(&lunula_hemodynamics::Inputs) -> f64, colour, width| Curve {
        width,
        ..curve(name.to_owned(), inputs.iter().map(of).collect(), colour)
    };
    let panel = |title: &str, y: &str, curves: Vec<Curve>| Panel { title: title.to_owned(), y: y.to_owned(), curves };
    let diameter =
        |j: usize, colour| curve(Site::of_wall(j, units).to_string(), response.diameters_um(parameters, j), colour);
    let panels = [
        // Loads are often the same: the wider one shows behind the other.
        panel("Loads", "Pa", vec![load("PF1", |u| u.proximal_pa, 0, 5), load("PF2", |u| u.distal_pa, 1, 2)]),
        panel("Capillaries", "diameter, um", (0..units).map(|i| diameter(i, i)).collect()),
        panel("Vein", "diameter, um", vec![diameter(units, 2)]),
        panel(
            "Photodiodes",
            "V",
            (0..units).map(|i| curve(format!("VP{}", i + 1), response.photodiode_v(i), i)).collect(),
        ),
    ];
    draw_over_time(&panels, png, svg)
}
