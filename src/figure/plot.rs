//! Plots of measured points, drawn once and written as PNG and SVG.

use std::path::Path;
use std::sync::Once;

use anyhow::{Context, anyhow, ensure};
use plotters::coord::Shift;
use plotters::prelude::*;

use super::text::TYPEFACE;

/// A plot with one or several named series.
#[derive(Debug, Clone)]
pub struct Plot {
    /// Above the axes.
    pub title: String,
    /// Horizontal.
    pub x: Axis,
    /// Vertical.
    pub y: Axis,
    /// What is drawn.
    pub series: Vec<Series>,
}

/// One axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// What it shows, with its unit.
    pub label: String,
}

/// Points of one kind.
#[derive(Debug, Clone)]
pub struct Series {
    /// For the legend.
    pub name: String,
    /// In any order.
    pub points: Vec<Point>,
}

/// One point. Only positive numbers have a place on logarithmic axes.
#[derive(Debug, Clone)]
pub struct Point {
    /// Along the horizontal axis.
    pub x: f64,
    /// Along the vertical axis.
    pub y: f64,
    /// Written beside it.
    pub label: String,
}

/// Width and height of a panel, pixels.
const PANEL: (u32, u32) = (820, 620);
/// About the width of a letter and the height of a line of a point's name, pixels.
const LETTER_PX: i32 = 7;
const LINE_PX: i32 = 15;
/// Half a point's size.
const DOT_PX: i32 = 5;
/// Colours that stay apart for colour-blind readers (Okabe and Ito 2008).
pub(super) const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

/// Draws `panels`, up to two side by side, on logarithmic axes, to `png` and `svg`.
///
/// # Errors
/// A panel without a point that has two positive finite coordinates, or a file that can't be written.
pub fn draw_log_log(panels: &[Plot], png: &Path, svg: &Path) -> anyhow::Result<()> {
    let (rows, columns) = grid(panels.len());
    write_both(&Panels(panels), (PANEL.0 * columns as u32, PANEL.1 * rows as u32), png, svg)
}

struct Panels<'a>(&'a [Plot]);

impl Draw for Panels<'_> {
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
    {
        let areas = area.split_evenly(grid(self.0.len()));
        self.0.iter().zip(areas).try_for_each(|(panel, area)| panel.draw(&area))
    }
}

/// What can be drawn with any backend.
pub(super) trait Draw {
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()>
    where
        B::ErrorType: 'static;
}

/// Draws on white, `size` pixels wide and high, to `png` and to `svg`.
pub(super) fn write_both(what: &impl Draw, size: (u32, u32), png: &Path, svg: &Path) -> anyhow::Result<()> {
    register_typeface()?;
    let mut pixels = vec![0; (size.0 * size.1 * 3) as usize];
    draw_on_white(what, BitMapBackend::with_buffer(&mut pixels, size).into_drawing_area())?;
    let picture = image::RgbImage::from_raw(size.0, size.1, pixels).context("a picture's pixels")?;
    picture.save(png).with_context(|| png.display().to_string())?;
    draw_on_white(what, SVGBackend::new(svg, size).into_drawing_area()).with_context(|| svg.display().to_string())
}

/// The legend of all series that have a name.
pub(super) fn draw_legend<'a, B, C>(chart: &mut ChartContext<'a, B, C>) -> anyhow::Result<()>
where
    B: DrawingBackend + 'a,
    B::ErrorType: 'static,
    C: CoordTranslate,
{
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .label_font(("sans-serif", 15))
        .draw()
        .map_err(|e| anyhow!("{e}"))
}

fn draw_on_white<B: DrawingBackend>(what: &impl Draw, area: DrawingArea<B, Shift>) -> anyhow::Result<()>
where
    B::ErrorType: 'static,
{
    area.fill(&WHITE).map_err(|e| anyhow!("{e}"))?;
    what.draw(&area)?;
    area.present().map_err(|e| anyhow!("{e}"))
}

/// Rows and columns of panels.
fn grid(panels: usize) -> (usize, usize) {
    let columns = panels.clamp(1, 2);
    (panels.div_ceil(columns), columns)
}

impl Plot {
    fn drawable(&self) -> impl Iterator<Item = &Point> {
        let has_place = |v: f64| v.is_finite() && v > 0.0;
        self.series.iter().flat_map(|s| &s.points).filter(move |p| has_place(p.x) && has_place(p.y))
    }

