//! Lines of characters in a crop, and the format's characters in a line.
//!
//! In: the connected pieces of ink. Out: [`Line`]s of [`Run`]s, pieces that share columns, which are characters where
//! glyphs don't touch; and of those the ones that can be the characters of a format, in order.

use super::pieces::Piece;
use crate::clock::format::{Cell, ClockFormat};
use crate::median::median_of;

/// Pieces of one line that share columns: as a rule one character.
pub(in crate::clock) type Run = Piece;

/// Pieces at the same height, from the left to the right.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::clock) struct Line {
    pub(in crate::clock) runs: Vec<Run>,
}

/// Pieces of so few pixels are noise.
pub(in crate::clock) const SPECK: usize = 2;
/// Rows without ink between two pieces of a line, as a share of the higher of them: between the segments of a digit.
const BRIDGE: f64 = 0.3;
/// Lower lines hold no legible digits.
const LEAST_HEIGHT: usize = 7;

fn merged(a: &Piece, b: &Piece) -> Piece {
    Piece {
        left: a.left.min(b.left),
        top: a.top.min(b.top),
        right: a.right.max(b.right),
        bottom: a.bottom.max(b.bottom),
        area: a.area + b.area,
    }
}

pub(in crate::clock) fn lines(pieces: &[Piece]) -> Vec<Line> {
    let mut pieces: Vec<Piece> = pieces.iter().filter(|piece| piece.area > SPECK).copied().collect();
    pieces.sort_by_key(|piece| (piece.top, piece.left));
    let mut bands: Vec<(Piece, Vec<Piece>)> = Vec::new();
    for piece in pieces {
        let near = |band: &Piece| {
            let high = band.height().max(piece.height());
            piece.top as f64 <= band.bottom as f64 + 1.0 + BRIDGE * high as f64
        };
        match bands.last_mut() {
            Some((band, held)) if near(band) => {
                *band = merged(band, &piece);
                held.push(piece);
            }
            _ => bands.push((piece, vec![piece])),
        }
    }
    bands
        .into_iter()
        .filter(|(band, _)| band.height() >= LEAST_HEIGHT)
        .map(|(_, held)| Line { runs: runs(held) })
        .collect()
}

/// Pieces that share columns, merged, from the left to the right.
pub(in crate::clock) fn runs(mut pieces: Vec<Piece>) -> Vec<Run> {
    pieces.sort_by_key(|piece| (piece.left, piece.top));
    let mut runs: Vec<Run> = Vec::new();
    for piece in pieces {
        match runs.last_mut() {
            Some(run) if piece.left <= run.right => *run = merged(run, &piece),
            _ => runs.push(piece),
        }
    }
    runs
}

/// The digits of a format in a line: one run for each digit.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::clock) struct Row {
    pub(in crate::clock) digits: Vec<Run>,
    /// First and last row of the digits.
    pub(in crate::clock) top: usize,
    pub(in crate::clock) bottom: usize,
}

impl Row {
    pub(in crate::clock) fn height(&self) -> usize {
        self.bottom - self.top + 1
    }
}

/// Digits end within this share of their height from one another's tops and bottoms.
pub(in crate::clock) const UNEVEN: f64 = 0.16;
/// The widest digit and the widest gap between characters, in heights of a digit.
pub(in crate::clock) const WIDEST: f64 = 1.1;
const WIDEST_GAP: f64 = 1.0;

