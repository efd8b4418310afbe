//! Charts: lines with breaks where nothing is known, bands, dots, labelled points, shaded spans; PNG and SVG.
//!
//! A picture's charts are drawn below each other, or as panels in rows; the axes are linear, or both logarithmic
//! ([`draw_log_log`]). What is drawn last lies on top. Values beyond 1e200 are drawn there.

mod grid;
mod ink;
mod item;
mod places;
mod points;
mod reach;

use std::path::Path;

use anyhow::{anyhow, ensure};
use plotters::coord::Shift;
use plotters::prelude::*;

use super::picture::{Backend, Draw, draw_legend, short_number, write_both};
use ink::{NAME_LINE_PX, draw_item, draw_names};
use places::ticks;
use points::{Area, Axis, LEGEND_LINE_PX};
use reach::Reach;

pub use grid::{Cell, draw_grid};
pub use item::{Bar, Item, Mark, MarkShape, Point};

/// A chart.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Above the axes.
    pub title: String,
    /// What the horizontal axis shows, with its unit.
    pub x: String,
    /// What the vertical axis shows; where it is empty, its numbers mean nothing and are not written.
    pub y: String,
    /// Whether the vertical axis begins at zero.
    pub from_zero: bool,
    /// What is drawn, the lowest first.
    pub items: Vec<Item>,
    /// Its height in pixels.
    pub height: u32,
}

/// How numbers are laid out along both axes.
#[derive(Debug, Clone, Copy)]
enum Scales {
    Linear,
    Logarithmic,
}

/// Draws `charts` below each other, `width` pixels wide, to `png` and `svg`.
///
/// # Errors
/// A file that can't be written.
pub fn draw_charts(charts: &[Chart], width: u32, png: &Path, svg: &Path) -> anyhow::Result<()> {
    panels(charts, 1, width, Scales::Linear, png, svg)
}

/// Draws `charts` as panels, `columns` in a row and `width` pixels wide each, to `png` and `svg`; a row is as high as
/// its highest.
///
/// # Errors
/// A file that can't be written.
pub fn draw_panels(charts: &[Chart], columns: usize, width: u32, png: &Path, svg: &Path) -> anyhow::Result<()> {
    panels(charts, columns, width, Scales::Linear, png, svg)
}

/// As [`draw_panels`], on logarithmic axes. Only positive numbers have a place on them.
///
/// # Errors
/// A chart without a labelled point that has two positive finite coordinates, or a file that can't be written.
pub fn draw_log_log(charts: &[Chart], columns: usize, width: u32, png: &Path, svg: &Path) -> anyhow::Result<()> {
    panels(charts, columns, width, Scales::Logarithmic, png, svg)
}

fn panels(charts: &[Chart], columns: usize, width: u32, scales: Scales, png: &Path, svg: &Path) -> anyhow::Result<()> {
    let columns = columns.clamp(1, charts.len().max(1));
    let rows = charts.chunks(columns).map(|row| row.iter().map(|c| c.height).max().unwrap_or(0));
    let ends: Vec<u32> = rows
        .scan(0, |end, height| {
            *end += height;
            Some(*end)
        })
        .collect();
    let size = (width * columns as u32, ends.last().copied().unwrap_or(1));
    write_both(&Panels { charts, columns, width, scales, ends: &ends }, size, png, svg)
}

struct Panels<'a> {
    charts: &'a [Chart],
    columns: usize,
    width: u32,
    scales: Scales,
    /// Where each row ends.
    ends: &'a [u32],
}

impl Draw for Panels<'_> {
    fn draw<B: Backend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()> {
        let across: Vec<i32> = (1..self.columns as i32).map(|k| k * self.width as i32).collect();
        let down: Vec<i32> = self.ends.iter().map(|&end| end as i32).take(self.ends.len().saturating_sub(1)).collect();
        let areas = area.split_by_breakpoints(across, down);
        self.charts.iter().zip(areas).try_for_each(|(chart, own)| chart.draw(&own, self.scales))
    }
}

impl Chart {
    /// A chart whose vertical axis shows what its items need.
    #[must_use]
    pub fn new(
        title: impl Into<String>,
        x: impl Into<String>,
        y: impl Into<String>,
        items: Vec<Item>,
        height: u32,
    ) -> Self {
        Self { title: title.into(), x: x.into(), y: y.into(), from_zero: false, items, height }
    }

    /// The same with a vertical axis that begins at zero.
    #[must_use]
    pub fn from_zero(self) -> Self {
        Self { from_zero: true, ..self }
    }

    fn draw<B: Backend>(&self, area: &DrawingArea<B, Shift>, scales: Scales) -> anyhow::Result<()> {
        match scales {
            Scales::Linear => self.draw_linear(area),
            Scales::Logarithmic => self.draw_log(area),
        }
    }

