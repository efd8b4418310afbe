//! Predicted and measured over time, a panel a target, recordings one after the other (Fig. 94, 96, 99, 101, 103).

use std::ops::Range;
use std::path::Path;

use super::{Predicted, quantity, three_digits, unit};
use crate::figure::{Chart, Item, MOST_BINS, Thinned};
use crate::median::{ends, median_of};

/// Height of a panel, pixels.
const PANEL_PX: u32 = 300;
/// A time step of so many usual ones is a gap.
const GAP: f64 = 10.0;
/// Room between two recordings, of all of them together.
const BETWEEN: f64 = 0.01;
/// The least share of the width at which a recording's name is written; about so many letters fit on the whole width.
const NAMED: f64 = 0.08;
const LETTERS: f64 = 170.0;

/// Predicted and measured over time, with prediction intervals where they are given; a chart per target.
pub(in crate::predictor) fn over_time(all: &Predicted<'_>, title: &str) -> Vec<Chart> {
    let line = TimeLine::of(all);
    (0..all.targets.len()).map(|target| panel(all, &line, target, title)).collect()
}

fn panel(all: &Predicted<'_>, line: &TimeLine, target: usize, title: &str) -> Chart {
    let (first, last) = (target == 0, target + 1 == all.targets.len());
    let name = |words: String| Some(words).filter(|_| first);
    let mut items = vec![Item::Spans { name: None, spans: line.every_second() }];
    let mut measured = Vec::new();
    let mut predicted = Vec::new();
    let mut bands = Vec::new();
    for piece in &line.pieces {
        let most = (MOST_BINS * piece.len()).div_ceil(line.rows.max(1)).max(16);
        let (mut curves, mut band) = (Thinned::of_at_most(most), Thinned::of_at_most(most / 2));
        for row in piece.clone() {
            let known = |value: f64| value.is_finite().then_some([value, f64::NAN]);
            let truth = all.measured.and_then(|measured| known(measured[[row, target]]));
            curves.push(line.at[row], [truth, known(all.predicted[[row, target]])].into_iter());
            if let Some(([low, high], _)) = all.interval {
                let (low, high) = (low[[row, target]], high[[row, target]]);
                let middle = 0.5 * low + 0.5 * high;
                band.push(line.at[row], std::iter::once(known(middle).map(|_| [middle, high - middle])));
            }
        }
        if all.measured.is_some() {
            measured.extend(curves.curve(0));
        }
        predicted.extend(curves.curve(1));
        if all.interval.is_some() {
            bands.extend(band.band(0));
        }
    }
    items.push(Item::Band { runs: bands, colour: 1 });
    let words = match all.interval {
        Some((_, coverage)) => format!(
            "predicted, with the interval for {} % of the rows",
            three_digits(100.0 * coverage).trim_end_matches(".0")
        ),
        None => "predicted".to_owned(),
    };
    items.push(Item::Line { name: name(words), runs: predicted, colour: 1, width: 1 });
    // On top: predictions mostly are the rougher.
    if all.measured.is_some() {
        items.push(Item::Line { name: name("measured".to_owned()), runs: measured, colour: 0, width: 1 });
    }
    if first {
        items.extend(line.names(all, &items));
    }
    let column = &all.targets[target];
    let rmse = all.rmse(target).map(|(rmse, _)| format!("RMSE {}{}", three_digits(rmse), unit(column)));
    let parts = [
        Some(title.to_owned()).filter(|t| first && !t.is_empty()),
        Some(quantity(column).split(',').next().unwrap_or_default().to_owned()),
    ];
    let head = parts.into_iter().flatten().collect::<Vec<_>>().join(": ");
    Chart::new(
        rmse.map_or(head.clone(), |rmse| format!("{head}, {rmse}")),
        if last { line.label.as_str() } else { "" },
        quantity(column),
        items,
        PANEL_PX + if first { 40 } else { 0 } + if last { 20 } else { 0 },
    )
}

