//! Finds the clock where the user did not say where it is.
//!
//! In: the whole pictures of about a second, averaged down to a million pixels at most. Out: the clock's rectangle and
//! what was learnt of it. A clock changes in places of a glyph's size. So: small blocks in which edges come and go from
//! one picture to the next (edges, since a light that flickers changes smooth places alike); connected blocks that are
//! no larger than a line of digits; around each of them a stretch of the line, out of which the clock is learnt as if
//! the user had named it ([`crate::clock::read::learn`]). It is the clock if it then reads, changes, and runs one
//! second a second.

use super::follow::Follower;
use super::learn::Model;
use crate::clock::beside::Misfit;
use crate::clock::format::ClockFormat;
use crate::clock::ink::crop::{Eye, Gray, Rect};
use crate::clock::{Doubt, ReaderEffort, Reading};
use crate::video::Frame;
use crate::vision::{Neighbours, Part, Parts, parts};

/// A picture, averaged down.
#[derive(Debug)]
struct Kept {
    index: u64,
    time_s: f64,
    luma: Vec<u8>,
}

/// Collects pictures and looks for the clock in them.
#[derive(Debug)]
pub(super) struct Scout {
    step: usize,
    width: usize,
    height: usize,
    kept: Vec<Kept>,
}

/// A clock that was found.
#[derive(Debug)]
pub(super) struct Sighting {
    /// Where its crops are to be cut, in blocks of `step` pixels.
    pub(super) rect: Rect,
    pub(super) step: usize,
    pub(super) follower: Follower,
    /// What the clock shows that the format does not have; it is not read then.
    pub(super) misfit: Option<Misfit>,
    /// The readings of the pictures by their indices.
    pub(super) readings: Vec<(u64, Reading)>,
}

/// Pictures have no more pixels than this, and all of them together.
const MOST_PIXELS: usize = 1 << 20;
const MOST_KEPT: usize = 72 << 20;
/// So many of them are compared, each with the next.
const COMPARED: usize = 18;
/// The side of a block.
const BLOCK: usize = 4;
/// So many pixels of a block's 16 have to change.
const CHANGED: u8 = 3;
/// An edge's change is one beyond so many times the usual one, and these levels.
const BEYOND_NOISE: u32 = 6;
const LEAST_CHANGE: u32 = 20;
/// The tallest line of digits, as a share of the picture's height.
const TALLEST: usize = 3;
/// How many heights AM or PM take with a blank.
const HALF: f64 = 3.0;
/// So many places are looked at.
const MOST_PLACES: usize = 16;
/// A clock that is found reads in this share of the pictures.
const READ: f64 = 0.3;

impl Scout {
    pub(super) fn new(eye: &Eye) -> Self {
        let (width, height) = eye.size();
        let mut step = 1;
        while (width / step) * (height / step) > MOST_PIXELS {
            step += 1;
        }
        Self { step, width: width / step, height: height / step, kept: Vec::new() }
    }

    /// Keeps a frame's picture.
    pub(super) fn keep(&mut self, eye: &Eye, frame: &Frame<'_>) {
        let rect = Rect { x: 0, y: 0, width: self.width * self.step, height: self.height * self.step };
        let gray = eye.cut(&frame.luma, rect, self.step);
        let luma = gray.values.iter().map(|&value| (value + 0.5) as u8).collect();
        self.kept.push(Kept { index: frame.index, time_s: frame.time_s, luma });
    }

    /// From the first picture kept to the last, and how many there are.
    pub(super) fn span(&self) -> (f64, usize) {
        let span_s = self.kept.first().zip(self.kept.last()).map_or(0.0, |(a, b)| b.time_s - a.time_s);
        (span_s, self.kept.len())
    }

    /// Whether no more pictures can be kept.
    pub(super) fn is_full(&self) -> bool {
        (self.kept.len() + 1) * self.width * self.height > MOST_KEPT
    }

    /// The clock in the pictures kept.
    pub(super) fn search(&self, format: &ClockFormat, effort: &mut ReaderEffort) -> Option<Sighting> {
        effort.searched += self.kept.len() as u64;
        let mut other = None;
        for place in self.places(format).into_iter().take(MOST_PLACES) {
            // Where a few strokes changed only, the digits are taller than the place.
            for taller in [1.0, 2.0] {
                match self.look(self.stretch(place, taller, format), format, effort) {
                    Some(sighting) if sighting.misfit.is_none() => return Some(sighting),
                    Some(sighting) => other = other.or(Some(sighting)),
                    None => {}
                }
            }
        }
        other
    }

