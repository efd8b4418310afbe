//! Pictures of a recording: forces over time, outputs over time and over the driving signal at their places on the
//! nail, J3 over J2.

use std::path::Path;

use super::curve::{Curve, Point};
use super::places::Places;
use lunula::figure::{Cell, Chart, Item, draw_charts, draw_grid};
use lunula::hemodynamics::figures::over_time;

/// A panel at its place, pixels.
const PANEL: [u32; 2] = [420, 250];
/// Width of a single picture.
const WIDTH: u32 = 1260;

/// What a signal is called on an axis, with its unit.
pub(super) fn words(name: &str) -> String {
    match name {
        "Fx_N" => "lateral shear force Fx, N".to_owned(),
        "Fy_N" => "longitudinal shear force Fy, N".to_owned(),
        "Fz_N" => "normal force Fz, N".to_owned(),
        "J1_deg" | "J2_deg" | "J3_deg" => format!("{}, degrees", &name[..2]),
        other => other.to_owned(),
    }
}

/// As a signal rises and as it falls.
fn ways(drive: &str) -> [String; 2] {
    match drive {
        "Fz_N" => ["letting go (Fz rises)", "pressing (Fz falls)"].map(str::to_owned),
        "J1_deg" | "J2_deg" | "J3_deg" => ["flexing", "extending"].map(str::to_owned),
        _ => [format!("{} rises", &drive[..2]), format!("{} falls", &drive[..2])],
    }
}

/// Signals over time on one chart (Fig. 23, 26, 29).
pub(super) fn moves(time_s: &[f64], signals: &[(&str, &[f64])], y: &str, png: &Path, svg: &Path) -> anyhow::Result<()> {
    let items = signals.iter().enumerate().map(|(k, (name, values))| {
        over_time(Some(name.split('_').next().unwrap_or(name).to_owned()), time_s, values, k, 2)
    });
    let chart = Chart::new("", "time, s", y, items.collect(), 400);
    draw_charts(&[chart], WIDTH, png, svg)
}

/// The least and the greatest value of items.
type Reach = [f64; 2];