/// Everywhere that the format's characters may stand in a line.
pub(in crate::clock) fn rows(line: &Line, format: &ClockFormat) -> Vec<Row> {
    // AM and PM are looked for beside the digits.
    let unseen = |cell: &&Cell| !matches!(cell, Cell::Half) && !matches!(cell, Cell::Mark(c) if c.is_whitespace());
    let cells: Vec<Cell> = format.cells().iter().filter(unseen).copied().collect();
    // The strokes of a double quote stand side by side.
    let takes = |cell: &Cell| if matches!(cell, Cell::Mark('"')) { 2 } else { 1 };
    let wanted: usize = cells.iter().map(takes).sum();
    let mut rows = Vec::new();
    for start in 0..(line.runs.len() + 1).saturating_sub(wanted) {
        let window = &line.runs[start..start + wanted];
        let mut at = 0;
        let mut digits = Vec::new();
        let mut marks = Vec::new();
        for cell in &cells {
            match cell {
                Cell::Digit { .. } => digits.push(window[at]),
                Cell::Mark(mark) => marks.push((*mark, window[at])),
                Cell::Half => {}
            }
            at += takes(cell);
        }
        let top = median_of(digits.iter().map(|run| run.top)).unwrap_or(0);
        let bottom = median_of(digits.iter().map(|run| run.bottom)).unwrap_or(0);
        let row = Row { digits, top, bottom };
        if row.is_even() && spaced(window, row.height()) && marks.iter().all(|(mark, run)| row.can_be(*mark, run)) {
            rows.push(row);
        }
    }
    rows
}

fn spaced(runs: &[Run], height: usize) -> bool {
    runs.windows(2).all(|pair| (pair[1].left - pair[0].right) as f64 <= 1.0 + WIDEST_GAP * height as f64)
}

impl Row {
    /// Whether its digits are equally high, and no wider than digits are.
    fn is_even(&self) -> bool {
        if self.bottom < self.top + LEAST_HEIGHT - 1 {
            return false;
        }
        let height = self.height() as f64;
        let slack = (UNEVEN * height).max(1.5);
        self.digits.iter().all(|run| {
            run.top.abs_diff(self.top) as f64 <= slack
                && run.bottom.abs_diff(self.bottom) as f64 <= slack
                && run.width() as f64 <= WIDEST * height
        })
    }

    /// Whether a run between the digits can be this mark.
    fn can_be(&self, mark: char, run: &Run) -> bool {
        let height = self.height() as f64;
        let middle = 0.5 * (self.top + self.bottom) as f64;
        let (top, bottom) = (run.top as f64, run.bottom as f64);
        match mark {
            '.' | ',' => top > middle && bottom - top < 0.5 * height,
            ':' => top < middle && bottom > middle && bottom - top < 0.9 * height,
            '\'' | '"' => bottom < middle + 0.1 * height,
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(left: usize, top: usize, right: usize, bottom: usize) -> Piece {
        Piece { left, top, right, bottom, area: (right - left + 1) * (bottom - top + 1) }
    }

    /// `12:34.5` with digits of 10 x 20 and a 3 in two halves, below it a line of text.
    fn scene() -> Vec<Piece> {
        vec![
            piece(10, 10, 15, 29),
            piece(20, 10, 29, 29),
            piece(33, 14, 35, 16),
            piece(33, 24, 35, 26),
            piece(40, 10, 49, 18),
            piece(41, 22, 49, 29),
            piece(52, 10, 61, 29),
            piece(64, 27, 66, 29),
            piece(70, 11, 79, 30),
            piece(10, 45, 50, 55),
        ]
    }

    #[test]
    fn characters_of_a_line_take_their_places_in_the_format() {
        let lines = lines(&scene());
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[0].runs.len(), 7);
        let format = |text: &str| ClockFormat::parse(text).unwrap();
        let found = rows(&lines[0], &format("mm:ss.t"));
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].digits.iter().map(|run| run.left).collect::<Vec<_>>(), [10, 20, 40, 52, 70]);
        assert_eq!((found[0].top, found[0].bottom), (10, 29));
        // A part of the line fits a shorter format; another order of marks fits nowhere.
        assert_eq!(rows(&lines[0], &format("ss.t")).len(), 1);
        assert!(rows(&lines[0], &format("ss,tt")).is_empty());
        assert!(rows(&lines[0], &format("hh:mm:ss")).is_empty());
        assert!(rows(&lines[1], &format("s")).is_empty());
        assert!(rows(&Line { runs: Vec::new() }, &format("mm:ss")).is_empty());
    }
}