    /// Learns a clock in a rectangle and reads it.
    fn look(&self, rect: Rect, format: &ClockFormat, effort: &mut ReaderEffort) -> Option<Sighting> {
        let crops: Vec<Gray> = self.kept.iter().map(|kept| self.crop(kept, rect)).collect();
        let times_s: Vec<f64> = self.kept.iter().map(|kept| kept.time_s).collect();
        let learnt = Model::learn(&crops, &times_s, format);
        let mut follower = Follower::new(learnt.model?, format);
        follower.regardless = learnt.misfit.is_some();
        let mut readings: Vec<Reading> = crops.iter().map(|crop| follower.read(crop, effort)).collect();
        if !runs(&times_s, &readings, format.resolution_s()) {
            return None;
        }
        if std::mem::take(&mut follower.regardless) {
            follower.misfit = true;
            readings.fill(Reading::Abstained(Doubt::OtherFormat));
        }
        let readings = self.kept.iter().map(|kept| kept.index).zip(readings).collect();
        Some(Sighting { rect, step: self.step, follower, misfit: learnt.misfit, readings })
    }

    fn crop(&self, kept: &Kept, rect: Rect) -> Gray {
        let rows = kept.luma.chunks_exact(self.width).skip(rect.y).take(rect.height);
        let values = rows.flat_map(|row| row[rect.x..rect.x + rect.width].iter().map(|&v| f32::from(v))).collect();
        Gray { width: rect.width, height: rect.height, values }
    }

    /// The stretch of a line in which the format's other characters stand.
    fn stretch(&self, place: Rect, taller: f64, format: &ClockFormat) -> Rect {
        let tall = taller * place.height as f64;
        let characters = format.cells().len() as f64;
        // Whatever the format has: AM or PM that it does not have are to be seen.
        let left = (place.x as f64 - (characters + HALF + 0.5) * tall).max(0.0) as usize;
        let right = ((place.x + place.width) as f64 + (1.5 + HALF) * tall).min(self.width as f64) as usize;
        let middle = place.y as f64 + 0.5 * place.height as f64;
        let top = (middle - tall).max(0.0) as usize;
        let bottom = (middle + tall).min(self.height as f64) as usize;
        Rect { x: left, y: top, width: right - left, height: bottom - top }
    }

    /// Places of a glyph's size that change, the most often changing first.
    fn places(&self, format: &ClockFormat) -> Vec<Rect> {
        let (columns, rows) = (self.width / BLOCK, self.height / BLOCK);
        let mut counts = vec![0u16; columns * rows];
        let stride = self.kept.len().div_ceil(COMPARED);
        for pair in self.kept.chunks(stride.max(1)).collect::<Vec<_>>().windows(2) {
            let pair = [&pair[0][0], &pair[1][0]];
            let least = LEAST_CHANGE.max(BEYOND_NOISE * self.usual_change(&pair[0].luma, &pair[1].luma));
            let mut changed = vec![0u8; columns * rows];
            for y in 0..rows * BLOCK {
                let range = y * self.width..(y + 1) * self.width;
                let (before, after) = (&pair[0].luma[range.clone()], &pair[1].luma[range]);
                let into = &mut changed[y / BLOCK * columns..(y / BLOCK + 1) * columns];
                for x in 1..columns * BLOCK - 1 {
                    into[x / BLOCK] += u8::from(edge_change(before, after, x) > least);
                }
            }
            counts.iter_mut().zip(&changed).for_each(|(count, &changed)| *count += u16::from(changed >= CHANGED));
        }
        let longest = 2.0 * format.cells().len() as f64;
        let mut places: Vec<(u64, Rect)> = connected(&counts, columns)
            .into_iter()
            .filter(|(_, rect)| {
                let (wide, tall) = (rect.width as f64, rect.height as f64);
                rect.height * BLOCK >= 6
                    && rect.height * BLOCK * TALLEST <= self.height
                    && wide <= longest * tall
                    && wide >= 0.1 * tall
            })
            .map(|(count, rect)| (count * 64 / (rect.width * rect.height) as u64, rect))
            .collect();
        places.sort_by_key(|(count, rect)| (std::cmp::Reverse(*count), rect.y, rect.x));
        let scaled = |rect: Rect| Rect {
            x: rect.x * BLOCK,
            y: rect.y * BLOCK,
            width: rect.width * BLOCK,
            height: rect.height * BLOCK,
        };
        places.into_iter().map(|(_, rect)| scaled(rect)).collect()
    }

