//! What is ink in a crop, and which pieces it is made of.
//!
//! In: a grey picture. Out: a threshold between its two kinds of grey (N. Otsu 1979, doi:10.1109/TSMC.1979.4310076),
//! and the connected pieces (8 neighbours) on one side of it. Pieces that touch the crop's border (a screen's frame,
//! the desk) or stand around others are no characters and are left out.
//!
//! The split is our own: OpenCV's Otsu splits at the same value, in 4 against 12 µs for 9600 of them, but gives no
//! means (`cargo test --lib opencv_splits -- --nocapture`).

use super::crop::Gray;
use crate::vision::{Neighbours, Part, parts};

/// The threshold between two kinds of grey and the mean of each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::clock) struct Split {
    pub(in crate::clock) threshold: f32,
    pub(in crate::clock) dark: f32,
    pub(in crate::clock) light: f32,
}

/// Splits grey values where the variance between the two sides is greatest; none where all are alike.
pub(in crate::clock) fn split(values: &[f32]) -> Option<Split> {
    let mut counts = [0u32; 256];
    for &value in values {
        counts[(value + 0.5) as usize & 255] += 1;
    }
    let total = values.len() as f64;
    let all: f64 = counts.iter().zip(0u32..).map(|(&n, v)| f64::from(n) * f64::from(v)).sum();
    let (mut below, mut sum) = (0.0, 0.0);
    let mut best: Option<(f64, Split)> = None;
    for (value, &count) in counts.iter().enumerate() {
        below += f64::from(count);
        sum += f64::from(count) * value as f64;
        if count == 0 || below >= total {
            continue;
        }
        let (dark, light) = (sum / below, (all - sum) / (total - below));
        let between = below * (total - below) * (light - dark).powi(2);
        if best.is_none_or(|(most, _)| between > most) {
            // In the middle of the two means' gap: edges are half ink.
            let threshold = 0.5 * (dark + light) as f32;
            best = Some((between, Split { threshold, dark: dark as f32, light: light as f32 }));
        }
    }
    best.map(|(_, split)| split).filter(|split| split.light - split.dark >= LEAST_CONTRAST)
}

/// Digits and background differ by at least so many levels of 255.
const LEAST_CONTRAST: f32 = 12.0;

/// So many pieces inside of another make it a frame.
const FRAMED: usize = 3;

/// A connected piece: its first and last column and row, and how many pixels it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::clock) struct Piece {
    pub(in crate::clock) left: usize,
    pub(in crate::clock) top: usize,
    pub(in crate::clock) right: usize,
    pub(in crate::clock) bottom: usize,
    pub(in crate::clock) area: usize,
}

impl Piece {
    pub(in crate::clock) fn width(&self) -> usize {
        self.right - self.left + 1
    }

    pub(in crate::clock) fn height(&self) -> usize {
        self.bottom - self.top + 1
    }

    /// Whether another piece's box is within this one's.
    pub(in crate::clock) fn holds(&self, other: &Self) -> bool {
        self != other
            && self.left <= other.left
            && self.top <= other.top
            && self.right >= other.right
            && self.bottom >= other.bottom
    }
}

/// The pieces of what is lighter (or darker) than the threshold, those left out that can be no characters.
pub(in crate::clock) fn pieces(gray: &Gray, threshold: f32, light: bool) -> Vec<Piece> {
    let (width, height) = (gray.width, gray.height);
    let mut found = all_pieces(gray, threshold, light);
    found.retain(|piece| piece.left > 0 && piece.top > 0 && piece.right + 1 < width && piece.bottom + 1 < height);
    // What stands around several others is a frame; a 0 may hold a dot.
    let around = |piece: &Piece| found.iter().filter(|other| piece.holds(other)).count() >= FRAMED;
    found.iter().filter(|piece| !around(piece)).copied().collect()
}

/// All pieces of what is lighter (or darker) than the threshold.
pub(in crate::clock) fn all_pieces(gray: &Gray, threshold: f32, light: bool) -> Vec<Piece> {
    let ink: Vec<u8> = gray.values.iter().map(|&value| u8::from((value > threshold) == light)).collect();
    let found = parts(&ink, [gray.width, gray.height], Neighbours::Eight).all;
    found.iter().map(|&Part { left, top, right, bottom, area, .. }| Piece { left, top, right, bottom, area }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(rows: &[&str]) -> Gray {
        let values = rows.iter().flat_map(|row| row.bytes().map(|b| if b == b'#' { 200.0 } else { 40.0 })).collect();
        Gray { width: rows[0].len(), height: rows.len(), values }
    }

    #[test]
    fn the_split_lies_between_the_two_kinds() {
        let picture = gray(&["....", ".##.", "...."]);
        let found = split(&picture.values).unwrap();
        assert_eq!(found, Split { threshold: 120.0, dark: 40.0, light: 200.0 });
        assert_eq!(split(&[7.0; 50]), None);
        assert_eq!(split(&[]), None);
    }

    /// Prints how long OpenCV takes to split values, and ours, which gives the means of both sides too.
    #[test]
    fn opencv_splits_at_the_same_value() {
        let bytes: Vec<u8> = (0..9600_u32).map(|k| (if k % 9 < 3 { 170 } else { 40 } + k * 37 % 61) as u8).collect();
        let values: Vec<f32> = bytes.iter().copied().map(f32::from).collect();
        let found = split(&values).unwrap();
        let at = f32::from(crate::vision::otsu_level(&bytes));
        let mean = |light: bool| {
            let side: Vec<f32> = values.iter().copied().filter(|&value| (value > at) == light).collect();
            side.iter().sum::<f32>() / side.len() as f32
        };
        assert!((mean(false) - found.dark).abs().max((mean(true) - found.light).abs()) <= 0.01, "{at} {found:?}");
        let time = |work: &dyn Fn()| {
            let start = std::time::Instant::now();
            (0..200).for_each(|_| work());
            start.elapsed() / 200
        };
        let own = time(&|| assert_eq!(split(&values), Some(found)));
        let opencv = time(&|| assert_eq!(f32::from(crate::vision::otsu_level(&bytes)), at));
        println!("9600 values split: own {own:?}, OpenCV {opencv:?} without the means");
    }

    #[test]
    fn pieces_inside_are_found_and_frames_left_out() {
        let picture = gray(&[
            "#.............",
            "..#########...",
            "..#.......#...",
            "..#.#.#.#.#...",
            "..#.#.....#...",
            "..#.......#...",
            "..#########...",
            "............##",
            "..............",
        ]);
        let found = pieces(&picture, 120.0, true);
        let expected = [
            Piece { left: 4, top: 3, right: 4, bottom: 4, area: 2 },
            Piece { left: 6, top: 3, right: 6, bottom: 3, area: 1 },
            Piece { left: 8, top: 3, right: 8, bottom: 3, area: 1 },
        ];
        assert_eq!(found, expected);
    }
}