fn reach(values: impl Iterator<Item = f64>) -> Option<Reach> {
    let ends = values
        .filter(|value| value.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
    (ends[0] <= ends[1]).then_some(ends)
}

/// Volts that every panel spans: as many as the greatest needs.
fn span(reaches: &[Option<Reach>]) -> f64 {
    let widest = reaches.iter().flatten().map(|[low, high]| high - low).fold(0.0, f64::max);
    if widest > 0.0 { widest } else { 0.1 }
}

/// The ends of a panel's axis: the span about the middle of its own values.
fn room(reach: Option<Reach>, span: f64, x: Reach) -> Item {
    let [low, high] = reach.unwrap_or([0.0, 0.0]);
    let middle = 0.5 * (low + high);
    Item::Room(vec![[x[0], middle - 0.5 * span], [x[1], middle + 0.5 * span]])
}

/// Puts panels at their places, a key into the first that is free.
fn arranged(
    names: &[String],
    places: &Places,
    key: (Vec<String>, Vec<(usize, String)>),
    panel: impl Fn(usize) -> Chart,
    png: &Path,
    svg: &Path,
) -> anyhow::Result<()> {
    let mut rows: Vec<Vec<Cell>> = places
        .arrange(names, panel)
        .into_iter()
        .map(|row| row.into_iter().map(|chart| chart.map_or(Cell::Empty, Cell::Chart)).collect())
        .collect();
    let key = Cell::Key { words: key.0, colours: key.1 };
    match rows.iter_mut().flatten().find(|cell| matches!(cell, Cell::Empty)) {
        Some(free) => *free = key,
        None => rows.push(vec![key]),
    }
    draw_grid(&rows, PANEL, png, svg)
}

fn volts(value: f64) -> String {
    if value >= 0.1 { format!("{value:.2} V") } else { format!("{:.1} mV", 1e3 * value) }
}

/// Outputs over time at their places, on one scale (Fig. 24, 27, 30, 32).
pub(super) fn outputs(
    time_s: &[f64],
    outputs: &[(String, &[f64])],
    places: &Places,
    png: &Path,
    svg: &Path,
) -> anyhow::Result<()> {
    let reaches: Vec<_> = outputs.iter().map(|(_, values)| reach(values.iter().copied())).collect();
    let span = span(&reaches);
    let x = reach(time_s.iter().copied()).unwrap_or([0.0, 1.0]);
    let names: Vec<String> = outputs.iter().map(|(name, _)| name.clone()).collect();
    let panel = |k: usize| {
        Chart::new(
            names[k].clone(),
            "time, s",
            "output, V",
            vec![room(reaches[k], span, x), over_time(None, time_s, outputs[k].1, 0, 2)],
            PANEL[1],
        )
    };
    let words = vec![
        "Photodiodes at their places on the nail,".to_owned(),
        "distal at the top, seen from above.".to_owned(),
        format!("One scale: every axis spans {}.", volts(span)),
    ];
    arranged(&names, places, (words, Vec::new()), panel, png, svg)
}

/// Averages over cycles with their SD, rising and falling apart (Fig. 25, 28, 31, 34).
pub(super) fn averages(
    curves: &[(String, Curve)],
    drive: &str,
    places: &Places,
    png: &Path,
    svg: &Path,
) -> anyhow::Result<()> {
    let points = |curve: &Curve, up: bool| -> Vec<(f64, Option<Point>)> {
        curve.at.iter().copied().zip(if up { curve.rising.clone() } else { curve.falling.clone() }).collect()
    };
    let ends = |point: Point| {
        let sd = point.sd.unwrap_or(0.0);
        [point.mean - sd, point.mean + sd]
    };
    let reaches: Vec<_> = curves
        .iter()
        .map(|(_, curve)| reach(curve.rising.iter().chain(&curve.falling).flatten().flat_map(|point| ends(*point))))
        .collect();
    let span = span(&reaches);
    let x = reach(curves.iter().flat_map(|(_, curve)| curve.at.iter().copied())).unwrap_or([0.0, 1.0]);
    let panel = |k: usize| {
        let mut items = vec![room(reaches[k], span, x)];
        for (colour, up) in [(0, true), (1, false)] {
            let own = points(&curves[k].1, up);
            let runs = own.split(|(_, point)| point.is_none());
            let runs = runs
                .map(|run| run.iter().filter_map(|(at, point)| Some([*at, (*point)?.mean])).collect::<Vec<_>>())
                .filter(|run| !run.is_empty());
            let marks = own.iter().filter_map(|(at, point)| {
                let [low, high] = (*point)?.sd.map(|_| ()).and(point.map(ends))?;
                Some([*at, low, high])
            });
            items.push(Item::Errors { marks: marks.collect(), colour });
            items.push(Item::Line { name: None, runs: runs.collect(), colour, width: 2 });
        }
        Chart::new(curves[k].0.clone(), words(drive), "output, V", items, PANEL[1])
    };
    let names: Vec<String> = curves.iter().map(|(name, _)| name.clone()).collect();
    let legs = |of: fn(&Curve) -> &Vec<Option<Point>>| {
        curves.iter().flat_map(|(_, curve)| of(curve)).flatten().map(|point| point.legs).max().unwrap_or(0)
    };
    let [up, down] = ways(drive);
    let key = (
        vec![
            "Mean over cycles; marks: SD over cycles (n - 1).".to_owned(),
            "Distal at the top, seen from above.".to_owned(),
            format!("One scale: every axis spans {}.", volts(span)),
        ],
        vec![
            (0, format!("{up}, {} times", legs(|c| &c.rising))),
            (1, format!("{down}, {} times", legs(|c| &c.falling))),
        ],
    );
    arranged(&names, places, key, panel, png, svg)
}

/// One angle over another, with the straight line through both (Fig. 33).
pub(super) fn coupling(j2: &[f64], j3: &[f64], line: [f64; 2], r2: f64, png: &Path, svg: &Path) -> anyhow::Result<()> {
    let points: Vec<[f64; 2]> =
        j2.iter().zip(j3).filter(|(a, b)| a.is_finite() && b.is_finite()).map(|(&a, &b)| [a, b]).collect();
    let ends = reach(points.iter().map(|point| point[0])).unwrap_or([0.0, 1.0]);
    let [offset, slope] = line;
    let name = format!(
        "J3 = {slope:.2} J2 {} {:.1} degrees, R2 = {r2:.3}",
        if offset < 0.0 { "-" } else { "+" },
        offset.abs()
    );
    let chart = Chart::new(
        "",
        "J2 (proximal interphalangeal), degrees",
        "J3 (distal interphalangeal), degrees",
        vec![
            Item::Dots { name: Some("rows".to_owned()), points, colour: 5 },
            Item::Line {
                name: Some(name),
                runs: vec![ends.map(|x| [x, offset + slope * x]).to_vec()],
                colour: 1,
                width: 2,
            },
        ],
        520,
    );
    draw_charts(&[chart], 900, png, svg)
}