    /// The decade-friendly range of a coordinate, a little wider than its points.
    fn range(&self, of: impl Fn(&Point) -> f64) -> anyhow::Result<(f64, f64)> {
        let (low, high) =
            self.drawable().map(of).fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        ensure!(low.is_finite(), "no point of the plot `{}` has a place on logarithmic axes", self.title);
        Ok((low / 1.6, high * 2.2))
    }

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
    {
        let (x, y) = (self.range(|p| p.x)?, self.range(|p| p.y)?);
        // Ticks stand at the decades.
        let x = (0.999 * 10_f64.powf(x.0.log10().floor()), 1.001 * 10_f64.powf(x.1.log10().ceil()));
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 22))
            .margin(16)
            .x_label_area_size(46)
            .y_label_area_size(74)
            .build_cartesian_2d((x.0..x.1).log_scale(), (y.0..y.1).log_scale())
            .map_err(|e| anyhow!("{e}"))?;
        chart
            .configure_mesh()
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .label_style(("sans-serif", 15))
            .axis_desc_style(("sans-serif", 17))
            .light_line_style(RGBColor(240, 240, 240))
            .x_label_formatter(&decade)
            .y_label_formatter(&decade)
            .draw()
            .map_err(|e| anyhow!("{e}"))?;
        for (series, colour) in self.series.iter().zip(COLOURS.iter().cycle()) {
            self.draw_series(&mut chart, series, *colour)?;
        }
        self.draw_names(&mut chart)?;
        draw_legend(&mut chart)
    }

    fn draw_series<B: DrawingBackend, X, Y>(
        &self,
        chart: &mut ChartContext<'_, B, Cartesian2d<X, Y>>,
        series: &Series,
        colour: RGBColor,
    ) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
        X: Ranged<ValueType = f64>,
        Y: Ranged<ValueType = f64>,
    {
        let mut points: Vec<&Point> = series.points.iter().filter(|p| p.x > 0.0 && p.y > 0.0).collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        chart
            .draw_series(points.iter().map(|p| Circle::new((p.x, p.y), DOT_PX, colour.filled())))
            .map_err(|e| anyhow!("{e}"))?
            .label(&series.name)
            .legend(move |(x, y)| Circle::new((x + 10, y), DOT_PX, colour.filled()));
        Ok(())
    }

    /// Names all points, none on another's name where there is room.
    fn draw_names<B: DrawingBackend, X, Y>(
        &self,
        chart: &mut ChartContext<'_, B, Cartesian2d<X, Y>>,
    ) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
        X: Ranged<ValueType = f64>,
        Y: Ranged<ValueType = f64>,
    {
        let (across, down) = chart.plotting_area().get_pixel_range();
        let mut points: Vec<&Point> = self.drawable().filter(|point| !point.label.is_empty()).collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        // Left, top, right, bottom of dots and names.
        let dot = |(x, y): (i32, i32)| [x - DOT_PX, y - DOT_PX, x + DOT_PX, y + DOT_PX];
        let mut taken: Vec<[i32; 4]> =
            points.iter().map(|point| dot(chart.backend_coord(&(point.x, point.y)))).collect();
        for point in points {
            let (x, y) = chart.backend_coord(&(point.x, point.y));
            let width = point.label.chars().count() as i32 * LETTER_PX;
            let dx = if x + 8 + width > across.end { -8 - width } else { 8 };
            let place = |dy: i32| [x + dx, y + dy, x + dx + width, y + dy + LINE_PX];
            let free = |dy: &i32| {
                let [left, top, right, bottom] = place(*dy);
                let inside = top >= down.start && bottom <= down.end;
                inside && taken.iter().all(|t| t[2] < left || t[0] > right || t[3] < top || t[1] > bottom)
            };
            // Above, below, further above, further below, ..
            let steps = (0..12).flat_map(|k| [-LINE_PX - k * LINE_PX, 4 + k * LINE_PX]);
            let dy = steps.into_iter().find(free).unwrap_or(4);
            taken.push(place(dy));
            let name = EmptyElement::at((point.x, point.y))
                + Text::new(point.label.clone(), (dx, dy), ("sans-serif", 14).into_font());
            chart.draw_series(std::iter::once(name)).map_err(|e| anyhow!("{e}"))?;
        }
        Ok(())
    }
}

/// `0.01`, `100`, and where that gets long `1e-9`.
fn decade(value: &f64) -> String {
    if (1e-4..1e6).contains(value) { short_number(value) } else { format!("1e{:.0}", value.log10()) }
}

/// `0.002`, `3`, `40`: as short as the number allows.
pub(super) fn short_number(value: &f64) -> String {
    let text = format!("{value:.6}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

pub(super) fn register_typeface() -> anyhow::Result<()> {
    static ONCE: Once = Once::new();
    let mut usable = true;
    ONCE.call_once(|| {
        usable = plotters::style::register_font("sans-serif", FontStyle::Normal, TYPEFACE).is_ok();
    });
    ensure!(usable, "the typeface that is compiled in is damaged");
    Ok(())
}
