//! The picture of a calibration: where on the picture corners were seen, and what is left of each view.

use std::path::Path;

use super::fit::Fit;
use super::judge::{CELLS, View};
use crate::figure::{Bar, Chart, Item, draw_charts};

const WIDTH_PX: u32 = 1000;
/// Room for the title and the axes beside the picture's frame, pixels.
const BESIDE_PX: (f64, f64) = (106.0, 100.0);
/// How many times too long residuals are drawn.
const TIMES: f64 = 200.0;

/// Draws both, one below the other.
pub(super) fn draw(
    fit: &Fit,
    views: &[View],
    (width, height): (usize, usize),
    png: &Path,
    svg: &Path,
) -> anyhow::Result<()> {
    let frame = (f64::from(WIDTH_PX) - BESIDE_PX.0) * height as f64 / width as f64;
    let charts = [
        Chart::new(
            format!("Corners of {} views on the picture (residuals {TIMES} times)", views.len()),
            "column, px",
            "row from the lower edge, px",
            corners(fit, views, [width as f64, height as f64]),
            (frame + BESIDE_PX.1) as u32,
        ),
        Chart::new("", "view", "residual, px RMS", residuals(fit), 260).from_zero(),
    ];
    draw_charts(&charts, WIDTH_PX, png, svg)
}

fn corners(fit: &Fit, views: &[View], [width, height]: [f64; 2]) -> Vec<Item> {
    let at = |[x, y]: [f64; 2]| [x, height - 1.0 - y];
    let lines = |count: usize, line: &dyn Fn(f64) -> [[f64; 2]; 2]| -> Vec<Item> {
        (0..=count).map(|k| Item::Path(line(k as f64 / count as f64).map(at).to_vec())).collect()
    };
    let (right, bottom) = (width - 0.5, height - 0.5);
    let upright = |share: f64| [[share * width - 0.5, -0.5], [share * width - 0.5, bottom]];
    let level = |share: f64| [[-0.5, share * height - 0.5], [right, share * height - 0.5]];
    let mut items = vec![Item::Room(vec![at([-0.5, -0.5]), at([right, bottom])])];
    items.extend(lines(CELLS[0], &upright));
    items.extend(lines(CELLS[1], &level));
    let seen = views.iter().flat_map(|view| &view.corners).map(|corner| at(corner.map(f64::from)));
    items.push(Item::Dots { name: None, points: seen.collect(), colour: 0 });
    let left = fit.views.iter().zip(views).flat_map(|(fitted, view)| view.corners.iter().zip(&fitted.residuals_px));
    let runs = left.map(|(corner, rest)| {
        let corner = corner.map(f64::from);
        vec![at(corner), at([0, 1].map(|axis| corner[axis] + TIMES * rest[axis]))]
    });
    items.push(Item::Line { name: None, runs: runs.collect(), colour: 1, width: 1 });
    items
}

fn residuals(fit: &Fit) -> Vec<Item> {
    let bar = |(k, view): (usize, &super::fit::FittedView)| Bar {
        at: k as f64 + 1.0,
        width: 0.7,
        value: view.rms_px(),
        error: None,
    };
    vec![Item::Bars { name: None, bars: fit.views.iter().enumerate().map(bar).collect(), colour: 0 }]
}
