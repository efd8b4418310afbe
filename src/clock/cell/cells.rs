//! Where each digit of the format stands in a crop.
//!
//! In: rows of characters found in several crops of one video ([`crate::clock::ink::line`]). Out: [`Cells`], a box for
//! each digit that holds it whatever digit it is, or which of a crop's own runs they are. Digits of most typefaces are
//! equally wide, so that a clock's digits stand in place; where a cell showed narrow digits only, the pitch of the
//! others gives where it is: digits follow at one pitch, and each mark takes a width of its own (least squares).

use nalgebra::{DMatrix, DVector};

use super::look::Cut;
use crate::clock::format::{Cell, ClockFormat};
use crate::clock::glyph::Levels;
use crate::clock::ink::crop::Gray;
use crate::clock::ink::line::{Row, Run, lines, rows};
use crate::clock::ink::pieces::pieces;
use crate::median::median_of;

/// The cells of a clock's digits in a crop.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::clock) struct Cells {
    /// One for each digit, equally large.
    still: Vec<Cut>,
    /// Digits are of different widths, so that the others move when one changes: each crop's own runs are the cells.
    pub(in crate::clock) moving: bool,
    /// First and last edge of the digits' rows, samples.
    pub(in crate::clock) line: [f32; 2],
    /// From one digit's middle to the next one's, samples.
    pub(in crate::clock) pitch: f32,
    /// What background and ink are worth.
    pub(in crate::clock) levels: Levels,
}

/// A cell whose ink is narrower than this share of the widest one's showed narrow digits only.
const NARROW: f64 = 0.8;
/// How much such a cell's own middle counts.
const NARROW_WEIGHT: f64 = 0.02;
/// How much is thought of a pitch and of a mark's width before anything is seen.
const PRIOR: f64 = 1e-3;
/// Centres that fit one pitch are this near to it, in widths of a digit.
const OFF_PITCH: f64 = 0.2;
/// Digits follow at no less than so many widths of the widest.
const CLOSEST: f64 = 1.1;
/// Beside the cells so many pitches are looked at for a further character, and so many heights for AM or PM; above and
/// below this share of their height, for frames that are taller than digits and letters that reach further down.
const BESIDE: f32 = 2.0;
const BESIDE_HALF: f32 = 4.5;
const ABOVE_BELOW: f32 = 0.6;
/// How far digits that move go beyond where they were seen, in widths of a digit.
const MOVES: f32 = 1.5;

impl Cells {
    /// The cells that hold the digits of all these rows.
    pub(in crate::clock) fn around(seen: &[&Row], format: &ClockFormat, levels: Levels) -> Option<Self> {
        let first = seen.first()?;
        let count = first.digits.len();
        let top = median_of(seen.iter().map(|row| row.top as f64))?;
        let bottom = median_of(seen.iter().map(|row| row.bottom as f64 + 1.0))?;
        let height = bottom - top;
        let spans: Vec<[f64; 2]> = (0..count)
            .map(|digit| {
                let usual = median_of(seen.iter().map(|row| row.digits[digit].left as f64)).unwrap_or(f64::NAN);
                // Neighbours that touch in a frame are one run there.
                let near = seen
                    .iter()
                    .map(|row| row.digits[digit])
                    .filter(|run| (run.left as f64 - usual).abs() < 0.6 * height);
                near.fold([f64::INFINITY, f64::NEG_INFINITY], |[left, right], run| {
                    [left.min(run.left as f64), right.max(run.right as f64 + 1.0)]
                })
            })
            .collect();
        let widest = spans.iter().map(|[left, right]| right - left).fold(0.0, f64::max);
        let (centres, pitch) = centres(&spans, widest, format);
        // A sample more on each side, where the neighbours leave it.
        let width = (widest + 2.0).min(pitch.max(widest));
        let margin = (0.04 * height).max(0.5);
        let cut = |centre: f64| Cut {
            left: (centre - 0.5 * width) as f32,
            top: (top - margin) as f32,
            width: width as f32,
            height: (height + 2.0 * margin) as f32,
        };
        Some(Self {
            still: centres.into_iter().map(cut).collect(),
            moving: false,
            line: [top as f32, bottom as f32],
            pitch: pitch.max(CLOSEST * widest) as f32,
            levels,
        })
    }

    /// The same, of digits that move.
    pub(in crate::clock) fn moving(self) -> Self {
        Self { moving: true, ..self }
    }

    /// The boxes of the digits in a crop; none where they move and can't be separated.
    pub(in crate::clock) fn boxes(&self, gray: &Gray, format: &ClockFormat) -> Option<Vec<Cut>> {
        if !self.moving {
            return Some(self.still.clone());
        }
        let limit = 0.5 * (self.levels.background + self.levels.ink);
        let pieces = pieces(gray, limit, self.levels.ink > self.levels.background);
        let found: Vec<Row> = lines(&pieces).iter().flat_map(|line| rows(line, format)).collect();
        // Unless exactly one row fits, there is no way to choose.
        let [row] = &found[..] else { return None };
        let top = row.top as f32 - 0.5;
        let height = row.height() as f32 + 1.0;
        let cut =
            |run: &Run| Cut { left: run.left as f32 - 0.5, top, width: (run.right - run.left) as f32 + 2.0, height };
        Some(row.digits.iter().map(cut).collect())
    }

