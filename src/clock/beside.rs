//! What stands beside a clock's digits: whether its format fits, and AM or PM.
//!
//! In: a crop, the clock's cells in it, and its format. Out: the characters that follow the cells on either side at the pitch of the digits and
//! on their line, as high as they are: digits for the network, colons, and dots that digits follow; and AM or PM. A screen's frame, lines
//! of text above and below, words and icons are none of these. What a region's edge cuts off counts as a digit where it stands as one.

use std::cell::OnceCell;

use super::cells::Cells;
use super::crop::Gray;
use super::format::{Cell, ClockFormat, Half};
use super::half::half;
use super::ink::{Piece, all_pieces};
use super::judge::Page;
use super::line::{Run, SPECK, UNEVEN, WIDEST, runs};
use super::look::Cut;

/// A clock shows more than its format has.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Misfit {
    /// The format that would fit, where there is one.
    pub fitting: Option<String>,
}

/// So many frames of another format say that the clock is; and one of so many within the stretch that was read.
const FEWEST: usize = 3;
const STRAY: usize = 10;

impl Misfit {
    /// Whether the whole clock is of another format: frames whose digits stand beside more than the format has (`other`) are not strays between
    /// those that were read, nor lie before or after them as where a clock becomes wider. Both are the frames' places in order.
    #[must_use]
    pub fn is_of_all(read: &[usize], other: &[usize]) -> bool {
        let Some((first, last)) = read.first().zip(read.last()) else { return other.len() >= FEWEST };
        let within = other.iter().filter(|&place| (first..=last).contains(&place)).count();
        within >= FEWEST && STRAY * within > read.len() || other.len() >= read.len().max(FEWEST)
    }

    /// What is wrong with this format and what to write instead.
    #[must_use]
    pub fn says(&self, format: &ClockFormat, frames: usize) -> String {
        let help = match &self.fitting {
            Some(fitting) => format!("write format = \"{fitting}\""),
            None => "write all of its characters into the format, or a roi that holds no more than the format has"
                .to_owned(),
        };
        format!(
            "beside the digits of its format \"{}\" there is more of the clock in {frames} frame(s): a further digit, a colon, or AM or PM; {help}",
            format.text()
        )
    }
}

/// What stands on either side, the nearest first: `d` for a digit, marks as they are.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
struct Side {
    characters: Vec<char>,
    half: Option<Half>,
}

/// What stands beside the digits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Beside {
    /// On the left and on the right.
    sides: [Side; 2],
}

/// The middles of neighbouring digits are so many pitches apart: a narrow digit may stand on either side of its cell, and a blank between
/// two words makes it 1.5 or 2.
const NEXT: [f32; 2] = [0.4, 1.38];
/// And so many a digit and the mark beside it, and a mark and the digit that follows.
const NEXT_TO_MARK: [f32; 2] = [0.2, 1.2];
const AFTER_MARK: [f32; 2] = [0.2, 1.38];
/// A digit that the edge cuts off begins at most so many pitches from the middle of its neighbour.
const CUT_OFF: f32 = 0.95;
/// A blank before or after AM or PM is at most so many heights of the digits wide, one between letters such a share of their height.
const BLANK: f64 = 1.4;
const LETTERS_APART: f64 = 0.6;
/// Lower characters are no letters.
const LEAST_LETTER: f64 = 0.28;
/// How far characters reach above and below the digits, and how high they are at most, in heights of a digit.
const ABOVE: f64 = 0.3;
const BELOW: f64 = 0.45;
const TALLEST: f64 = 1.35;
/// No character reaches further than this both above and below the digits: a screen's frame does, and would swallow a digit within.
const BEYOND_BOTH: f64 = 0.1;
/// A mark's parts are lower than this, in heights of a digit.
const MARK: f64 = 0.45;
/// Between the dots of a colon there is this share of its height.
const DOTS_APART: f64 = 0.15;
/// A run is a digit where the network finds all digits together this probable.
const DIGIT: f64 = 0.5;

