//! Plots of measured points, drawn once and written as PNG and SVG.

use std::path::Path;
use std::sync::Once;

use anyhow::{Context, anyhow, ensure};
use plotters::coord::Shift;
use plotters::prelude::*;

use super::places::{LETTER_PX, Place, names, ticks};
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
    /// A thin line beneath, from point to point.
    pub line: Vec<[f64; 2]>,
    /// Points that stand out.
    pub marks: Vec<Mark>,
}

/// A ring or a square about a point.
#[derive(Debug, Clone)]
pub struct Mark {
    /// Along the horizontal axis.
    pub x: f64,
    /// Along the vertical axis.
    pub y: f64,
    /// Its form.
    pub shape: MarkShape,
    /// For the legend.
    pub name: String,
}

/// A mark's form; one of each fits about the same point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkShape {
    /// A circle.
    Ring,
    /// An upright square.
    Square,
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
    /// Whether its dots are empty.
    pub hollow: bool,
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
    /// How far it reaches horizontally, drawn as a line.
    pub x_range: Option<[f64; 2]>,
}

/// Width and height of a panel, pixels.
const PANEL: (u32, u32) = (820, 620);
/// A legend's lines, and what it has beside and below its names, pixels.
const LEGEND_LINE_PX: i32 = 20;
const LEGEND_EDGE_PX: (i32, i32) = (48, 14);
/// Half a point's size.
const DOT_PX: i32 = 5;
/// Half a ring's and a square's.
const RING_PX: i32 = 11;
const SQUARE_PX: i32 = 9;
const MARK: RGBColor = RGBColor(40, 40, 40);
const LINE: RGBColor = RGBColor(170, 170, 170);
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
    // In memory first: what writes to a file by itself passes over the error of its last bytes.
    let mut bytes = Vec::new();
    picture.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png)?;
    std::fs::write(png, bytes).with_context(|| png.display().to_string())?;
    let mut text = String::new();
    draw_on_white(what, SVGBackend::with_string(&mut text, size).into_drawing_area())?;
    std::fs::write(svg, text).with_context(|| svg.display().to_string())
}

