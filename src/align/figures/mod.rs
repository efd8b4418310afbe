//! Pictures of an alignment: what the tie leaves over, and the labels over the photodiodes.
//!
//! Long recordings are thinned to their extremes; files do not grow with them.

use std::path::Path;

use super::tie::resolution_s;
use super::{Labels, Posture, Tie, TieMethod};
use crate::figure::{Chart, Item, MOST_BINS, Thinned, draw_charts};
use crate::log::{Channel, Samples};
use crate::words::fixed;

const WIDTH: u32 = 1400;
/// Of the tie's picture, pixels.
const TIE_PX: u32 = 520;
/// Of a photodiode's lane, pixels, and how much of it the curve takes; its name stands in the rest.
const LANE_PX: u32 = 58;
const LANE_SHARE: f64 = 0.68;
/// Times beyond this are written from a whole second on: seconds since 1970 have too many digits for an axis.
const LONG_S: f64 = 1e5;

/// Draws what the tie leaves over at each frame that it was found by, with the tie's standard error and, of a clock,
/// half its last digit's step: so much a reading leaves open. Draws nothing and says so where there is nothing left
/// over to be drawn.
pub(super) fn draw_tie(tie: &Tie, posture: &Posture, png: &Path, svg: &Path) -> anyhow::Result<bool> {
    let mut residuals: Vec<[f64; 2]> =
        tie.residuals_s.iter().copied().filter(|r| r[0].is_finite() && r[1].is_finite()).collect();
    residuals.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let [Some(first), Some(last)] = [residuals.first(), residuals.last()].map(|r| r.map(|r| r[0])) else {
        return Ok(false);
    };
    let mut thinned = Thinned::default();
    for &[time_s, left_s] in &residuals {
        thinned.push(time_s, std::iter::once(Some([1e3 * left_s, f64::NAN])));
    }
    let sds: Vec<[f64; 3]> = (0..=50)
        .map(|k| first + (last - first) * f64::from(k) / 50.0)
        .map(|t| (t, 1e3 * tie.timebase.sd_s(t)))
        .filter(|(_, sd)| sd.is_finite())
        .map(|(t, sd)| [t, -sd, sd])
        .collect();
    let edge = |runs: &[[f64; 3]], side: usize| runs.iter().map(|p| [p[0], p[side]]).collect::<Vec<_>>();
    let mut items = vec![
        Item::Dots { name: Some(found_by(tie)), points: thinned.curve(0).concat(), colour: 0 },
        Item::Band { runs: vec![sds.clone()], colour: 1 },
        Item::Line {
            name: Some("standard error of the tie".to_owned()).filter(|_| !sds.is_empty()),
            runs: vec![edge(&sds, 1), edge(&sds, 2)],
            colour: 1,
            width: 1,
        },
    ];
    let readings =
        posture.clock.as_ref().map(|clock| clock.read_s.as_slice()).filter(|_| tie.method == TieMethod::Clock);
    if let Some(step_s) = readings.and_then(resolution_s) {
        let half = 500.0 * step_s;
        let run = |at: f64| vec![[first, at], [last, at]];
        let name = format!("half a step of the clock's last digit, {half} ms");
        items.push(Item::Line { name: Some(name), runs: vec![run(-half), run(half)], colour: 2, width: 2 });
    }
    let chart = Chart::new(tie_in_words(tie), "time of the video, s", "left over by the tie, ms", items, TIE_PX);
    draw_charts(&[chart], WIDTH, png, svg)?;
    Ok(true)
}

/// What the dots are.
fn found_by(tie: &Tie) -> String {
    let count = tie.residuals_s.len();
    let drawn = if count > MOST_BINS { ", the extremes of neighbours drawn" } else { "" };
    match tie.method {
        TieMethod::Clock => format!("tie less the middle of what a reading allows: {count} frames{drawn}"),
        TieMethod::Offset | TieMethod::Correlate => format!("left over: {count} times{drawn}"),
    }
}

/// How the clocks are tied, in a line.
fn tie_in_words(tie: &Tie) -> String {
    let by = match tie.method {
        TieMethod::Clock => "Tied by the clock in the picture",
        TieMethod::Offset => "Tied by the offset that was given",
        TieMethod::Correlate => "Tied by correlation",
    };
    let line = &tie.timebase;
    let minus = |text: String| text.replace('-', "\u{2212}");
    let (offset_sd_s, drift_sd_ppm) = (line.offset_sd_s(), 1e6 * line.drift_sd);
    let places = decimals(offset_sd_s, [3, 6]);
    let within = tie.offset_interval_s.map(|[low, high]| format!(" ({low:.places$} to {high:.places$})"));
    let offset = with_error(line.offset_s(), offset_sd_s, places) + &within.unwrap_or_default();
    let drift = with_error(1e6 * line.drift, drift_sd_ppm, decimals(drift_sd_ppm, [0, 3]));
    let (offset, drift) = (minus(offset), minus(drift));
    format!("{by}: offset {offset} s, drift {drift} ppm")
}