impl Beside {
    /// Looks beside the first and the last of the cells.
    pub(super) fn look(gray: &Gray, cells: &Cells, [first, last]: [Cut; 2]) -> Self {
        let scene = Scene::new(gray, cells);
        let middle = |cut: Cut| cut.left + 0.5 * cut.width;
        let whole = |edge: f32| (edge.round().max(0.0) as usize).min(gray.width);
        let left = scene.runs(0, whole(first.left + first.width)).into_iter().rev();
        let left: Vec<Run> = left.filter(|run| run_middle(run) < first.left).collect();
        let right = scene.runs(whole(last.left), gray.width).into_iter();
        let right: Vec<Run> = right.filter(|run| run_middle(run) > last.left + last.width).collect();
        Self { sides: [scene.side(&left, middle(first), true), scene.side(&right, middle(last), false)] }
    }

    /// AM or PM on the format's side.
    pub(super) fn half(&self, format: &ClockFormat) -> Option<Half> {
        let side = usize::from(!format.half_leads());
        self.sides[side].half.filter(|_| format.has_half() && self.sides[side].characters.is_empty())
    }

    /// What the format lacks, if anything.
    pub(super) fn misfit(&self, format: &ClockFormat) -> Option<Misfit> {
        let [left, right] = &self.sides;
        let half = |leads: bool, side: &Side| {
            side.half.is_some() && !(format.has_half() && format.half_leads() == leads && side.characters.is_empty())
        };
        let more = self.sides.iter().any(|side| !side.characters.is_empty());
        (more || half(true, left) || half(false, right)).then(|| Misfit { fitting: self.fitting(format) })
    }

    /// The format with what stands beside it.
    fn fitting(&self, format: &ClockFormat) -> Option<String> {
        let [left, right] = &self.sides;
        let own = format.cells().iter().filter_map(|cell| match cell {
            Cell::Digit { .. } => Some('d'),
            Cell::Mark(mark) => Some(*mark),
            Cell::Half => None,
        });
        let own: String = own.collect();
        let all: Vec<char> = left
            .characters
            .iter()
            .rev()
            .copied()
            .chain(own.trim().chars())
            .chain(right.characters.iter().copied())
            .collect();
        // A colon that nothing follows is none of the format's.
        let begin = left.characters.last().map_or(0, |&c| usize::from(c != 'd'));
        let end = all.len() - right.characters.last().map_or(0, |&c| usize::from(c != 'd'));
        let all = &all[begin..end];
        let groups: Vec<usize> = all.split(|&c| c != 'd').map(<[char]>::len).filter(|&count| count > 0).collect();
        let fraction = format.decimals() > 0 && !right.characters.contains(&':')
            || all.iter().rev().find(|&&c| c != 'd').is_some_and(|c| matches!(c, '.' | ','));
        let units = match (groups.len() - usize::from(fraction), fraction) {
            (3, _) => "hms",
            (2, false) if format.text().contains('h') => "hm",
            (2, _) => "ms",
            (1, _) => "s",
            _ => return None,
        };
        let mut units = units.chars().chain(fraction.then_some('t'));
        let mut unit = units.next();
        let mut text = String::new();
        for (k, &c) in all.iter().enumerate() {
            if c == 'd' {
                text.push(unit?);
            } else {
                text.push(c);
                if k > 0 && all[k - 1] == 'd' {
                    unit = units.next();
                }
            }
        }
        if left.half.is_some() || format.half_leads() {
            text = format!("a {text}");
        } else if right.half.is_some() || format.has_half() {
            text += " a";
        }
        ClockFormat::parse(&text).ok().map(|_| text).filter(|text| text != format.text())
    }
}

fn run_middle(run: &Run) -> f32 {
    0.5 * (run.left + run.right + 1) as f32
}

fn tall(run: &Run) -> f64 {
    (run.bottom - run.top + 1) as f64
}

/// A crop and the line of the digits in it.
struct Scene<'a> {
    gray: &'a Gray,
    cells: &'a Cells,
    /// Only where a run can be a character.
    page: OnceCell<Page>,
    top: f64,
    /// First row below the digits.
    bottom: f64,
    height: f64,
}