    fn draw_linear<B: Backend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()> {
        let mut reach = Reach::default();
        self.items.iter().for_each(|item| item.reach(&mut reach));
        if self.from_zero {
            reach.y.take(0.0);
        }
        let square = self.items.iter().any(|item| matches!(item, Item::Diagonal { .. }));
        if square {
            reach.square();
        }
        // The legend has room above the highest value.
        let named = self.items.iter().filter(|item| item.name().is_some()).count();
        let legend = if named > 0 { f64::from(LEGEND_LINE_PX) * (named as f64 + 1.0) } else { 0.0 };
        let height = f64::from(self.height.max(200)) - 110.0;
        let above = 0.04 + (legend / (height - legend)).clamp(0.0, 1.0);
        let (x, y) = if square {
            (reach.x.padded(0.03, 0.03), reach.y.padded(0.03, 0.03))
        } else {
            (reach.x.padded(0.01, 0.01), reach.y.padded(if self.from_zero { 0.0 } else { 0.05 }, above))
        };
        let built = self.builder(area).build_cartesian_2d(x.0..x.1, y.0..y.1);
        let mut chart = built.map_err(|e| anyhow!("{e}"))?;
        // Spans lie below the grid.
        for item in &self.items {
            if let Item::Spans { name, spans } = item {
                let grey = RGBColor(226, 226, 226).filled();
                let drawn = chart
                    .draw_series(spans.iter().map(|s| Rectangle::new([(s[0], y.0), (s[1], y.1)], grey)))
                    .map_err(|e| anyhow!("{e}"))?;
                if let Some(name) = name {
                    drawn.label(name).legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 20, y + 5)], grey));
                }
            }
        }
        let names = self.names();
        let number_x = |value: &f64| if names.is_some() { String::new() } else { number(*value, x) };
        let number_y = |value: &f64| if self.y.is_empty() { String::new() } else { number(*value, y) };
        let mut mesh = chart.configure_mesh();
        if names.is_some() {
            mesh.disable_x_mesh().set_tick_mark_size(LabelAreaPosition::Bottom, 0);
        }
        mesh.x_desc(&self.x)
            .y_desc(&self.y)
            .label_style(("sans-serif", 15))
            .axis_desc_style(("sans-serif", 17))
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(0, 0, 0).mix(0.12))
            .x_label_formatter(&number_x)
            .y_label_formatter(&number_y)
            .draw()
            .map_err(|e| anyhow!("{e}"))?;
        self.draw_items(&mut chart)?;
        if let Some(names) = names {
            draw_names(area, &chart, names)?;
        }
        if named > 0 {
            draw_legend(&mut chart, SeriesLabelPosition::UpperRight)?;
        }
        Ok(())
    }

    fn draw_log<B: Backend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()> {
        let (x, y) = (self.log_range(|p| p.x)?, self.log_range(|p| p.y)?);
        // The horizontal axis has its ticks at the decades; the vertical one may lie within a decade.
        let x = (0.999 * 10_f64.powf(x.0.log10().floor()), 1.001 * 10_f64.powf(x.1.log10().ceil()));
        let (named, light) = ticks(y.0, y.1);
        let y = (y.0..y.1).log_scale().with_key_points(named).with_light_points(light);
        let built = self.builder(area).build_cartesian_2d((x.0..x.1).log_scale(), y);
        let mut chart = built.map_err(|e| anyhow!("{e}"))?;
        chart
            .configure_mesh()
            .x_desc(&self.x)
            .y_desc(&self.y)
            .label_style(("sans-serif", 15))
            .axis_desc_style(("sans-serif", 17))
            .light_line_style(RGBColor(240, 240, 240))
            .x_label_formatter(&decade)
            .y_label_formatter(&decade)
            .draw()
            .map_err(|e| anyhow!("{e}"))?;
        self.draw_items(&mut chart)?;
        let (corner, place) = self.legend_corner(&chart);
        self.draw_labels(&mut chart, place)?;
        draw_legend(&mut chart, corner)
    }

    /// Title, margins and room for the axes.
    fn builder<'a, 'b, B: DrawingBackend>(&self, area: &'a DrawingArea<B, Shift>) -> ChartBuilder<'a, 'b, B> {
        let mut builder = ChartBuilder::on(area);
        let lines =
            self.names().map_or(1, |names| names.iter().map(|(_, name)| name.lines().count()).max().unwrap_or(1));
        let below = if self.x.is_empty() { 26 } else { 46 } + NAME_LINE_PX * (lines.max(1) as u32 - 1);
        builder.margin(16).x_label_area_size(below).y_label_area_size(74);
        if !self.title.is_empty() {
            builder.caption(&self.title, ("sans-serif", 22));
        }
        builder
    }

    fn names(&self) -> Option<&Vec<(f64, String)>> {
        self.items.iter().find_map(|item| if let Item::Names(names) = item { Some(names) } else { None })
    }

    fn draw_items<B: Backend, X: Axis, Y: Axis>(&self, chart: &mut Area<'_, B, X, Y>) -> anyhow::Result<()> {
        self.items.iter().try_for_each(|item| draw_item(chart, item))
    }

    /// The range of a coordinate over the points with a place on logarithmic axes, a little wider than they are.
    fn log_range(&self, of: impl Fn(&Point) -> f64) -> anyhow::Result<(f64, f64)> {
        let has_place = |v: f64| v.is_finite() && v > 0.0;
        let points = self.points().filter(|p| has_place(p.x) && has_place(p.y));
        let (low, high) = points.map(of).fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        ensure!(low.is_finite(), "no point of the chart `{}` has a place on logarithmic axes", self.title);
        Ok((low / 1.6, high * 2.2))
    }
}

/// `0.01`, `100`, and where that gets long `2e-9`.
fn decade(value: &f64) -> String {
    if (1e-4..1e6).contains(value) { short_number(value) } else { format!("{value:.0e}") }
}

/// A number of an axis between two ends, as short as it can be read.
fn number(value: f64, (low, high): (f64, f64)) -> String {
    let size = low.abs().max(high.abs());
    if value.abs() < 1e-9 * (high - low) {
        return "0".to_owned();
    }
    if (1e-3..1e7).contains(&size) {
        return short_number(&value);
    }
    let text = format!("{value:.3e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{}e{exponent}", digits.trim_end_matches('0').trim_end_matches('.'))
}