/// Where each row stands on the horizontal axis.
struct TimeLine {
    label: String,
    rows: usize,
    /// The place of each row.
    at: Vec<f64>,
    /// Rows without a gap between them.
    pieces: Vec<Range<usize>>,
    /// From and to of each recording.
    spans: Vec<[f64; 2]>,
}

impl TimeLine {
    fn of(all: &Predicted<'_>) -> Self {
        let rows = all.time_s.len();
        let timed = all.time_s.iter().all(|t| t.is_finite())
            && all.recordings.iter().all(|one| all.time_s[one.rows.clone()].is_sorted());
        let place = |row: usize| if timed { all.time_s[row] } else { row as f64 };
        let length = |one: &Range<usize>| if one.is_empty() { 0.0 } else { place(one.end - 1) - place(one.start) };
        let several = all.recordings.len() > 1;
        let total: f64 = all.recordings.iter().map(|one| length(&one.rows)).sum();
        let between = if total > 0.0 { BETWEEN * total } else { 1.0 };
        let mut line = Self {
            label: match (timed, several) {
                (true, true) => "time, s; recordings one after the other".to_owned(),
                (true, false) => "time, s".to_owned(),
                (false, _) => "row (times are not known)".to_owned(),
            },
            rows,
            at: vec![f64::NAN; rows],
            pieces: Vec::new(),
            spans: Vec::new(),
        };
        let mut next = 0.0;
        for one in &all.recordings.iter().map(|one| one.rows.clone()).filter(|one| !one.is_empty()).collect::<Vec<_>>()
        {
            let offset = if several && timed { next - place(one.start) } else { 0.0 };
            one.clone().for_each(|row| line.at[row] = place(row) + offset);
            line.spans.push([line.at[one.start], line.at[one.end - 1]]);
            next = line.at[one.end - 1] + between;
            line.cut(one.clone());
        }
        line
    }

    /// Cuts a recording where time leaps.
    fn cut(&mut self, one: Range<usize>) {
        let usual = median_of(self.at[one.clone()].windows(2).map(|pair| pair[1] - pair[0])).unwrap_or(0.0);
        let mut start = one.start;
        for row in one.start + 1..one.end {
            if usual > 0.0 && self.at[row] - self.at[row - 1] > GAP * usual {
                self.pieces.push(start..row);
                start = row;
            }
        }
        self.pieces.push(start..one.end);
    }

    /// Every second recording, to be shaded.
    fn every_second(&self) -> Vec<[f64; 2]> {
        self.spans.iter().copied().skip(1).step_by(2).collect()
    }

    /// Names of the recordings above all that is drawn, where there is room for them.
    fn names(&self, all: &Predicted<'_>, drawn: &[Item]) -> Vec<Item> {
        let used = all.recordings.iter().filter(|one| !one.rows.is_empty());
        let width = self.spans.last().map_or(0.0, |last| last[1] - self.spans[0][0]);
        if self.spans.len() < 2 || width <= 0.0 {
            return Vec::new();
        }
        let values = drawn.iter().flat_map(|item| match item {
            Item::Line { runs, .. } => runs.concat().iter().map(|p| p[1]).collect(),
            Item::Band { runs, .. } => runs.concat().iter().map(|p| p[2]).collect(),
            _ => Vec::new(),
        });
        let [low, high] = ends(values);
        if low.is_infinite() {
            return Vec::new();
        }
        let y = high + 0.12 * (high - low);
        let named = used.zip(&self.spans).filter(|(_, span)| span[1] - span[0] >= NAMED * width);
        named
            .map(|(one, span)| {
                let name = short(&one.name, (LETTERS * (span[1] - span[0]) / width) as usize);
                Item::Text { at: [span[0], y], text: name, colour: 0 }
            })
            .collect()
    }
}

/// The end of a name that is too long: files of one folder begin alike.
fn short(name: &str, most: usize) -> String {
    let name = Path::new(name).file_name().map_or(name.into(), |file| file.to_string_lossy()).into_owned();
    let count = name.chars().count();
    if count <= most {
        return name;
    }
    let kept: String = name.chars().skip(count - most.saturating_sub(1)).collect();
    format!("\u{2026}{kept}")
}