impl<'a> Scene<'a> {
    fn new(gray: &'a Gray, cells: &'a Cells) -> Self {
        let [top, bottom] = cells.line.map(f64::from);
        Self { gray, cells, page: OnceCell::new(), top, bottom, height: bottom - top }
    }

    /// The runs of ink in some columns that can be characters on the digits' line, from the left to the right.
    fn runs(&self, from: usize, to: usize) -> Vec<Run> {
        let &Self { gray, cells, top, bottom, height, .. } = self;
        if from >= to {
            return Vec::new();
        }
        let values = (0..gray.height).flat_map(|y| gray.row(y)[from..to].iter().copied()).collect();
        let strip = Gray { width: to - from, height: gray.height, values };
        let levels = cells.levels;
        let limit = 0.5 * (levels.background + levels.ink);
        let on_line = |piece: &Piece| {
            let [above, below] = [piece.top as f64, (piece.bottom + 1) as f64];
            let within = below.min(bottom) - above.max(top);
            let encloses = top - above > BEYOND_BOTH * height && below - bottom > BEYOND_BOTH * height;
            !encloses
                && piece.area > SPECK
                && piece.top > 0
                && piece.bottom + 1 < gray.height
                && tall(piece) <= TALLEST * height
                && above >= top - ABOVE * height
                && below <= bottom + BELOW * height
                && within >= 0.5 * tall(piece)
        };
        let mut pieces = all_pieces(&strip, limit, levels.ink > levels.background);
        pieces.retain(on_line);
        runs(pieces).into_iter().map(|run| Run { left: run.left + from, right: run.right + from, ..run }).collect()
    }

    /// What stands on one side; runs from the nearest on, `middle` of the cell that they stand beside.
    fn side(&self, runs: &[Run], middle: f32, left: bool) -> Side {
        let pitch = self.cells.pitch;
        let mut side = Side::default();
        let mut from = middle;
        for (k, run) in runs.iter().enumerate() {
            if let Some(half) = self.word(&runs[k..], left) {
                let near = if left { from - run.right as f32 } else { run.left as f32 - from };
                if f64::from(near) <= f64::from(pitch) + BLANK * self.height {
                    side.half = Some(half);
                }
                break;
            }
            let after_mark = side.characters.last().is_some_and(|&c| c != 'd');
            let apart = (run_middle(run) - from).abs() / pitch;
            let near = if left { from - (run.right + 1) as f32 } else { run.left as f32 - from } / pitch;
            let within = |[low, high]: [f32; 2]| (low..=high).contains(&apart);
            if let Some(mark) = self.mark(run).filter(|_| !after_mark && within(NEXT_TO_MARK)) {
                side.characters.push(mark);
            } else if self.is_aligned(run)
                && (self.is_cut(run) && near <= CUT_OFF
                    || within(if after_mark { AFTER_MARK } else { NEXT }) && self.is_digit(run))
            {
                side.characters.push('d');
            } else {
                break;
            }
            from = run_middle(run);
        }
        // A speck is no mark where nothing follows.
        while side.characters.last().is_some_and(|&c| c != 'd' && c != ':') {
            side.characters.pop();
        }
        side
    }

    /// Whether a run is as high as the digits and where they are.
    fn is_aligned(&self, run: &Run) -> bool {
        let slack = (UNEVEN * self.height).max(1.5);
        (run.top as f64 - self.top).abs() <= slack
            && ((run.bottom + 1) as f64 - self.bottom).abs() <= slack
            && (run.right - run.left + 1) as f64 <= WIDEST * self.height
    }

    /// Whether the crop's edge cuts a run off.
    fn is_cut(&self, run: &Run) -> bool {
        (run.left == 0 || run.right + 1 == self.gray.width) && run.right > run.left
    }

    fn is_digit(&self, run: &Run) -> bool {
        1.0 - self.other(run) >= DIGIT
    }

    /// How probably the network finds no digit in a run.
    fn other(&self, run: &Run) -> f64 {
        let ink = Cut {
            left: run.left as f32,
            top: run.top as f32,
            width: (run.right - run.left + 1) as f32,
            height: (run.bottom - run.top + 1) as f32,
        };
        self.page.get_or_init(|| Page::new(self.gray)).judge(ink, self.cells.levels).other
    }

