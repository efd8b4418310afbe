//! The pictures: the nail with its places, and the error against the number of photodiodes.

use std::path::PathBuf;

use lunula_predictor::LayoutProblem;

use super::options::LayoutOptions;
use super::read::{Contrast, Given, Place};
use super::run::report::{LayoutFigures, MethodFigures};
use super::solve::Method;
use crate::figure::{Chart, Item, Point, draw_charts};
use crate::median::ends;
use crate::nail::Positions;

/// A map is drawn in at most so many boxes a side.
const MAP_BOXES: usize = 100;
/// Pixels of the picture's axes and margins, besides the nail.
const BESIDE_PX: f64 = 106.0;
const BELOW_PX: f64 = 110.0;
/// Pixels of a millimetre.
const MM_PX: f64 = 38.0;
const CHART_PX: [u32; 2] = [900, 560];

/// Draws the chosen places with their numbers, the thesis' eight hollow; below them the contrast of maps, else how well
/// each candidate does by itself (bright: least error).
pub(super) fn draw_places(
    given: &Given,
    problem: &LayoutProblem,
    figures: &LayoutFigures,
    thesis: &[usize],
    options: &LayoutOptions,
    [png, svg]: &[PathBuf; 2],
) -> anyhow::Result<()> {
    let half = [0.5 * options.nail_width, 0.5 * options.nail_length];
    let (shades, what) = match &given.contrast {
        Some(contrast) => (of_contrast(contrast, half), "SD of the mean maps over poses"),
        None => (of_candidates(given, problem, half), "a candidate by itself (bright: least error)"),
    };
    let chosen = &figures.chosen;
    let at = |u: f64, v: f64| [half[0] * u, half[1] * v];
    let point = |[x, y]: [f64; 2]| Point { x, y, label: String::new(), x_range: None };
    let own: Vec<[f64; 2]> = chosen.positions.photodiodes.iter().map(|one| at(one.u, one.v)).collect();
    let eight = Positions::thesis().photodiodes.into_iter().map(|one| point(at(one.u, one.v))).collect();
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[u, v]| at(u, v)).to_vec();
    let mut items = vec![
        Item::Shades(shades),
        Item::Line { name: Some("the nail's box".to_owned()), runs: vec![corners], colour: 2, width: 1 },
    ];
    if !thesis.is_empty() {
        items.push(Item::Points { name: Positions::thesis().name, points: eight, hollow: true, colour: 4 });
    }
    items.push(Item::Points {
        name: format!("{} chosen places", chosen.k),
        points: own.iter().map(|&at| point(at)).collect(),
        hollow: false,
        colour: 0,
    });
    let label = |(number, &at): (usize, &[f64; 2])| Item::Label {
        at,
        text: format!("P{}", number + 1),
        colour: 1,
        above: true,
    };
    items.extend(own.iter().enumerate().map(label));
    let reach = |half: f64| 2.0 * half * if given.contrast.is_some() { 1.25 } else { 1.0 };
    // The legend has room above the nail.
    let (width, height) = (MM_PX * reach(half[0]) + BESIDE_PX, MM_PX * reach(half[1]) + BELOW_PX + 110.0);
    let chart = Chart::new(
        format!("{} of {} candidates; grey: {what}", chosen.k, figures.candidates),
        "across the nail, mm",
        "along the nail, mm (distal up)",
        items,
        height as u32,
    );
    draw_charts(&[chart], width.max(640.0) as u32, png, svg)
}

type Shade = ([f64; 4], f64);

/// Each candidate's own error, as a box that reaches half-way to its neighbours.
fn of_candidates(given: &Given, problem: &LayoutProblem, half: [f64; 2]) -> Vec<Shade> {
    let costs: Vec<f64> = (0..given.places.len()).map(|place| problem.cost(&[place])).collect();
    let [low, high] = ends(costs.iter().copied());
    let nearest = |of: fn(&Place) -> f64| -> f64 {
        let mut all: Vec<f64> = given.places.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        let steps = all.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 1e-9);
        steps.fold(f64::INFINITY, f64::min).clamp(0.05, 0.2)
    };
    let (across, along) = (0.5 * nearest(|place| place.u), 0.5 * nearest(|place| place.v));
    let shade = |(place, cost): (&Place, &f64)| {
        let [x, y] = [half[0] * place.u, half[1] * place.v];
        let (dx, dy) = (half[0] * across, half[1] * along);
        // Not to black: what is no candidate is white.
        ([x - dx, y - dy, x + dx, y + dy], 0.3 + 0.6 * (high - cost) / (high - low).max(1e-12))
    };
    given.places.iter().zip(&costs).map(shade).collect()
}

