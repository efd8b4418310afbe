//! What a person looks at: the photodiodes over time, and the nail in its own frame through a press.

use std::mem;

use image::RgbImage;

use super::report::NailVideoReport;
use crate::figure::{Chart, Item, Page, Sheet, Thinned, Tile, TilePicture, draw_charts};
use crate::files::{Staging, WriteError};
use crate::median::median_of;
use crate::nailvideo::affine::Affine;
use crate::nailvideo::normal::picture;
use crate::nailvideo::press::{Event, Recording, Row, USE};
use crate::nailvideo::sample::Colours;

/// Side of a picture of the sheet, pixels, how many are kept, how far apart at least, seconds, and how many are drawn.
const SIDE: usize = 160;
const MOST: usize = 192;
const APART_S: f64 = 0.1;
const TILES: usize = 10;
const WIDTH: u32 = 1400;

/// Small normalized frames, evenly over the video as far as it has been read: at most [`MOST`].
#[derive(Debug)]
pub(super) struct Thumbnails {
    kept: Vec<(f64, RgbImage)>,
    apart_s: f64,
}

impl Default for Thumbnails {
    fn default() -> Self {
        Self { kept: Vec::new(), apart_s: APART_S }
    }
}

impl Thumbnails {
    /// A frame that was followed.
    pub(super) fn offer(&mut self, time_s: f64, colours: &Colours, frame_from_nail: &Affine) {
        let is_due =
            |kept: &[(f64, RgbImage)], apart_s| kept.last().is_none_or(|(last_s, _)| time_s - last_s >= apart_s);
        if is_due(&self.kept, self.apart_s) && self.kept.len() == MOST {
            self.kept = mem::take(&mut self.kept).into_iter().step_by(2).collect();
            self.apart_s *= 2.0;
        }
        if is_due(&self.kept, self.apart_s) {
            self.kept.push((time_s, picture(colours, frame_from_nail, SIDE)));
        }
    }

    /// Those nearest to times evenly spread from one to another.
    fn between(&self, from_s: f64, to_s: f64) -> Vec<&(f64, RgbImage)> {
        let nearest = |k: usize| {
            let at = from_s + (to_s - from_s) * k as f64 / (TILES - 1) as f64;
            (0..self.kept.len()).min_by(|&a, &b| (self.kept[a].0 - at).abs().total_cmp(&(self.kept[b].0 - at).abs()))
        };
        let mut all: Vec<usize> = (0..TILES).filter_map(nearest).collect();
        all.dedup();
        all.into_iter().map(|k| &self.kept[k]).collect()
    }
}

/// Draws sheet and traces and writes `report.html`.
pub(super) fn draw(
    staging: &Staging,
    report: &mut NailVideoReport,
    recording: &Recording<'_>,
    rows: &[Row],
    thumbnails: &Thumbnails,
) -> Result<(), WriteError> {
    let sheet = sheet(recording, rows, thumbnails);
    let refused = |why: &dyn std::fmt::Display| staging.refused("sheet.png", why);
    let sheet_png = sheet.png().map_err(|why| refused(&why))?;
    staging.write("sheet.png", &sheet_png)?;
    staging.write("sheet.svg", sheet.svg().map_err(|why| refused(&why))?.as_bytes())?;
    let charts = charts(recording, rows, report.unit);
    let traces = staging.draw("traces", |png, svg| draw_charts(&charts, WIDTH, png, svg))?;
    staging.write("report.html", page(report, rows, &sheet_png, &staging.read("traces.png")?).as_bytes())?;
    report.pictures = vec![traces, staging.target().join("sheet.png")];
    Ok(())
}

fn sheet(recording: &Recording<'_>, rows: &[Row], thumbnails: &Thumbnails) -> Sheet {
    let ends = (recording.time_s.first().copied().unwrap_or(0.0), recording.time_s.last().copied().unwrap_or(0.0));
    let press = rows.iter().find(|row| row.press == 1).and_then(|row| row.span_s());
    let (from_s, to_s) = press.map_or(ends, |(from, to)| ((from - 0.5).max(ends.0), (to + 2.0).min(ends.1)));
    let what =
        if press.is_some() { "The nail in its own frame through the first press" } else { "The nail in its own frame" };
    let tiles = thumbnails.between(from_s, to_s).into_iter().map(|(time_s, picture)| Tile {
        caption: format!("{time_s:.2} s"),
        picture: TilePicture::Colour(picture.clone()),
        png: None,
    });
    Sheet { title: what.to_owned(), tiles: tiles.collect(), columns: 5, scale: None }
}