/// Decimals that show two digits of a standard error, within limits; of an unknown one the fewest.
fn decimals(sd: f64, [least, most]: [usize; 2]) -> usize {
    (least..most).find(|&n| sd.is_nan() || sd * 10_f64.powi(n as i32) >= 9.5).unwrap_or(most)
}

/// A value with its standard error, if it is known.
fn with_error(value: f64, sd: f64, decimals: usize) -> String {
    let sd = if sd.is_finite() { format!(" \u{b1} {sd:.decimals$}") } else { String::new() };
    format!("{}{sd}", fixed(value, decimals))
}

/// Draws the photodiodes, each in a lane of its own from its lowest to its highest value, and below them the labels
/// with their standard errors, on the log's time. Where a label is missing it is grey.
pub(super) fn draw_labels(samples: &Samples, labels: &Labels, png: &Path, svg: &Path) -> anyhow::Result<()> {
    let first_s = samples.time_s.first().copied().unwrap_or(0.0);
    let base_s = if first_s.abs() > LONG_S { first_s.floor() } else { 0.0 };
    let time =
        if base_s == 0.0 { "time of the log, s".to_owned() } else { format!("time of the log less {base_s}, s") };
    let mut angles = Thinned::default();
    for (row, &time_s) in samples.time_s.iter().enumerate() {
        let known = |joint: usize| Some(labels.angles_deg[joint][row]).filter(|angle| angle.is_finite());
        let joints = (0..labels.joints.len()).map(|j| known(j).map(|angle| [angle, labels.sds_deg[j][row]]));
        angles.push(time_s - base_s, joints);
    }
    let spans = angles.lacking();
    let mut charts = Vec::new();
    if !samples.photodiodes.is_empty() {
        charts.push(lanes(samples, base_s, spans.clone()));
    }
    let name = Some("a label is missing".to_owned()).filter(|_| !spans.is_empty());
    let mut items = vec![Item::Spans { name, spans }];
    for (joint, name) in labels.joints.iter().enumerate() {
        items.push(Item::Band { runs: angles.band(joint), colour: joint });
        let name = Some(name.clone());
        items.push(Item::Line { name, runs: angles.curve(joint), colour: joint, width: 1 });
    }
    let counts = labels.counts();
    charts.push(Chart::new(
        format!(
            "Labels: {} of {} rows have all of them (bands: plus or minus one standard error)",
            counts.rows_labelled,
            counts.rows_labelled + counts.rows_unlabelled
        ),
        time,
        "angle, degrees of flexion",
        items,
        460,
    ));
    draw_charts(&charts, WIDTH, png, svg)
}

/// The photodiodes below each other.
fn lanes(samples: &Samples, base_s: f64, spans: Vec<[f64; 2]>) -> Chart {
    let count = samples.photodiodes.len();
    let extents: Vec<Option<[f64; 2]>> = samples.photodiodes.iter().map(extent).collect();
    let place = |channel: usize, value: f64| {
        let [low, high] = extents[channel].unwrap_or([value; 2]);
        // One that does not change lies in the middle.
        let share = if high > low { (value - low) / (high - low) } else { 0.5 };
        (count - 1 - channel) as f64 + LANE_SHARE * share
    };
    let mut thinned = Thinned::default();
    for (row, &time_s) in samples.time_s.iter().enumerate() {
        let values = samples.photodiodes.iter().map(|channel| channel.values[row]);
        let known = values.enumerate().map(|(k, v)| v.is_finite().then(|| [place(k, v), f64::NAN]));
        thinned.push(time_s - base_s, known);
    }
    let start_s = samples.time_s.first().map_or(0.0, |first| first - base_s);
    let mut items = vec![Item::Spans { name: None, spans }];
    for (k, (channel, extent)) in samples.photodiodes.iter().zip(&extents).enumerate() {
        items.push(Item::Line { name: None, runs: thinned.curve(k), colour: k, width: 1 });
        let text = match extent {
            Some([low, high]) => format!("{}: {low:.3} to {high:.3} V", channel.name).replace('-', "\u{2212}"),
            None => format!("{}: no value", channel.name),
        };
        items.push(Item::Text { at: [start_s, (count - k) as f64 - 0.07], text, colour: k });
    }
    Chart::new("Photodiodes, each from its lowest to its highest value", "", "", items, 90 + LANE_PX * count as u32)
        .from_zero()
}

/// The lowest and the highest value; none where there is none.
fn extent(channel: &Channel) -> Option<[f64; 2]> {
    let known = channel.values.iter().filter(|value| value.is_finite());
    known.fold(None, |extent, &value| {
        let [low, high] = extent.unwrap_or([value; 2]);
        Some([value.min(low), value.max(high)])
    })
}

#[cfg(test)]
mod tests;
