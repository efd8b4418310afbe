//! Static curves as Fig. 78: the photodiode of the pressed place over the load.

use std::fmt::Write;

use lunula_hemodynamics::{Collapse, Optics};

use super::{LITERAL, Named, SectionText};
use lunula::figure::{Item, draw_charts};
use lunula::files::Staging;
use lunula::hemodynamics::Pressed;
use lunula::hemodynamics::figures::{N_PER_CM2, WIDTH, chart};
use lunula::hemodynamics::solve::{Curve, along};

/// Loads of a curve, Pa.
const STEP_PA: f64 = 25.0;
const LOADS: u32 = 480;
/// Ends of the parts whose slopes are reported, N/cm2.
const PARTS: [[f64; 2]; 4] = [[0.0, 0.1], [0.1, 0.4], [0.4, 0.7], [0.9, 1.0]];

/// Draws and reports the curves of all sets.
pub(super) fn figure_78(text: &mut SectionText, sets: &[Named], staging: &Staging) -> anyhow::Result<()> {
    let loads_pa: Vec<f64> = (0..=LOADS).map(|k| STEP_PA * f64::from(k)).collect();
    writeln!(
        text,
        "Fig. 78: slope of the pressed place's photodiode over the load, mV per volt of scaling and N/cm2\n"
    )?;
    let parts: Vec<String> = PARTS.iter().map(|[from, to]| format!("{from} to {to}")).collect();
    writeln!(text, "| | {} | open up to, N/cm2 | several stable states, N/cm2 |", parts.join(" | "))?;
    writeln!(text, "|---|{}---|---|", "---|".repeat(PARTS.len()))?;
    let mut charts = Vec::new();
    for pressed in [Pressed::Proximal, Pressed::Distal, Pressed::Both] {
        let mut curves = Vec::new();
        for set in sets {
            let blood_pa = [set.parameters.upstream_pa(), set.parameters.downstream_pa()];
            let found = along(&set.parameters, Collapse::Error, &Optics::BeerLambert, pressed, &loads_pa, blood_pa)?;
            curves.push((set.name, found));
        }
        // As its caption: both places are pressed, and both photodiodes looked at.
        let (units, x): (&[usize], &str) = match pressed {
            Pressed::Proximal => (&[0], "PF1, N/cm2"),
            Pressed::Distal => (&[1], "PF2, N/cm2"),
            Pressed::Both => (&[0, 1], "PF1 and PF2, N/cm2"),
        };
        for &unit in units {
            let mut items = Vec::new();
            for (k, (name, found)) in curves.iter().enumerate() {
                if pressed != Pressed::Both {
                    tell(text, name, found, unit)?;
                }
                items.extend(shown(name, found, unit, k));
            }
            let title =
                if charts.is_empty() { "Steady state: light less that of rest; unstable parts thin" } else { "" };
            charts.push(chart(title, x, &format!("change of VP{}, mV", unit + 1), items));
        }
    }
    writeln!(text)?;
    draw_charts(&charts, WIDTH, &staging.place("fig-78.png")?, &staging.place("fig-78.svg")?)
}

fn tell(text: &mut SectionText, name: &str, found: &Curve, unit: usize) -> anyhow::Result<()> {
    let at = |load: f64| {
        let stable = found.points.iter().filter(|point| point.stable == Some(true));
        let mut near = stable.filter(|point| (point.load_pa - load * N_PER_CM2).abs() < 0.1 * STEP_PA);
        near.next().map(|point| 1e3 * point.volts[unit])
    };
    let slope = |[from, to]: &[f64; 2]| at(*from).zip(at(*to)).map(|(low, high)| (high - low) / (to - from));
    if name == LITERAL {
        for part in &PARTS {
            text.numbers.set(format!("fig78.VP{}_slope_{}_to_{}", unit + 1, part[0], part[1]), slope(part));
        }
    }
    let words = |part| slope(part).map_or("-".to_owned(), |slope: f64| format!("{slope:.2}"));
    let slopes: Vec<String> = PARTS.iter().map(words).collect();
    let open = found.closed_pa.first().map_or("1.2".to_owned(), |closed| format!("{:.6}", closed[0] / N_PER_CM2));
    let bistable: Vec<String> = found
        .bistable_pa
        .iter()
        .map(|[from, to]| format!("{:.6} to {:.6}", from / N_PER_CM2, to / N_PER_CM2))
        .collect();
    let bistable = if bistable.is_empty() { "none".to_owned() } else { bistable.join(", ") };
    writeln!(text, "| VP{}, {name} | {} | {open} | {bistable} |", unit + 1, slopes.join(" | "))?;
    Ok(())
}

fn shown(name: &str, found: &Curve, unit: usize, colour: usize) -> Vec<Item> {
    // Rest differs from set to set.
    let rest_v = found.points.first().map_or(f64::NAN, |point| point.volts.get(unit).copied().unwrap_or(f64::NAN));
    let change_mv = |volts: f64| 1e3 * (volts - rest_v);
    let branches = found.points.iter().filter_map(|point| point.branch).max().unwrap_or(0);
    let runs = |stable: bool| -> Vec<Vec<[f64; 2]>> {
        let of = |branch: usize| {
            let own = found.points.iter().filter(|point| point.branch == Some(branch) && point.stable == Some(stable));
            own.map(|point| [point.load_pa / N_PER_CM2, change_mv(point.volts[unit])]).collect()
        };
        (1..=branches).map(of).filter(|run: &Vec<_>| !run.is_empty()).collect()
    };
    let mut items = Vec::new();
    if !found.bistable_pa.is_empty() {
        let spans = found.bistable_pa.iter().map(|span| span.map(|load_pa| load_pa / N_PER_CM2)).collect();
        items.push(Item::Spans { name: None, spans });
    }
    items.push(Item::Line { name: Some(name.to_owned()), runs: runs(true), colour, width: 2 });
    items.push(Item::Line { name: None, runs: runs(false), colour, width: 1 });
    for (what, label, ink) in [("fold", "fold: the state jumps", 3), ("closes", "a vessel closes", 2)] {
        let own = found.folds.iter().filter(|fold| fold.what.ends_with(what));
        let points: Vec<[f64; 2]> = own.map(|fold| [fold.load_pa / N_PER_CM2, change_mv(fold.volts[unit])]).collect();
        if !points.is_empty() {
            items.push(Item::Dots { name: Some(format!("{name}: {label}")), points, colour: ink });
        }
    }
    items
}