    /// The part of a crop of this width and height that holds the cells and a sample around: left, top, right, bottom.
    pub(in crate::clock) fn bounds(&self, [width, height]: [usize; 2]) -> [usize; 4] {
        let low = |edge: f32| (edge - 1.0).floor().max(0.0) as usize;
        let high = |edge: f32, most: usize| ((edge + 1.0).ceil() as usize).min(most);
        let least = |edge: &dyn Fn(&Cut) -> f32| self.still.iter().map(edge).fold(f32::INFINITY, f32::min);
        let most = |edge: &dyn Fn(&Cut) -> f32| self.still.iter().map(edge).fold(0.0, f32::max);
        let aside = if self.moving { MOVES * most(&|cut| cut.width) } else { 0.0 };
        let (left, top) = (low(least(&|cut| cut.left) - aside), low(least(&|cut| cut.top)));
        let right = high(most(&|cut| cut.left + cut.width) + aside, width);
        let bottom = high(most(&|cut| cut.top + cut.height), height);
        [left, top, right, bottom]
    }

    /// The same with what is looked at beside the cells.
    pub(in crate::clock) fn bounds_beside(&self, size: [usize; 2]) -> [usize; 4] {
        let [left, top, right, bottom] = self.bounds(size);
        let height = self.line[1] - self.line[0];
        let beside = (BESIDE_HALF * height).max(BESIDE * self.pitch).ceil() as usize;
        let aside = (ABOVE_BELOW * height).ceil() as usize;
        [
            left.saturating_sub(beside),
            top.saturating_sub(aside),
            (right + beside).min(size[0]),
            (bottom + aside).min(size[1]),
        ]
    }

    /// The first and the last digit's cells.
    pub(in crate::clock) fn ends(&self) -> Option<[Cut; 2]> {
        Some([*self.still.first()?, *self.still.last()?])
    }

    /// Moves the cells to a crop that begins `left` and `top` samples further on.
    pub(in crate::clock) fn shift(&mut self, left: usize, top: usize) {
        for cut in &mut self.still {
            cut.left -= left as f32;
            cut.top -= top as f32;
        }
        self.line = self.line.map(|edge| edge - top as f32);
    }

    pub(in crate::clock) fn ink(&self, gray: &Gray, cut: Cut) -> Option<Cut> {
        let limit = 0.5 * (self.levels.background + self.levels.ink);
        let light = self.levels.ink > self.levels.background;
        let whole = |edge: f32, samples: usize| (edge.round().max(0.0) as usize).min(samples);
        let (left, right) = (whole(cut.left, gray.width), whole(cut.left + cut.width, gray.width));
        let (top, bottom) = (whole(cut.top, gray.height), whole(cut.top + cut.height, gray.height));
        let inked = |x: usize, y: usize| (gray.row(y)[x] > limit) == light;
        let columns: Vec<bool> = (left..right).map(|x| (top..bottom).any(|y| inked(x, y))).collect();
        let [from, to] = main_span(&columns)?;
        let (from, to) = (left + from, left + to);
        let mut rows = (top..bottom).filter(|&y| (from..=to).any(|x| inked(x, y)));
        let first = rows.next()?;
        let last = rows.next_back().unwrap_or(first);
        Some(Cut {
            left: from as f32,
            top: first as f32,
            width: (to - from + 1) as f32,
            height: (last - first + 1) as f32,
        })
    }
}

/// First and last column of the ink without slivers of a neighbour at the cell's sides.
fn main_span(columns: &[bool]) -> Option<[usize; 2]> {
    let mut groups: Vec<[usize; 2]> = Vec::new();
    for (k, _) in columns.iter().enumerate().filter(|(_, inked)| **inked) {
        match groups.last_mut() {
            Some([_, last]) if *last + 1 == k => *last = k,
            _ => groups.push([k, k]),
        }
    }
    let sliver = |[from, to]: [usize; 2]| (to - from + 1) * 5 <= columns.len();
    if groups.len() > 1 && groups[0][0] == 0 && sliver(groups[0]) {
        groups.remove(0);
    }
    if groups.len() > 1 && groups.last().is_some_and(|&group| group[1] + 1 == columns.len() && sliver(group)) {
        groups.pop();
    }
    Some([groups.first()?[0], groups.last()?[1]])
}