    /// The median change of an edge, on a part of the pixels.
    fn usual_change(&self, before: &[u8], after: &[u8]) -> u32 {
        let mut counts = [0u32; 512];
        let mut all = 0;
        for y in (0..self.height).step_by(7) {
            let range = y * self.width..(y + 1) * self.width;
            let (before, after) = (&before[range.clone()], &after[range]);
            for x in (1..self.width.saturating_sub(1)).step_by(5) {
                counts[(edge_change(before, after, x) as usize).min(511)] += 1;
                all += 1;
            }
        }
        let mut below = 0;
        let median = counts.iter().position(|count| {
            below += count;
            2 * below >= all
        });
        median.unwrap_or(0) as u32
    }
}

/// How much the horizontal edge at a pixel changes.
fn edge_change(before: &[u8], after: &[u8], x: usize) -> u32 {
    let edge = |row: &[u8]| i32::from(row[x + 1]) - i32::from(row[x - 1]);
    (edge(after) - edge(before)).unsigned_abs()
}

/// Blocks with a count that are at most one block apart: the sum of their counts, and the rectangle around them.
fn connected(counts: &[u16], columns: usize) -> Vec<(u64, Rect)> {
    // Where every block is twice as wide and as high, those a block apart touch.
    let (wide, rows) = (columns + 1, counts.len() / columns.max(1));
    let mut set = vec![0; wide * (rows + 1)];
    for (k, _) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let at = k / columns * wide + k % columns;
        [at, at + 1, at + wide, at + wide + 1].into_iter().for_each(|at| set[at] = 1);
    }
    let Parts { all, labels } = parts(&set, [wide, rows + 1], Neighbours::Eight);
    let mut sums = vec![0; all.len()];
    for (k, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        sums[labels[k / columns * wide + k % columns] as usize - 1] += u64::from(count);
    }
    let rect =
        |part: &Part| Rect { x: part.left, y: part.top, width: part.right - part.left, height: part.bottom - part.top };
    sums.into_iter().zip(all.iter().map(rect)).collect()
}

/// Whether readings are those of a clock that runs.
fn runs(times_s: &[f64], readings: &[Reading], resolution_s: f64) -> bool {
    let read: Vec<(f64, f64)> = times_s
        .iter()
        .zip(readings)
        .filter_map(|(&time_s, reading)| match reading {
            Reading::Read { shown_s, .. } => Some((time_s, *shown_s)),
            Reading::Abstained(_) => None,
        })
        .collect();
    let Some((first, last)) = read.first().zip(read.last()) else { return false };
    let interval_s = (times_s[times_s.len() - 1] - times_s[0]) / (times_s.len() - 1).max(1) as f64;
    let slack_s = resolution_s + 2.0 * interval_s;
    let ahead = |&(time_s, shown_s): &(f64, f64)| (shown_s - first.1) - (time_s - first.0);
    read.len() as f64 >= READ * readings.len() as f64
        && last.1 > first.1
        && read.iter().all(|one| ahead(one).abs() <= slack_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::Doubt;

    fn reads(shown: &[Option<f64>]) -> Vec<Reading> {
        let of = |shown: &Option<f64>| {
            shown.map_or(Reading::Abstained(Doubt::Unclear), |shown_s| Reading::Read { shown_s, confidence: 0.99 })
        };
        shown.iter().map(of).collect()
    }

    #[test]
    fn only_what_counts_a_second_a_second_runs() {
        let times: Vec<f64> = (0..10).map(|k| 0.1 * f64::from(k)).collect();
        let count = |rate: f64| (0..10).map(|k| Some(50.0 + rate * 0.1 * f64::from(k))).collect::<Vec<_>>();
        assert!(runs(&times, &reads(&count(1.0)), 0.1));
        assert!(!runs(&times, &reads(&count(0.0)), 0.1));
        assert!(!runs(&times, &reads(&count(2.0)), 0.1));
        assert!(!runs(&times, &reads(&count(-1.0)), 0.1));
        assert!(!runs(&times, &reads(&[None; 10]), 0.1));
        let mut few = vec![None; 10];
        (few[0], few[9]) = (Some(50.0), Some(50.9));
        assert!(!runs(&times, &reads(&few), 0.1));
    }

    #[test]
    fn blocks_a_block_apart_belong_together() {
        let mut counts = vec![0; 60];
        for (x, y) in [(1, 1), (3, 1), (3, 3), (8, 5)] {
            counts[y * 10 + x] = 2;
        }
        let found = connected(&counts, 10);
        let rect = |x, y, width, height| Rect { x, y, width, height };
        assert_eq!(found, [(6, rect(1, 1, 3, 3)), (2, rect(8, 5, 1, 1))]);
        assert!(connected(&[], 0).is_empty());
    }
}
