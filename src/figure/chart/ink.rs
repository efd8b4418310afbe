//! How the items of a chart are drawn.

use anyhow::anyhow;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::super::picture::Backend;
use super::super::text::shortened;
use super::item::{Bar, Item};
use super::points::{Area, Axis, colour, draw_mark, draw_path, draw_points};
use super::reach::near;

/// Draws an item; spans and names are drawn with the axes.
pub(super) fn draw_item<B: Backend, X: Axis, Y: Axis>(
    chart: &mut Area<'_, B, X, Y>,
    item: &Item,
) -> anyhow::Result<()> {
    let failed = |e: DrawingAreaErrorKind<B::ErrorType>| anyhow!("{e}");
    match item {
        Item::Spans { .. } | Item::Names(_) | Item::Room(_) => {}
        Item::Shades(boxes) => {
            let shade = |(ends, level): &([f64; 4], f64)| {
                let [left, low, right, high] = *ends;
                let grey = (level.clamp(0.0, 1.0) * 255.0).round() as u8;
                Rectangle::new([near(left, low), near(right, high)], RGBColor(grey, grey, grey).filled())
            };
            chart.draw_series(boxes.iter().map(shade)).map_err(failed)?;
        }
        Item::Band { runs, colour: k } => {
            let fill = colour(*k).mix(0.3).filled();
            let outline = |run: &Vec<[f64; 3]>| -> Vec<(f64, f64)> {
                let below = run.iter().map(|p| near(p[0], p[1]));
                below.chain(run.iter().rev().map(|p| near(p[0], p[2]))).collect()
            };
            let bands = runs.iter().filter(|run| run.len() > 1);
            chart.draw_series(bands.map(|run| Polygon::new(outline(run), fill))).map_err(failed)?;
        }
        Item::Line { name, runs, colour: k, width } => {
            let (ink, dot) = (colour(*k).stroke_width(*width), colour(*k).filled());
            let long = runs.iter().filter(|run| run.len() > 1);
            let drawn = chart
                .draw_series(
                    long.map(|run| PathElement::new(run.iter().map(|p| near(p[0], p[1])).collect::<Vec<_>>(), ink)),
                )
                .map_err(failed)?;
            if let Some(name) = name {
                drawn.label(name).legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], ink.stroke_width(2)));
            }
            let single = runs.iter().filter(|run| run.len() == 1);
            chart.draw_series(single.map(|run| Circle::new(near(run[0][0], run[0][1]), 2, dot))).map_err(failed)?;
        }
        Item::Text { at, text, colour: k } => {
            let style = ("sans-serif", 14).into_font().color(&colour(*k));
            let written = Text::new(text.clone(), near(at[0], at[1]), style);
            chart.draw_series(std::iter::once(written)).map_err(failed)?;
        }
        Item::Label { at, text, colour: k, above } => {
            let (place, aside) = if *above { (VPos::Bottom, (4, -5)) } else { (VPos::Top, (-4, 6)) };
            let side = if *above { HPos::Left } else { HPos::Right };
            let style = ("sans-serif", 14).into_font().color(&colour(*k)).pos(Pos::new(side, place));
            let written = EmptyElement::at(near(at[0], at[1])) + Text::new(text.clone(), aside, style);
            chart.draw_series(std::iter::once(written)).map_err(failed)?;
        }
        Item::Diagonal { name } => {
            let (x, ink) = (chart.x_range(), BLACK.mix(0.6).stroke_width(1));
            let line = PathElement::new([(x.start, x.start), (x.end, x.end)], ink);
            let drawn = chart.draw_series(std::iter::once(line)).map_err(failed)?;
            if let Some(name) = name {
                drawn.label(name).legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], ink));
            }
        }
        Item::Bars { name, bars, colour: k } => {
            let ink = colour(*k).filled();
            let known = || bars.iter().filter(|bar| bar.value.is_finite());
            let shape = |bar: &Bar| {
                let half = 0.5 * bar.width;
                Rectangle::new([near(bar.at - half, 0.0), near(bar.at + half, bar.value)], ink)
            };
            let drawn = chart.draw_series(known().map(shape)).map_err(failed)?;
            if let Some(name) = name {
                drawn.label(name).legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 20, y + 5)], ink));
            }
            let dark = RGBColor(34, 34, 34).stroke_width(1);
            let marks = known().filter_map(|bar| Some((bar, bar.error?))).flat_map(|(bar, [low, high])| {
                let side = 0.2 * bar.width;
                let across = |y: f64| vec![(bar.at - side, y), (bar.at + side, y)];
                [vec![(bar.at, low), (bar.at, high)], across(low), across(high)]
            });
            chart
                .draw_series(
                    marks.map(|mark| {
                        PathElement::new(mark.into_iter().map(|(x, y)| near(x, y)).collect::<Vec<_>>(), dark)
                    }),
                )
                .map_err(failed)?;
        }
        Item::Errors { marks, colour: k } => {
            let ink = colour(*k).stroke_width(1);
            let known = marks.iter().filter(|mark| mark.iter().all(|value| value.is_finite()));
            let upright = known.clone().map(|&[x, low, high]| PathElement::new([near(x, low), near(x, high)], ink));
            chart.draw_series(upright).map_err(failed)?;
            let cap = |(x, y)| EmptyElement::at((x, y)) + PathElement::new([(-3, 0), (3, 0)], ink);
            let ends = known.flat_map(|&[x, low, high]| [near(x, low), near(x, high)]);
            chart.draw_series(ends.map(cap)).map_err(failed)?;
        }
        Item::Points { name, points, hollow, colour: k } => draw_points(chart, name, points, *hollow, colour(*k))?,
        Item::Mark(mark) => draw_mark(chart, mark)?,
        Item::Path(points) => draw_path(chart, points)?,
        Item::Dots { name, points, colour: k } => {
            let ink = colour(*k).mix(0.6).filled();
            let drawn =
                chart.draw_series(points.iter().map(|p| Circle::new(near(p[0], p[1]), 2, ink))).map_err(failed)?;
            if let Some(name) = name {
                drawn.label(name).legend(move |(x, y)| Circle::new((x + 10, y), 3, ink));
            }
        }
    }
    Ok(())
}