/// The legend of all series that have a name.
pub(super) fn draw_legend<'a, B, C>(chart: &mut ChartContext<'a, B, C>, at: SeriesLabelPosition) -> anyhow::Result<()>
where
    B: DrawingBackend + 'a,
    B::ErrorType: 'static,
    C: CoordTranslate,
{
    chart
        .configure_series_labels()
        .position(at)
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
        // Where there is none within, others do.
        let (named, light) = ticks(y.0, y.1);
        let y = (y.0..y.1).log_scale().with_key_points(named).with_light_points(light);
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 22))
            .margin(16)
            .x_label_area_size(46)
            .y_label_area_size(74)
            .build_cartesian_2d((x.0..x.1).log_scale(), y)
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
        let line = self.line.iter().filter(|[x, y]| *x > 0.0 && *y > 0.0).map(|&[x, y]| (x, y));
        chart.draw_series(LineSeries::new(line, LINE)).map_err(|e| anyhow!("{e}"))?;
        for (series, colour) in self.series.iter().zip(COLOURS.iter().cycle()) {
            self.draw_series(&mut chart, series, *colour)?;
        }
        self.draw_marks(&mut chart)?;
        let (at, legend) = self.legend(&chart);
        self.draw_names(&mut chart, legend)?;
        draw_legend(&mut chart, at)
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
        let reaches =
            points.iter().filter_map(|p| p.x_range.filter(|[low, _]| *low > 0.0).map(|[low, high]| (low, high, p.y)));
        let reach =
            |(low, high, y): (f64, f64, f64)| PathElement::new(vec![(low, y), (high, y)], colour.stroke_width(2));
        chart.draw_series(reaches.map(reach)).map_err(|e| anyhow!("{e}"))?;
        let style = if series.hollow { colour.stroke_width(2) } else { colour.filled() };
        let size = if series.hollow { DOT_PX - 1 } else { DOT_PX };
        chart
            .draw_series(points.iter().map(|p| Circle::new((p.x, p.y), size, style)))
            .map_err(|e| anyhow!("{e}"))?
            .label(&series.name)
            .legend(move |(x, y)| Circle::new((x + 10, y), size, style));
        Ok(())
    }

    /// Rings and squares, each name once in the legend.
    fn draw_marks<B: DrawingBackend, X, Y>(
        &self,
        chart: &mut ChartContext<'_, B, Cartesian2d<X, Y>>,
    ) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
        X: Ranged<ValueType = f64>,
        Y: Ranged<ValueType = f64>,
    {
        let style = MARK.stroke_width(2);
        for mark in self.marks.iter().filter(|mark| mark.x > 0.0 && mark.y > 0.0) {
            let at = std::iter::once((mark.x, mark.y));
            let square = || Rectangle::new([(-SQUARE_PX, -SQUARE_PX), (SQUARE_PX, SQUARE_PX)], style);
            let drawn = match mark.shape {
                MarkShape::Ring => chart.draw_series(at.map(|at| Circle::new(at, RING_PX, style))),
                MarkShape::Square => chart.draw_series(at.map(|at| EmptyElement::at(at) + square())),
            };
            let drawn = drawn.map_err(|e| anyhow!("{e}"))?.label(&mark.name);
            match mark.shape {
                MarkShape::Ring => drawn.legend(move |(x, y)| Circle::new((x + 10, y), DOT_PX + 1, style)),
                MarkShape::Square => {
                    drawn.legend(move |(x, y)| Rectangle::new([(x + 5, y - 5), (x + 15, y + 5)], style))
                }
            };
        }
        Ok(())
    }

    /// Names all points, none on another's name or on the legend where there is room.
    fn draw_names<B: DrawingBackend, X, Y>(
        &self,
        chart: &mut ChartContext<'_, B, Cartesian2d<X, Y>>,
        legend: Place,
    ) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
        X: Ranged<ValueType = f64>,
        Y: Ranged<ValueType = f64>,
    {
        let (across, down) = chart.plotting_area().get_pixel_range();
        let about = |(x, y): (i32, i32), half: i32| [x - half, y - half, x + half, y + half];
        let mut taken: Vec<Place> = vec![legend];
        taken.extend(self.drawable().map(|point| about(chart.backend_coord(&(point.x, point.y)), DOT_PX)));
        let reaches = self.drawable().filter_map(|point| Some((point.x_range.filter(|[low, _]| *low > 0.0)?, point.y)));
        taken.extend(reaches.map(|([low, high], y)| {
            let [(left, y), (right, _)] = [low, high].map(|x| chart.backend_coord(&(x, y)));
            [left, y - 1, right, y + 1]
        }));
        let marks = self.marks.iter().filter(|mark| mark.x > 0.0 && mark.y > 0.0);
        taken.extend(marks.map(|mark| about(chart.backend_coord(&(mark.x, mark.y)), RING_PX)));
        let mut points: Vec<&Point> = self.drawable().filter(|point| !point.label.is_empty()).collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        let marked = |point: &Point| self.marks.iter().any(|mark| mark.x == point.x && mark.y == point.y);
        let beside: Vec<((i32, i32), i32, &str)> = points
            .iter()
            .map(|point| {
                let clear = if marked(point) { RING_PX } else { DOT_PX };
                (chart.backend_coord(&(point.x, point.y)), clear, point.label.as_str())
            })
            .collect();
        for (point, step) in points.iter().zip(names(&beside, taken, &across, &down)) {
            let name = EmptyElement::at((point.x, point.y))
                + Text::new(point.label.clone(), step, ("sans-serif", 14).into_font());
            chart.draw_series(std::iter::once(name)).map_err(|e| anyhow!("{e}"))?;
        }
        Ok(())
    }

    /// In which corner the legend covers the fewest points, the right top one if they are alike, and about where it
    /// stands there.
    fn legend<B: DrawingBackend, X, Y>(
        &self,
        chart: &ChartContext<'_, B, Cartesian2d<X, Y>>,
    ) -> (SeriesLabelPosition, Place)
    where
        X: Ranged<ValueType = f64>,
        Y: Ranged<ValueType = f64>,
    {
        let entries = || self.series.iter().map(|series| &series.name).chain(self.marks.iter().map(|mark| &mark.name));
        let letters = entries().map(|name| name.chars().count() as i32).max().unwrap_or(0);
        let (beside, below) = LEGEND_EDGE_PX;
        let (width, height) = (letters * LETTER_PX + beside, entries().count() as i32 * LEGEND_LINE_PX + below);
        let (across, down) = chart.plotting_area().get_pixel_range();
        let covered = |place: &Place| {
            let points = self.drawable().map(|point| chart.backend_coord(&(point.x, point.y)));
            let [left, top, right, bottom] = *place;
            points.filter(|(x, y)| (left..=right).contains(x) && (top..=bottom).contains(y)).count()
        };
        let (left, right) = ([across.start, across.start + width], [across.end - width, across.end]);
        let (upper, lower) = ([down.start, down.start + height], [down.end - height, down.end]);
        let place = |x: [i32; 2], y: [i32; 2]| [x[0], y[0], x[1], y[1]];
        let upper_right = (SeriesLabelPosition::UpperRight, place(right, upper));
        let others = [
            (SeriesLabelPosition::LowerLeft, place(left, lower)),
            (SeriesLabelPosition::UpperLeft, place(left, upper)),
            (SeriesLabelPosition::LowerRight, place(right, lower)),
        ];
        others
            .into_iter()
            .fold(upper_right, |best, other| if covered(&other.1) < covered(&best.1) { other } else { best })
    }
}

/// `0.01`, `100`, and where that gets long `2e-9`.
fn decade(value: &f64) -> String {
    if (1e-4..1e6).contains(value) { short_number(value) } else { format!("{value:.0e}") }
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
