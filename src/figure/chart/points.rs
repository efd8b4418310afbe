//! Labelled points and the marks about them, the labels beside them, and the legend's corner.

use anyhow::anyhow;
use plotters::prelude::*;

use super::super::picture::{Backend, COLOURS};
use super::Chart;
use super::item::{Item, Mark, MarkShape, Point};
use super::places::{LETTER_PX, Place, label_steps};

/// An axis of numbers.
pub(super) trait Axis: Ranged<ValueType = f64> {}

impl<R: Ranged<ValueType = f64>> Axis for R {}

pub(super) type Area<'a, B, X, Y> = ChartContext<'a, B, Cartesian2d<X, Y>>;

/// A legend's line height, and its width and height beyond its names, pixels.
pub(super) const LEGEND_LINE_PX: u32 = 20;
const LEGEND_EDGE_PX: (i32, i32) = (48, 14);
/// Half the size of a dot, a ring and a square.
const DOT_PX: i32 = 5;
const RING_PX: i32 = 11;
const SQUARE_PX: i32 = 9;
const MARK: RGBColor = RGBColor(40, 40, 40);
const PATH: RGBColor = RGBColor(170, 170, 170);

/// Whether a point lies on the axes; on logarithmic ones no number that isn't positive does.
fn on_axes<B: Backend, X: Axis, Y: Axis>(chart: &Area<'_, B, X, Y>, x: f64, y: f64) -> bool {
    chart.x_range().contains(&x) && chart.y_range().contains(&y)
}

/// The error bar of a point, as far as it lies on the axes: from, to, height.
fn bar<B: Backend, X: Axis, Y: Axis>(chart: &Area<'_, B, X, Y>, point: &Point) -> Option<(f64, f64, f64)> {
    let axis = chart.x_range();
    let [low, high] = point.x_range?;
    Some((low.max(axis.start), high.min(axis.end), point.y))
}

/// A thin grey line from point to point.
pub(super) fn draw_path<B: Backend, X: Axis, Y: Axis>(
    chart: &mut Area<'_, B, X, Y>,
    points: &[[f64; 2]],
) -> anyhow::Result<()> {
    let drawable: Vec<(f64, f64)> =
        points.iter().filter(|[x, y]| on_axes(chart, *x, *y)).map(|&[x, y]| (x, y)).collect();
    chart.draw_series(LineSeries::new(drawable, PATH)).map_err(|e| anyhow!("{e}"))?;
    Ok(())
}

/// Dots, full or hollow, with their error bars; the labels come later.
pub(super) fn draw_points<B: Backend, X: Axis, Y: Axis>(
    chart: &mut Area<'_, B, X, Y>,
    name: &str,
    points: &[Point],
    hollow: bool,
    colour: RGBColor,
) -> anyhow::Result<()> {
    let mut drawable: Vec<&Point> = points.iter().filter(|p| on_axes(chart, p.x, p.y)).collect();
    drawable.sort_by(|a, b| a.x.total_cmp(&b.x));
    let bars: Vec<_> = drawable.iter().filter_map(|point| bar(chart, point)).collect();
    let bars =
        bars.into_iter().map(|(low, high, y)| PathElement::new(vec![(low, y), (high, y)], colour.stroke_width(2)));
    chart.draw_series(bars).map_err(|e| anyhow!("{e}"))?;
    let style = if hollow { colour.stroke_width(2) } else { colour.filled() };
    let size = if hollow { DOT_PX - 1 } else { DOT_PX };
    chart
        .draw_series(drawable.iter().map(|p| Circle::new((p.x, p.y), size, style)))
        .map_err(|e| anyhow!("{e}"))?
        .label(name)
        .legend(move |(x, y)| Circle::new((x + 10, y), size, style));
    Ok(())
}

