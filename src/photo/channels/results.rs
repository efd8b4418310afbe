//! The comparison's files: `channels.csv` and the chart.

use super::compare::{ChannelFigures, ChannelRow, ZonesOf};
use crate::figure::{Bar, Chart, Item, draw_charts};
use crate::files::{Staging, WriteError};
use crate::photo::normalize::Channel;
use crate::table::{TextColumn, csv_bytes};

const TABLE: &str = "channels.csv";
const PNG: &str = "figures/channels.png";
const SVG: &str = "figures/channels.svg";
const COLUMNS: [TextColumn<ChannelRow>; 14] = [
    ("pose", |row| row.pose.clone()),
    ("tone", |row| row.tone.clone().unwrap_or_default()),
    ("channel", |row| row.channel.name().to_owned()),
    ("subjects", |row| row.subjects.to_string()),
    ("zones", |row| if row.zones == ZonesOf::Own { "own" } else { "others" }.to_owned()),
    ("white", |row| number(row.white)),
    ("red", |row| number(row.red)),
    ("contrast", |row| number(row.contrast.map(|of| of.mean))),
    ("low", |row| number(row.contrast.and_then(|of| of.low))),
    ("high", |row| number(row.contrast.and_then(|of| of.high))),
    ("relative", |row| number(row.relative.map(|of| of.mean))),
    ("relative_low", |row| number(row.relative.and_then(|of| of.low))),
    ("relative_high", |row| number(row.relative.and_then(|of| of.high))),
    ("at_full_scale", |row| number(row.at_full_scale)),
];
/// Tones with a chart of their own; the table has them all.
const MOST_CHARTS: usize = 8;

/// Writes table and chart, and keeps the chart for the report.
pub(in crate::photo) fn write(figures: &mut ChannelFigures, staging: &Staging) -> Result<(), WriteError> {
    let rows = figures.rows.iter().map(|row| COLUMNS.map(|(_, cell)| cell(row)));
    let table = csv_bytes(COLUMNS.map(|(name, _)| name), rows).map_err(|why| staging.refused(TABLE, why))?;
    staging.write(TABLE, &table)?;
    let poses = figures.rows.iter().filter(|row| row.tone.is_none()).count() / 3;
    let (png, svg) = (staging.place(PNG)?, staging.place(SVG)?);
    draw_charts(&charts(figures), width(poses), &png, &svg).map_err(|why| staging.refused(PNG, why))?;
    figures.chart = staging.read(PNG)?;
    Ok(())
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:.6}"))
}

/// Pixels of a chart over so many poses.
fn width(poses: usize) -> u32 {
    (220 + 120 * poses as u32).clamp(640, 6000)
}

/// One chart of all subjects, then one for each tone.
fn charts(figures: &ChannelFigures) -> Vec<Chart> {
    let mut tones: Vec<Option<&str>> = figures.rows.iter().map(|row| row.tone.as_deref()).collect();
    tones.sort_unstable();
    tones.dedup();
    let mut poses: Vec<&str> = figures.rows.iter().map(|row| row.pose.as_str()).collect();
    poses.dedup();
    // All charts have the same scale.
    let reach = |row: &ChannelRow| row.contrast.map(|of| [of.low.unwrap_or(of.mean), of.high.unwrap_or(of.mean)]);
    let room: Vec<[f64; 2]> = figures.rows.iter().filter_map(reach).flatten().map(|end| [0.0, 100.0 * end]).collect();
    let chart = |tone: Option<&str>| {
        let rows: Vec<&ChannelRow> = figures.rows.iter().filter(|row| row.tone.as_deref() == tone).collect();
        let names = poses.iter().enumerate().map(|(at, pose)| (at as f64, pose.replace('_', "\n"))).collect();
        let mut items: Vec<Item> = [Channel::Red, Channel::Green, Channel::Blue]
            .into_iter()
            .map(|channel| bars(channel, rows.iter().copied().filter(|row| row.channel == channel), &poses))
            .collect();
        items.extend([Item::Names(names), Item::Room(room.clone())]);
        let whose = tone.map_or_else(|| "all subjects".to_owned(), |tone| format!("skin tone {tone}"));
        Chart::new(format!("White less red zones: {whose}"), "", "contrast, % of full scale", items, 420).from_zero()
    };
    tones.into_iter().take(1 + MOST_CHARTS).map(chart).collect()
}

/// A channel's bars, beside the other channels' at each pose, in the colour that is nearest to its own.
fn bars<'a>(channel: Channel, rows: impl Iterator<Item = &'a ChannelRow>, poses: &[&str]) -> Item {
    const WIDTH: f64 = 0.26;
    let (offset, colour) = match channel {
        Channel::Red => (-WIDTH, 1),
        Channel::Green => (0.0, 2),
        Channel::Blue => (WIDTH, 0),
    };
    let bar = |row: &ChannelRow| {
        let at = poses.iter().position(|pose| *pose == row.pose)? as f64 + offset;
        let contrast = row.contrast?;
        let ends = contrast.low.zip(contrast.high).map(|(low, high)| [100.0 * low, 100.0 * high]);
        Some(Bar { at, width: WIDTH, value: 100.0 * contrast.mean, error: ends })
    };
    Item::Bars { name: Some(channel.name().to_owned()), bars: rows.filter_map(bar).collect(), colour }
}
