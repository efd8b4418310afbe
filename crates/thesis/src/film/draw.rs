//! Both traces over each other, and the errors of both.

use super::Errors;
use super::pair::{Trace, Traces};
use lunula::figure::{Chart, Item, draw_panels};
use lunula::files::Staging;
use lunula::predictor::{BarSeries, Bars, draw_bars};

/// How much of the recording is drawn, seconds.
const SHOWN_S: f64 = 30.0;
const COLUMNS: usize = 2;
const PANEL: (u32, u32) = (620, 230);
/// The sensor's colour and the camera's.
const COLOURS: [usize; 2] = [0, 1];
const NAMES: [&str; 2] = ["sensor", "camera"];

/// A panel for each photodiode.
pub(super) fn traces(traces: &Traces, staging: &Staging) -> anyhow::Result<()> {
    let last = traces.all.len().saturating_sub(COLUMNS);
    let panels: Vec<Chart> = traces.all.iter().enumerate().map(|(k, trace)| panel(trace, k, k >= last)).collect();
    draw_panels(&panels, COLUMNS, PANEL.0, &staging.place("traces.png")?, &staging.place("traces.svg")?)
}

fn panel(trace: &Trace, k: usize, is_last: bool) -> Chart {
    let end_s = trace.camera.first().map_or(0.0, |first| first[0]) + SHOWN_S;
    let line = |points: &[[f64; 2]], colour: usize| Item::Line {
        name: (k == 0).then(|| NAMES[colour].to_owned()),
        // A frame that is lost breaks the line.
        runs: points
            .split(|point| !point[1].is_finite())
            .map(|run| run.iter().copied().filter(|point| point[0] <= end_s).collect::<Vec<_>>())
            .filter(|run| !run.is_empty())
            .collect(),
        colour: COLOURS[colour],
        width: 2 - colour as u32,
    };
    let title = match trace.correlation {
        Some(correlation) => format!("{}, correlation {correlation:.3}", trace.name),
        None => trace.name.clone(),
    };
    Chart::new(
        title,
        if is_last { "time, s" } else { "" },
        "volts",
        vec![line(&trace.sensor, 0), line(&trace.camera, 1)],
        PANEL.1,
    )
}

/// The errors on what is held out, with their ratio below.
pub(super) fn errors(errors: &[Errors], staging: &Staging) -> anyhow::Result<()> {
    let group =
        |one: &Errors| format!("{}\ncamera {:.2} x sensor", one.target.trim_end_matches("_N"), one.camera / one.sensor);
    let series = |name: &str, of: fn(&Errors) -> f64| BarSeries {
        name: name.to_owned(),
        values: errors.iter().map(|one| Some(of(one))).collect(),
        errors: Vec::new(),
    };
    let bars = Bars {
        title: "Linear models of sensor and camera on the path held out".to_owned(),
        x_label: String::new(),
        y_label: "RMSE, N".to_owned(),
        groups: errors.iter().map(group).collect(),
        series: vec![series(NAMES[0], |one| one.sensor), series(NAMES[1], |one| one.camera)],
    };
    draw_bars(&[bars], &staging.place("rmse.png")?, &staging.place("rmse.svg")?)
}