/// Writes names below the horizontal axis, each shortened to the room that its neighbours leave.
pub(super) fn draw_names<B: Backend, X: Axis, Y: Axis>(
    area: &DrawingArea<B, plotters::coord::Shift>,
    chart: &Area<'_, B, X, Y>,
    names: &[(f64, String)],
) -> anyhow::Result<()> {
    let base = area.get_base_pixel();
    let y = chart.y_range().start;
    let place = |x: f64| {
        let at = chart.backend_coord(&(x, y));
        (at.0 - base.0, at.1 - base.1 + 8)
    };
    let places: Vec<(i32, i32)> = names.iter().map(|(x, _)| place(*x)).collect();
    let step = places.windows(2).map(|pair| pair[0].0.abs_diff(pair[1].0)).min();
    let room = step.unwrap_or_else(|| area.dim_in_pixel().0);
    let style = ("sans-serif", NAME_PX).into_font().color(&BLACK).pos(Pos::new(HPos::Center, VPos::Top));
    for ((_, name), (x, y)) in names.iter().zip(places) {
        for (k, line) in name.lines().enumerate() {
            let line = shortened(line, NAME_PX as f32, room.saturating_sub(4));
            area.draw_text(&line, &style, (x, y + NAME_LINE_PX as i32 * k as i32)).map_err(|e| anyhow!("{e}"))?;
        }
    }
    Ok(())
}

/// Height of a name's letters.
const NAME_PX: u32 = 15;
/// Height of a name's line.
pub(super) const NAME_LINE_PX: u32 = 18;
