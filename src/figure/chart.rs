//! Charts on linear axes: lines with breaks where nothing is known, bands, dots, shaded spans; PNG and SVG.
//!
//! Charts of one picture stand below each other. What is drawn last lies on top.

use std::path::Path;

use anyhow::anyhow;
use plotters::coord::Shift;
use plotters::prelude::*;

use super::Axis;
use super::plot::{COLOURS, Draw, draw_legend, short_number, write_both};

/// A chart on linear axes.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Above the axes.
    pub title: String,
    /// Horizontal.
    pub x: Axis,
    /// Vertical; without a label its numbers mean nothing and are not written.
    pub y: Axis,
    /// Whether the vertical axis begins at zero.
    pub from_zero: bool,
    /// What is drawn, the lowest first.
    pub items: Vec<Item>,
    /// Its height in pixels.
    pub height: u32,
}

/// Something on a chart. Colours are counted; one that is not there is the first again.
#[derive(Debug, Clone)]
pub enum Item {
    /// Intervals of the horizontal axis, lightly grey.
    Spans {
        /// For the legend; without a name it is not in it.
        name: Option<String>,
        /// From and to.
        spans: Vec<[f64; 2]>,
    },
    /// What lies between two curves.
    Band {
        /// Pieces of x, low, high.
        runs: Vec<Vec<[f64; 3]>>,
        /// Its line's colour.
        colour: usize,
    },
    /// A curve.
    Line {
        /// For the legend; without a name it is not in it.
        name: Option<String>,
        /// Pieces of x, y; a piece of one point is a dot.
        runs: Vec<Vec<[f64; 2]>>,
        /// Which colour.
        colour: usize,
        /// How wide, pixels.
        width: u32,
    },
    /// Single points.
    Dots {
        /// For the legend; without a name it is not in it.
        name: Option<String>,
        /// x and y of each.
        points: Vec<[f64; 2]>,
        /// Which colour.
        colour: usize,
    },
    /// A line of text, which begins at a point and lies below it.
    Text {
        /// x and y.
        at: [f64; 2],
        /// What is written.
        text: String,
        /// Which colour.
        colour: usize,
    },
}

/// Height of a line of a legend.
const LEGEND_LINE_PX: u32 = 20;

/// Draws `charts` below each other, `width` pixels wide, to `png` and `svg`.
///
/// # Errors
/// A file that can't be written.
pub fn draw_charts(charts: &[Chart], width: u32, png: &Path, svg: &Path) -> anyhow::Result<()> {
    write_both(&Charts(charts), (width, charts.iter().map(|c| c.height).sum()), png, svg)
}

struct Charts<'a>(&'a [Chart]);

impl Draw for Charts<'_> {
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
    {
        let mut rest = area.clone();
        for chart in self.0 {
            let (own, below) = rest.split_vertically(chart.height);
            chart.draw(&own)?;
            rest = below;
        }
        Ok(())
    }
}

impl Item {
    /// Lowest and highest x and y of all that is finite.
    fn reach(&self, reach: &mut Reach) {
        match self {
            Self::Spans { spans, .. } => spans.iter().flatten().for_each(|&x| reach.x.take(x)),
            Self::Band { runs, .. } => runs.iter().flatten().for_each(|&[x, low, high]| {
                reach.x.take(x);
                reach.y.take(low);
                reach.y.take(high);
            }),
            Self::Line { runs, .. } => runs.iter().flatten().for_each(|&p| reach.take(p)),
            Self::Dots { points, .. } => points.iter().for_each(|&p| reach.take(p)),
            Self::Text { at, .. } => reach.take(*at),
        }
    }
}

#[derive(Debug, Default)]
struct Reach {
    x: Extent,
    y: Extent,
}

impl Reach {
    fn take(&mut self, [x, y]: [f64; 2]) {
        self.x.take(x);
        self.y.take(y);
    }
}

#[derive(Debug, Default)]
struct Extent(Option<(f64, f64)>);

impl Extent {
    fn take(&mut self, value: f64) {
        if value.is_finite() {
            let (low, high) = self.0.unwrap_or((value, value));
            self.0 = Some((low.min(value), high.max(value)));
        }
    }

    /// The axis' ends: some room on both sides, and a width even for a single value; 0 to 1 for none.
    fn padded(&self, below: f64, above: f64) -> (f64, f64) {
        let Some((low, high)) = self.0 else { return (0.0, 1.0) };
        let size = high.abs().max(low.abs());
        let width = if high - low > 1e-9 * size {
            high - low
        } else if size > 0.0 {
            size.min(1.0)
        } else {
            1.0
        };
        // What has no width stands in the middle.
        let aside = 0.5 * (width - (high - low));
        (low - aside - below * width, high + aside + above * width)
    }
}