/// A ring or a square.
pub(super) fn draw_mark<B: Backend, X: Axis, Y: Axis>(
    chart: &mut Area<'_, B, X, Y>,
    mark: &Mark,
) -> anyhow::Result<()> {
    let style = MARK.stroke_width(2);
    let at = on_axes(chart, mark.x, mark.y).then_some((mark.x, mark.y)).into_iter();
    let square = || Rectangle::new([(-SQUARE_PX, -SQUARE_PX), (SQUARE_PX, SQUARE_PX)], style);
    let drawn = match mark.shape {
        MarkShape::Ring => chart.draw_series(at.map(|at| Circle::new(at, RING_PX, style))),
        MarkShape::Square => chart.draw_series(at.map(|at| EmptyElement::at(at) + square())),
    };
    let drawn = drawn.map_err(|e| anyhow!("{e}"))?.label(&mark.name);
    match mark.shape {
        MarkShape::Ring => drawn.legend(move |(x, y)| Circle::new((x + 10, y), DOT_PX + 1, style)),
        MarkShape::Square => drawn.legend(move |(x, y)| Rectangle::new([(x + 5, y - 5), (x + 15, y + 5)], style)),
    };
    Ok(())
}

impl Chart {
    /// All labelled points.
    pub(super) fn points(&self) -> impl Iterator<Item = &Point> {
        self.items
            .iter()
            .filter_map(|item| if let Item::Points { points, .. } = item { Some(points) } else { None })
            .flatten()
    }

    fn marks(&self) -> impl Iterator<Item = &Mark> {
        self.items.iter().filter_map(|item| if let Item::Mark(mark) = item { Some(mark) } else { None })
    }

    /// Writes the points' labels, clear of each other and of the legend where there is room.
    pub(super) fn draw_labels<B: Backend, X: Axis, Y: Axis>(
        &self,
        chart: &mut Area<'_, B, X, Y>,
        legend: Place,
    ) -> anyhow::Result<()> {
        let (across, down) = chart.plotting_area().get_pixel_range();
        let about = |(x, y): (i32, i32), half: i32| [x - half, y - half, x + half, y + half];
        let drawable: Vec<&Point> = self.points().filter(|point| on_axes(chart, point.x, point.y)).collect();
        let mut taken: Vec<Place> = vec![legend];
        taken.extend(drawable.iter().map(|point| about(chart.backend_coord(&(point.x, point.y)), DOT_PX)));
        taken.extend(drawable.iter().filter_map(|point| bar(chart, point)).map(|(low, high, y)| {
            let [(left, y), (right, _)] = [low, high].map(|x| chart.backend_coord(&(x, y)));
            [left, y - 1, right, y + 1]
        }));
        let marks = self.marks().filter(|mark| on_axes(chart, mark.x, mark.y));
        taken.extend(marks.map(|mark| about(chart.backend_coord(&(mark.x, mark.y)), RING_PX)));
        let mut points: Vec<&Point> = drawable.into_iter().filter(|point| !point.label.is_empty()).collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        let marked = |point: &Point| self.marks().any(|mark| mark.x == point.x && mark.y == point.y);
        let labels: Vec<((i32, i32), i32, &str)> = points
            .iter()
            .map(|point| {
                let clear = if marked(point) { RING_PX } else { DOT_PX };
                (chart.backend_coord(&(point.x, point.y)), clear, point.label.as_str())
            })
            .collect();
        for (point, step) in points.iter().zip(label_steps(&labels, taken, &across, &down)) {
            let label = EmptyElement::at((point.x, point.y))
                + Text::new(point.label.clone(), step, ("sans-serif", 14).into_font());
            chart.draw_series(std::iter::once(label)).map_err(|e| anyhow!("{e}"))?;
        }
        Ok(())
    }

    /// The corner where the legend covers the fewest points (upper right if they are alike), and about where it lies
    /// there.
    pub(super) fn legend_corner<B: Backend, X: Axis, Y: Axis>(
        &self,
        chart: &Area<'_, B, X, Y>,
    ) -> (SeriesLabelPosition, Place) {
        let entries = || self.items.iter().filter_map(Item::name);
        let letters = entries().map(|name| name.chars().count() as i32).max().unwrap_or(0);
        let (beside, below) = LEGEND_EDGE_PX;
        let (width, height) = (letters * LETTER_PX + beside, entries().count() as i32 * LEGEND_LINE_PX as i32 + below);
        let (across, down) = chart.plotting_area().get_pixel_range();
        let covered = |place: &Place| {
            let points = self.points().filter(|point| on_axes(chart, point.x, point.y));
            let points = points.map(|point| chart.backend_coord(&(point.x, point.y)));
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

/// A counted colour.
pub(super) fn colour(k: usize) -> RGBColor {
    COLOURS[k % COLOURS.len()]
}
