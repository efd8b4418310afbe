//! Measured and fitted, as Fig. 79 to 82: over time, or over the load.

use std::path::Path;

use crate::figure::{Chart, Item, draw_panels};
use crate::hemodynamics::figures::{N_PER_CM2, chart, over_time};
use crate::hemodynamics::fit::recording::ReadRecording;
use crate::median::ends;

/// Panels in a row, and the width of each.
const COLUMNS: usize = 2;
const WIDTH: u32 = 640;
/// More panels than a picture shows.
pub(in crate::hemodynamics::fit) const MOST_PANELS: usize = 24;

/// A panel for every photodiode of every recording.
pub(in crate::hemodynamics::fit) fn draw_fit(
    recordings: &[ReadRecording],
    fitted: &[Vec<Vec<f64>>],
    png: &Path,
    svg: &Path,
) -> anyhow::Result<()> {
    let mut charts = Vec::new();
    for (read, fitted) in recordings.iter().zip(fitted) {
        for (k, name) in read.photodiodes.iter().enumerate() {
            let measured = &read.recording.photodiodes[k].voltages_v;
            charts.push(panel(&format!("{}: {name}", read.name), read, measured, &fitted[k]));
        }
    }
    charts.truncate(MOST_PANELS);
    draw_panels(&charts, COLUMNS, WIDTH, png, svg)
}

fn panel(title: &str, read: &ReadRecording, measured: &[f64], fitted: &[f64]) -> Chart {
    let named = |name: &str| Some(name.to_owned());
    match &read.times_s {
        Some(times_s) => {
            // The fitted curve may hide no measured one.
            let items = vec![
                over_time(named("measured"), times_s, measured, 5, 4),
                over_time(named("fitted"), times_s, fitted, 1, 1),
            ];
            chart(title, "time, s", "V", items)
        }
        None => {
            // The load that changes more is the axis.
            let span = |k: usize| {
                let [low, high] = ends(read.pressed_pa.iter().map(|both| both[k]));
                high - low
            };
            let axis = usize::from(span(1) > span(0));
            let at = |values: &[f64]| -> Vec<[f64; 2]> {
                let both = read.pressed_pa.iter().zip(values).filter(|(_, value)| value.is_finite());
                both.map(|(pressed_pa, value)| [pressed_pa[axis] / N_PER_CM2, *value]).collect()
            };
            let items = vec![
                Item::Dots { name: named("measured"), points: at(measured), colour: 0 },
                Item::Line { name: named("fitted"), runs: vec![at(fitted)], colour: 1, width: 2 },
            ];
            chart(title, ["PF1, N/cm2", "PF2, N/cm2"][axis], "V", items)
        }
    }
}
