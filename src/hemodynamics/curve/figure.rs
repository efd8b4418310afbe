//! Static curves as Fig. 78: photodiodes over the load, folds and bistable ranges marked.

use std::path::Path;

use super::{CurvePoint, Fold};
use crate::figure::{Item, draw_charts};
use crate::hemodynamics::figures::{N_PER_CM2, WIDTH, chart};

/// Draws every photodiode over the load.
pub(in crate::hemodynamics) fn draw_curve(
    title: &str,
    points: &[CurvePoint],
    folds: &[Fold],
    bistable_pa: &[[f64; 2]],
    png: &Path,
    svg: &Path,
) -> anyhow::Result<()> {
    let units = points.iter().map(|point| point.volts.len()).max().unwrap_or(0);
    let across = |load_pa: f64| load_pa / N_PER_CM2;
    let reach: Vec<[f64; 2]> = points.iter().map(|point| [across(point.load_pa), f64::NAN]).collect();
    let charts: Vec<_> = (0..units)
        .map(|i| {
            let mut items = vec![Item::Room(reach.clone())];
            if !bistable_pa.is_empty() {
                let spans = bistable_pa.iter().map(|span| span.map(across)).collect();
                items.push(Item::Spans { name: Some("several stable states".to_owned()), spans });
            }
            let runs = |stable: bool| -> Vec<Vec<[f64; 2]>> {
                let branches = points.iter().filter_map(|point| point.branch).max().unwrap_or(0);
                let of = |branch: usize| {
                    let own = points.iter().filter(move |point| point.branch == Some(branch));
                    let own = own.filter(move |point| point.stable == Some(stable) && point.volts.len() > i);
                    own.map(|point| [across(point.load_pa), point.volts[i]]).collect()
                };
                (1..=branches).map(of).filter(|run: &Vec<_>| !run.is_empty()).collect()
            };
            for (name, stable, colour) in [("stable", true, 0), ("unstable", false, 1)] {
                let runs = runs(stable);
                if !runs.is_empty() {
                    items.push(Item::Line { name: Some(name.to_owned()), runs, colour, width: 2 });
                }
            }
            for (what, colour) in [("fold", 3), ("closes", 4), ("stability changes", 5)] {
                let own = folds.iter().filter(|fold| fold.what.ends_with(what));
                let points: Vec<[f64; 2]> = own.map(|fold| [across(fold.load_pa), fold.volts[i]]).collect();
                if !points.is_empty() {
                    let name = if what == "closes" { "a vessel closes" } else { what };
                    items.push(Item::Dots { name: Some(name.to_owned()), points, colour });
                }
            }
            let title = if i == 0 { title } else { "" };
            let x = if i + 1 == units { "load, N/cm2" } else { "" };
            chart(title, x, &format!("VP{}, V", i + 1), items)
        })
        .collect();
    draw_charts(&charts, WIDTH, png, svg)
}