impl Chart {
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
    {
        let mut reach = Reach::default();
        self.items.iter().for_each(|item| item.reach(&mut reach));
        if self.from_zero {
            reach.y.take(0.0);
        }
        let x = reach.x.padded(0.01, 0.01);
        // The legend has room above the highest value.
        let named = self.items.iter().filter(|item| item.name().is_some()).count();
        let legend = if named > 0 { f64::from(LEGEND_LINE_PX) * (named as f64 + 1.0) } else { 0.0 };
        let height = f64::from(self.height.max(200)) - 110.0;
        let above = 0.04 + (legend / (height - legend)).clamp(0.0, 1.0);
        let y = reach.y.padded(if self.from_zero { 0.0 } else { 0.05 }, above);
        let mut builder = ChartBuilder::on(area);
        builder.margin(16).x_label_area_size(if self.x.label.is_empty() { 26 } else { 46 }).y_label_area_size(74);
        if !self.title.is_empty() {
            builder.caption(&self.title, ("sans-serif", 22));
        }
        let mut chart = builder.build_cartesian_2d(x.0..x.1, y.0..y.1).map_err(|e| anyhow!("{e}"))?;
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
        chart
            .configure_mesh()
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .label_style(("sans-serif", 15))
            .axis_desc_style(("sans-serif", 17))
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(0, 0, 0).mix(0.12))
            .x_label_formatter(&short_number)
            .y_label_formatter(&|value| if self.y.label.is_empty() { String::new() } else { short_number(value) })
            .draw()
            .map_err(|e| anyhow!("{e}"))?;
        for item in &self.items {
            draw_item(&mut chart, item)?;
        }
        if named > 0 {
            draw_legend(&mut chart)?;
        }
        Ok(())
    }
}

impl Item {
    fn name(&self) -> Option<&str> {
        match self {
            Self::Spans { name, .. } | Self::Line { name, .. } | Self::Dots { name, .. } => name.as_deref(),
            Self::Band { .. } | Self::Text { .. } => None,
        }
    }
}

type Area<'a, B> =
    ChartContext<'a, B, Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>>;

fn draw_item<B: DrawingBackend>(chart: &mut Area<'_, B>, item: &Item) -> anyhow::Result<()>
where
    B::ErrorType: 'static,
{
    let failed = |e: DrawingAreaErrorKind<B::ErrorType>| anyhow!("{e}");
    let colour = |k: usize| COLOURS[k % COLOURS.len()];
    match item {
        Item::Spans { .. } => {}
        Item::Band { runs, colour: k } => {
            let fill = colour(*k).mix(0.3).filled();
            let outline = |run: &Vec<[f64; 3]>| -> Vec<(f64, f64)> {
                let below = run.iter().map(|p| (p[0], p[1]));
                below.chain(run.iter().rev().map(|p| (p[0], p[2]))).collect()
            };
            let bands = runs.iter().filter(|run| run.len() > 1);
            chart.draw_series(bands.map(|run| Polygon::new(outline(run), fill))).map_err(failed)?;
        }
        Item::Line { name, runs, colour: k, width } => {
            let (ink, dot) = (colour(*k).stroke_width(*width), colour(*k).filled());
            let long = runs.iter().filter(|run| run.len() > 1);
            let drawn = chart
                .draw_series(
                    long.map(|run| PathElement::new(run.iter().map(|p| (p[0], p[1])).collect::<Vec<_>>(), ink)),
                )
                .map_err(failed)?;
            if let Some(name) = name {
                drawn.label(name).legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], ink.stroke_width(2)));
            }
            let single = runs.iter().filter(|run| run.len() == 1);
            chart.draw_series(single.map(|run| Circle::new((run[0][0], run[0][1]), 2, dot))).map_err(failed)?;
        }
        Item::Text { at, text, colour: k } => {
            let style = ("sans-serif", 14).into_font().color(&colour(*k));
            let written = Text::new(text.clone(), (at[0], at[1]), style);
            chart.draw_series(std::iter::once(written)).map_err(failed)?;
        }
        Item::Dots { name, points, colour: k } => {
            let ink = colour(*k).mix(0.6).filled();
            let drawn = chart.draw_series(points.iter().map(|p| Circle::new((p[0], p[1]), 2, ink))).map_err(failed)?;
            if let Some(name) = name {
                drawn.label(name).legend(move |(x, y)| Circle::new((x + 10, y), 3, ink));
            }
        }
    }
    Ok(())
}