fn of_contrast(contrast: &Contrast, half: [f64; 2]) -> Vec<Shade> {
    let (rows, columns) = contrast.sd.dim();
    let n = MAP_BOXES.min(rows).min(columns);
    let block = |row: usize, column: usize| -> Option<f64> {
        let pixels = (row * rows / n..(row + 1) * rows / n)
            .flat_map(|y| (column * columns / n..(column + 1) * columns / n).map(move |x| [y, x]));
        let known: Vec<f64> = pixels.map(|at| f64::from(contrast.sd[at])).filter(|sd| sd.is_finite()).collect();
        (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
    };
    let cells = (0..n * n).filter_map(|k| Some((k / n, k % n, block(k / n, k % n)?)));
    let cells: Vec<(usize, usize, f64)> = cells.collect();
    let [_, high] = ends(cells.iter().map(|cell| cell.2));
    let edge = |k: usize| contrast.margin * (2.0 * k as f64 / n as f64 - 1.0);
    let shade = |&(row, column, sd): &(usize, usize, f64)| {
        let ends = [half[0] * edge(column), -half[1] * edge(row + 1), half[0] * edge(column + 1), -half[1] * edge(row)];
        (ends, sd / high.max(1e-12))
    };
    cells.iter().map(shade).collect()
}

/// Draws errors of persons left out, where there are any, with intervals; else of the rows that layouts were chosen by.
pub(super) fn draw_errors(figures: &LayoutFigures, [png, svg]: &[PathBuf; 2]) -> anyhow::Result<()> {
    let left_out = figures.methods.iter().all(|one| one.left_out.is_some());
    let value = |one: &MethodFigures| one.left_out.filter(|_| left_out).map_or(one.error, |own| own.error);
    let mut items = Vec::new();
    let methods = [
        (Method::Best, "best", 0, 3),
        (Method::Greedy, "greedy", 2, 1),
        (Method::Qr, "QR pivots", 3, 1),
        (Method::DOptimal, "D-optimal", 5, 1),
    ];
    let ks: Vec<f64> =
        figures.methods.iter().filter(|one| one.method == Method::Best).map(|one| one.k as f64).collect();
    let [first, last] = ends(ks);
    for (at, (method, name, colour, width)) in methods.into_iter().enumerate() {
        let own: Vec<&MethodFigures> = figures.methods.iter().filter(|one| one.method == method).collect();
        // Side by side, or the marks would hide each other.
        let aside = 0.03 * (at as f64 - 1.5);
        let run = own.iter().map(|one| [one.k as f64 + aside, value(one)]).collect();
        items.push(Item::Line { name: Some(name.to_owned()), runs: vec![run], colour, width });
        let marks = own.iter().filter_map(|one| one.left_out.filter(|_| left_out).map(|own| (one.k, own.interval)));
        let marks = marks.map(|(k, [low, high])| [k as f64 + aside, low, high]).collect();
        items.push(Item::Errors { marks, colour });
    }
    for one in &figures.methods {
        let flat = |name: &str, colour| Item::Line {
            name: Some(name.to_owned()),
            runs: vec![vec![[first - 0.2, value(one)], [last + 0.2, value(one)]]],
            colour,
            width: 2,
        };
        match one.method {
            Method::Thesis => {
                items.push(flat("the thesis' eight", 1));
                let point = Point { x: last, y: value(one), label: String::new(), x_range: None };
                items.push(Item::Points {
                    name: "(8 photodiodes)".to_owned(),
                    points: vec![point],
                    hollow: true,
                    colour: 1,
                });
            }
            Method::All => items.push(flat(&format!("all {} candidates", one.k), 4)),
            _ => {}
        }
    }
    let who =
        if left_out { "of persons left out, mean and 95 % interval" } else { "of the rows that they were chosen by" };
    let chart = Chart::new(
        format!("error against the number of photodiodes, {who}"),
        "photodiodes",
        if figures.error_of_none == 0.5 && left_out {
            "share put to the wrong one of two poses"
        } else if figures.error_of_none == 0.5 {
            "confusion of two poses, at most"
        } else {
            "RMSE over the target's SD"
        },
        items,
        CHART_PX[1],
    )
    .from_zero();
    draw_charts(&[chart], CHART_PX[0], png, svg)
}