/// The middles of the digits' cells and their pitch.
fn centres(spans: &[[f64; 2]], widest: f64, format: &ClockFormat) -> (Vec<f64>, f64) {
    let own: Vec<f64> = spans.iter().map(|[left, right]| 0.5 * (left + right)).collect();
    let mut marks: Vec<char> = Vec::new();
    for cell in format.cells() {
        if let Cell::Mark(mark) = cell
            && !marks.contains(mark)
        {
            marks.push(*mark);
        }
    }
    // Unknown: where the first digit is, the pitch, each mark's width.
    let unknowns = 2 + marks.len();
    let mut terms: Vec<Vec<f64>> = Vec::new();
    let mut so_far = vec![0.0; unknowns];
    so_far[0] = 1.0;
    for cell in format.cells() {
        match cell {
            Cell::Digit { .. } => {
                terms.push(so_far.clone());
                so_far[1] += 1.0;
            }
            Cell::Mark(mark) => {
                if let Some(k) = marks.iter().position(|known| known == mark) {
                    so_far[2 + k] += 1.0;
                }
            }
            Cell::Half => {}
        }
    }
    let mut normal = DMatrix::zeros(unknowns, unknowns);
    let mut right = DVector::zeros(unknowns);
    let mut add = |terms: &[f64], value: f64, weight: f64| {
        for (i, a) in terms.iter().enumerate() {
            right[i] += weight * a * value;
            for (j, b) in terms.iter().enumerate() {
                normal[(i, j)] += weight * a * b;
            }
        }
    };
    let is_wide = |[left, right]: [f64; 2]| right - left >= NARROW * widest;
    for ((terms, &centre), &span) in terms.iter().zip(&own).zip(spans) {
        add(terms, centre, if is_wide(span) { 1.0 } else { NARROW_WEIGHT });
    }
    for k in 1..unknowns {
        let mut alone = vec![0.0; unknowns];
        alone[k] = 1.0;
        add(&alone, if k == 1 { 1.15 * widest } else { 0.6 * widest }, PRIOR);
    }
    let Some(solved) = normal.cholesky().map(|known| known.solve(&right)) else { return (own, widest) };
    let fitted: Vec<f64> =
        terms.iter().map(|terms| terms.iter().zip(solved.iter()).map(|(a, b)| a * b).sum()).collect();
    let off = |k: usize| (fitted[k] - own[k]).abs();
    let on_pitch = (0..own.len()).all(|k| !is_wide(spans[k]) || off(k) <= OFF_PITCH * widest);
    if on_pitch { (fitted, solved[1]) } else { (own, widest) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::ink::line::Run;

    fn row(digits: &[[usize; 2]]) -> Row {
        let run = |&[left, right]: &[usize; 2]| Run { left, top: 10, right, bottom: 29, area: 100 };
        Row { digits: digits.iter().map(run).collect(), top: 10, bottom: 29 }
    }

    const LEVELS: Levels = Levels { background: 20.0, ink: 220.0 };

    #[test]
    fn a_cell_with_only_narrow_digits_is_placed_by_the_pitch() {
        // Pitch 14, the mark 6 wide; the second digit is a 1 of seven segments, at the right of its cell.
        let format = ClockFormat::parse("ss.tt").unwrap();
        let rows = [row(&[[10, 19], [31, 33], [44, 53], [58, 67]]), row(&[[10, 19], [31, 33], [44, 53], [59, 66]])];
        let seen: Vec<&Row> = rows.iter().collect();
        let cells = Cells::around(&seen, &format, LEVELS).unwrap();
        let middles: Vec<f32> = cells.still.iter().map(|cut| cut.left + 0.5 * cut.width).collect();
        for (middle, expected) in middles.iter().zip([15.0, 29.0, 49.0, 63.0]) {
            // The narrow one's own middle, 3.5 off, counts a little, and so does what is thought of pitches before.
            assert!((middle - expected).abs() <= 0.3, "{middles:?}");
        }
        assert!(cells.still.iter().all(|cut| (cut.width - 12.0).abs() < 0.01 && cut.top < 10.0));
        assert!(Cells::around(&[], &format, LEVELS).is_none());
    }

    #[test]
    fn ink_is_found_in_its_cell_without_slivers_of_the_neighbours() {
        let mut gray = Gray { width: 30, height: 20, values: vec![20.0; 600] };
        for (x, y) in [(8, 5), (9, 5), (10, 8), (15, 5), (3, 5), (20, 6)] {
            gray.values[y * 30 + x] = 220.0;
        }
        let cells = Cells { still: Vec::new(), moving: false, line: [0.0; 2], pitch: 1.0, levels: LEVELS };
        let cut = Cut { left: 3.0, top: 2.0, width: 18.0, height: 15.0 };
        let ink = cells.ink(&gray, cut).unwrap();
        assert_eq!((ink.left, ink.top, ink.width, ink.height), (8.0, 5.0, 8.0, 4.0));
        assert!(cells.ink(&gray, Cut { top: 10.0, height: 8.0, ..cut }).is_none());
    }
}