    /// The mark that a run can be: a colon, a dot, a quote.
    fn mark(&self, run: &Run) -> Option<char> {
        let middle = 0.5 * (self.top + self.bottom);
        let (top, bottom) = (run.top as f64, (run.bottom + 1) as f64);
        if (run.right - run.left + 1) as f64 > MARK * self.height {
            return None;
        }
        if tall(run) <= MARK * self.height {
            return if top >= middle { Some('.') } else { (bottom <= middle).then_some('\'') };
        }
        // Two dots far apart; the strokes of a 1 of seven segments are near each other.
        let levels = self.cells.levels;
        let limit = 0.5 * (levels.background + levels.ink);
        let ink = |&value: &f32| (value > limit) == (levels.ink > levels.background);
        let free = |y: &usize| !self.gray.row(*y)[run.left..=run.right].iter().any(ink);
        let apart = (run.top..=run.bottom).filter(free).count() as f64;
        let inside = top > self.top
            && top < middle
            && bottom > middle
            && bottom <= self.bottom + (UNEVEN * self.height).max(1.5);
        (inside && apart >= DOTS_APART * tall(run)).then_some(':')
    }

    /// AM or PM where these runs, from the nearest on, begin with it.
    fn word(&self, runs: &[Run], left: bool) -> Option<Half> {
        let most = |runs: &[Run]| runs.iter().map(tall).fold(0.0, f64::max);
        let gap = |near: &Run, far: &Run| if left { near.left - far.right } else { far.left - near.right } as f64;
        let count =
            1 + runs.windows(2).take_while(|pair| gap(&pair[0], &pair[1]) <= 1.0 + LETTERS_APART * most(pair)).count();
        let mut word = runs[..count].to_vec();
        if word.len() > 4 || most(&word) < LEAST_LETTER * self.height || word.iter().any(|run| self.is_cut(run)) {
            return None;
        }
        if left {
            word.reverse();
        }
        half(self.gray, &word, self.cells.levels, |run| self.other(run))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strays_and_a_clock_that_becomes_wider_are_no_other_format() {
        let read: Vec<usize> = (0..100).collect();
        assert!(!Misfit::is_of_all(&read, &[40, 41, 42, 43, 44]));
        assert!(!Misfit::is_of_all(&read, &(100..190).collect::<Vec<_>>()));
        assert!(Misfit::is_of_all(&read, &(40..60).collect::<Vec<_>>()));
        assert!(Misfit::is_of_all(&[], &[3, 4, 5]) && !Misfit::is_of_all(&[], &[3]));
        assert!(Misfit::is_of_all(&[50], &(0..40).collect::<Vec<_>>()));
    }

    #[test]
    fn the_format_that_fits_has_what_stands_beside() {
        let fitting = |format: &str, left: &str, right: &str, half: [bool; 2]| {
            let side = |characters: &str, half: bool| Side {
                characters: characters.chars().collect(),
                half: half.then_some(Half::Am),
            };
            let beside = Beside { sides: [side(left, half[0]), side(right, half[1])] };
            beside.fitting(&ClockFormat::parse(format).unwrap())
        };
        let none = [false, false];
        assert_eq!(fitting("h:mm", "d", "", none).as_deref(), Some("hh:mm"));
        assert_eq!(fitting("h:mm", "d", ":dd", none).as_deref(), Some("hh:mm:ss"));
        assert_eq!(fitting("h:mm", "d:dd", "", none).as_deref(), Some("hh:mm:ss"));
        assert_eq!(fitting("mm:ss", "", ".d", none).as_deref(), Some("mm:ss.t"));
        assert_eq!(fitting("ss.t", ":dd", "d", none).as_deref(), Some("mm:ss.tt"));
        assert_eq!(fitting("hh:mm", "", "", [false, true]).as_deref(), Some("hh:mm a"));
        assert_eq!(fitting("h:mm a", "d", ":dd", [false, true]).as_deref(), Some("hh:mm:ss a"));
        assert_eq!(fitting("mm:ss", ":dd:dd", "", none), None);
    }
}