/// The traces in two charts: toward the tip and toward the root, by their names' order.
fn charts(recording: &Recording<'_>, rows: &[Row], unit: &str) -> Vec<Chart> {
    let mut all = Thinned::default();
    for (k, &time_s) in recording.time_s.iter().enumerate() {
        let value = |values: &[f64]| Some(values[k]).filter(|v| v.is_finite()).map(|v| [v, f64::NAN]);
        all.push(time_s, recording.traces.iter().map(|trace| value(&trace.values)));
    }
    let lost: Vec<[f64; 2]> = all.lacking();
    // An event's onset in the median of the photodiodes; where it is refused in all, when it was found.
    let begins = |of: &Row, event: Event, found_s: f64| {
        let own = rows.iter().filter(|row| row.press == of.press && row.event == event);
        median_of(own.filter_map(|row| row.times_s()[0].map(|[onset_s, ..]| onset_s))).unwrap_or(found_s)
    };
    let pressed: Vec<[f64; 2]> = (1..)
        .map_while(|press| rows.iter().find(|row| row.press == press))
        .filter_map(|row| row.span_s().map(|found| (row, found)))
        .map(|(row, (from, to))| [begins(row, Event::Press, from), begins(row, Event::Release, to)])
        .collect();
    let half = recording.traces.len().div_ceil(2);
    let count = recording.traces.len();
    let chart = |from: usize, to: usize, first: bool| {
        let lost_name = Some("a photodiode is missing".to_owned()).filter(|_| first && !lost.is_empty());
        let mut items = vec![Item::Spans { name: lost_name, spans: lost.clone() }];
        for k in from..to {
            let (name, runs) = (Some(recording.traces[k].name.clone()), all.curve(k));
            items.push(Item::Line { name, runs, colour: k - from, width: 1 });
        }
        for &[begin, end] in &pressed {
            let values = recording.traces[from..to].iter().flat_map(|trace| trace.values.iter().copied());
            let (low, high) =
                values.filter(|v| v.is_finite()).fold((f64::MAX, f64::MIN), |e, v| (e.0.min(v), e.1.max(v)));
            for at in [begin, end] {
                items.push(Item::Line { name: None, runs: vec![vec![[at, low], [at, high]]], colour: 5, width: 1 });
            }
        }
        let title = if first { "Virtual photodiodes over time (upright lines: a press or release begins)" } else { "" };
        Chart::new(title, if first && half < count { "" } else { "time, s" }, unit, items, 420)
    };
    let mut charts = vec![chart(0, half, true)];
    if half < count {
        charts.push(chart(half, count, false));
    }
    charts
}

fn page(report: &NailVideoReport, rows: &[Row], sheet: &[u8], traces: &[u8]) -> String {
    let mut page = Page::new("A nail followed through a video");
    let frames = &report.frames;
    page.paragraph(&format!(
        "The nail is followed in {} of {} frames; its place has a standard error of {} px (median). Values: {}.",
        frames.followed,
        frames.all,
        report.se_px.map_or("-".to_owned(), |se| format!("{se:.2}")),
        report.unit
    ));
    page.list(&report.warnings);
    page.figure(traces, "1", "The virtual photodiodes over time; grey where one is missing.");
    page.figure(sheet, "2", "Registered frames, distal end up: what does not move is the nail.");
    page.heading("Presses and releases");
    page.paragraph(&format!("{USE}. Times are from the onset; brackets hold 95 % intervals."));
    let cell = |time: Option<[f64; 3]>| {
        time.map_or("-".to_owned(), |[value, low, high]| format!("{value:.3} [{low:.3}, {high:.3}]"))
    };
    let table: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            let mut cells = vec![row.press.to_string(), row.event.name().to_owned(), row.place.clone()];
            cells.extend(row.times_s().map(cell));
            cells.push(row.depth().map_or("-".to_owned(), |depth| format!("{depth:.2}")));
            cells.push(row.status());
            cells
        })
        .collect();
    let header = ["press", "event", "place", "onset, s", "t50, s", "t90, s", "tau, s", "depth", "status"];
    page.table(&header, &table, |at| rows[at].is_refused());
    page.finish()
}
