//! The ink beside a clock's digits, on their line.
//!
//! In: a crop and the clock's cells. Out: the runs of ink on either side that can be characters ([`Scene::runs`]), and
//! what each side says ([`Scene::side`]).

use std::cell::OnceCell;

use super::Side;
use crate::clock::cell::cells::Cells;
use crate::clock::cell::half::{Word, word};
use crate::clock::cell::judge::Page;
use crate::clock::cell::look::Cut;
use crate::clock::ink::crop::Gray;
use crate::clock::ink::line::{Run, SPECK, UNEVEN, WIDEST, runs};
use crate::clock::ink::pieces::{Piece, all_pieces};

/// The middles of neighbouring digits are so many pitches apart: a narrow digit may stand on either side of its cell,
/// and a blank between two words makes it 1.5 or 2.
const NEXT: [f32; 2] = [0.4, 1.38];
/// And so many a digit and the mark beside it, and a mark and the digit that follows.
const NEXT_TO_MARK: [f32; 2] = [0.2, 1.2];
const AFTER_MARK: [f32; 2] = [0.2, 1.38];
/// What is darker than this share of the ink is ink.
const HALF_INK: f32 = 0.5;
/// Letters that fall to pieces or touch at that share are looked at with these.
const OTHER_SHARES: [f32; 2] = [0.35, 0.65];
/// A digit that the edge cuts off begins at most so many pitches from the middle of its neighbour.
const CUT_OFF: f32 = 0.95;
/// A blank before or after AM or PM is at most so many heights of the digits wide, one between letters such a share of
/// their height.
const BLANK: f64 = 1.4;
const LETTERS_APART: f64 = 0.6;
/// Lower characters are no letters.
const LEAST_LETTER: f64 = 0.28;
/// How far characters reach above and below the digits, and how high they are at most, in heights of a digit.
const ABOVE: f64 = 0.5;
const BELOW: f64 = 0.55;
const TALLEST: f64 = 1.65;
/// Old-style figures are of three kinds: low ones, some that reach down and some that reach up by such a share of the
/// others' height; the low ones are so much lower.
const OLD_STYLE: f64 = 0.55;
const LOW_FIGURE: f64 = 0.55;
/// Figures that reach up or down are no narrower than this share of their height: a bar or bracket is.
const NARROWEST_LONG: f64 = 0.4;
/// What is not on the digits' lines is a digit where the network finds all digits together this probable.
const OLD_STYLE_DIGIT: f64 = 0.8;
/// No character reaches further than this both above and below the digits: a screen's frame does, and would swallow a
/// digit within.
const BEYOND_BOTH: f64 = 0.1;
/// And what stands around anything this high is a frame; the dot in a 0 is lower.
const FRAMED: f64 = 0.3;
/// A mark's parts are lower than this, in heights of a digit.
const MARK: f64 = 0.45;
/// Between the dots of a colon there is this share of its height.
const DOTS_APART: f64 = 0.15;
/// A run is a digit where the network finds all digits together this probable.
const DIGIT: f64 = 0.5;

fn run_middle(run: &Run) -> f32 {
    0.5 * (run.left + run.right + 1) as f32
}

fn tall(run: &Run) -> f64 {
    run.height() as f64
}

/// A crop and the line of the digits in it.
pub(super) struct Scene<'a> {
    gray: &'a Gray,
    cells: &'a Cells,
    /// Only where a run can be a character.
    page: OnceCell<Page>,
    top: f64,
    /// First row below the digits.
    bottom: f64,
    height: f64,
    /// How far off their lines and height digits may be.
    slack: f64,
}

impl<'a> Scene<'a> {
    pub(super) fn new(gray: &'a Gray, cells: &'a Cells) -> Self {
        let [top, bottom] = cells.line.map(f64::from);
        let height = bottom - top;
        Self { gray, cells, page: OnceCell::new(), top, bottom, height, slack: (UNEVEN * height).max(1.5) }
    }

    /// The runs of ink beside a cell that can be characters on the digits' line, the nearest first.
    fn beside(&self, cell: Cut, left: bool, share: f32) -> Vec<Run> {
        let whole = |edge: f32| (edge.round().max(0.0) as usize).min(self.gray.width);
        if left {
            let mut runs = self.runs(0, whole(cell.left + cell.width), share);
            runs.retain(|run| run_middle(run) < cell.left);
            runs.reverse();
            runs
        } else {
            let mut runs = self.runs(whole(cell.left), self.gray.width, share);
            runs.retain(|run| run_middle(run) > cell.left + cell.width);
            runs
        }
    }

    /// The runs of ink in some columns that can be characters on the digits' line, from the left to the right.
    fn runs(&self, from: usize, to: usize, share: f32) -> Vec<Run> {
        let &Self { gray, cells, top, bottom, height, .. } = self;
        if from >= to {
            return Vec::new();
        }
        let values = (0..gray.height).flat_map(|y| gray.row(y)[from..to].iter().copied()).collect();
        let strip = Gray { width: to - from, height: gray.height, values };
        let levels = cells.levels;
        let limit = levels.background + share * (levels.ink - levels.background);
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
        let all = all_pieces(&strip, limit, levels.ink > levels.background);
        let frames = |piece: &Piece| all.iter().any(|other| piece.holds(other) && tall(other) >= FRAMED * height);
        let pieces = all.iter().filter(|piece| on_line(piece) && !frames(piece)).copied().collect();
        runs(pieces).into_iter().map(|run| Run { left: run.left + from, right: run.right + from, ..run }).collect()
    }

    /// What stands on one side of the outermost cell there.
    pub(super) fn side(&self, cell: Cut, left: bool) -> Side {
        let runs = self.beside(cell, left, HALF_INK);
        let middle = cell.left + 0.5 * cell.width;
        let mut side = self.characters(&runs, middle, left);
        let clear = matches!(side.word, Some(Word::Half(_)));
        if !clear && side.characters.is_empty() && runs.first().is_some_and(|run| self.is_near(run, middle, left)) {
            let other = OTHER_SHARES.iter().find_map(|&share| {
                let runs = self.beside(cell, left, share);
                let near = |_: &Word| self.is_near(&runs[0], middle, left);
                self.word(&runs, left).filter(|word| matches!(word, Word::Half(_))).filter(near)
            });
            side.word = other.or(side.word);
        }
        side
    }

    /// Whether a word may begin with a run, after a blank.
    fn is_near(&self, run: &Run, from: f32, left: bool) -> bool {
        let near = if left { from - run.right as f32 } else { run.left as f32 - from };
        f64::from(near) <= f64::from(self.cells.pitch) + BLANK * self.height
    }

    /// What these runs are, the nearest first; `middle` of the cell that they stand beside.
    fn characters(&self, runs: &[Run], middle: f32, left: bool) -> Side {
        let pitch = self.cells.pitch;
        let mut side = Side::default();
        let mut from = middle;
        for (k, run) in runs.iter().enumerate() {
            let word = self.word(&runs[k..], left);
            if let Some(Word::Half(_)) = word {
                side.word = word.filter(|_| self.is_near(run, from, left));
                break;
            }
            let after_mark = side.characters.last().is_some_and(|&c| c != 'd');
            let apart = (run_middle(run) - from).abs() / pitch;
            let near = if left { from - (run.right + 1) as f32 } else { run.left as f32 - from } / pitch;
            let within = |[low, high]: [f32; 2]| (low..=high).contains(&apart);
            if let Some(mark) = self.mark(run).filter(|_| !after_mark && within(NEXT_TO_MARK)) {
                side.characters.push(mark);
            } else if self.is_aligned(run) && self.is_cut(run) && near <= CUT_OFF
                || within(if after_mark { AFTER_MARK } else { NEXT }) && self.is_digit(run)
            {
                side.characters.push('d');
            } else {
                side.word = word.filter(|_| self.is_near(run, from, left));
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
        (run.top as f64 - self.top).abs() <= self.slack
            && ((run.bottom + 1) as f64 - self.bottom).abs() <= self.slack
            && run.width() as f64 <= WIDEST * self.height
    }

    /// Whether the crop's edge cuts a run off.
    fn is_cut(&self, run: &Run) -> bool {
        (run.left == 0 || run.right + 1 == self.gray.width) && run.right > run.left
    }

    fn is_digit(&self, run: &Run) -> bool {
        let least = match (self.is_aligned(run), self.is_old_style(run)) {
            (true, _) => DIGIT,
            (false, true) => OLD_STYLE_DIGIT,
            (false, false) => return false,
        };
        1.0 - self.other(run) >= least
    }

    /// Whether a run may be an old-style figure beside figures that reach up or down otherwise. Its top is no lower
    /// than theirs, for a letter or icon beside others often is.
    fn is_old_style(&self, run: &Run) -> bool {
        let [up, down] = [self.top - run.top as f64, (run.bottom + 1) as f64 - self.bottom];
        let most = OLD_STYLE * self.height;
        let wide = run.width() as f64;
        (-self.slack..=most).contains(&up)
            && (-most..=most).contains(&down)
            && up.min(down) <= (BEYOND_BOTH * self.height).max(1.0)
            && tall(run) >= LOW_FIGURE * self.height
            && (tall(run) <= self.height + self.slack || wide >= NARROWEST_LONG * tall(run))
            && wide <= WIDEST * self.height
    }

    /// How probably the network finds no digit in a run.
    fn other(&self, run: &Run) -> f64 {
        self.page.get_or_init(|| Page::new(self.gray)).judge(Cut::around(run), self.cells.levels).other
    }

    /// The mark that a run can be: a colon, a dot, a quote.
    fn mark(&self, run: &Run) -> Option<char> {
        let middle = 0.5 * (self.top + self.bottom);
        let (top, bottom) = (run.top as f64, (run.bottom + 1) as f64);
        if run.width() as f64 > MARK * self.height {
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
        let inside = top > self.top && top < middle && bottom > middle && bottom <= self.bottom + self.slack;
        (inside && apart >= DOTS_APART * tall(run)).then_some(':')
    }

    /// AM or PM where these runs, from the nearest on, begin with it.
    fn word(&self, runs: &[Run], left: bool) -> Option<Word> {
        if runs.is_empty() {
            return None;
        }
        let most = |runs: &[Run]| runs.iter().map(tall).fold(0.0, f64::max);
        let gap = |near: &Run, far: &Run| if left { near.left - far.right } else { far.left - near.right } as f64;
        let count =
            1 + runs.windows(2).take_while(|pair| gap(&pair[0], &pair[1]) <= 1.0 + LETTERS_APART * most(pair)).count();
        let mut letters = runs[..count].to_vec();
        if letters.len() > 4
            || most(&letters) < LEAST_LETTER * self.height
            || letters.iter().any(|run| self.is_cut(run))
        {
            return None;
        }
        if left {
            letters.reverse();
        }
        word(self.gray, &letters, self.cells.levels, |run| self.other(run))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::format::ClockFormat;
    use crate::clock::glyph::Levels;
    use crate::clock::ink::line::Row;

    #[test]
    fn old_style_figures_are_no_brackets_bars_or_letters() {
        let run = |left, top, right, bottom| Run { left, top, right, bottom, area: 100 };
        let row = Row { digits: vec![run(50, 30, 61, 49), run(70, 30, 81, 49)], top: 30, bottom: 49 };
        let levels = Levels { background: 20.0, ink: 220.0 };
        let cells = Cells::around(&[&row], &ClockFormat::parse("ss").unwrap(), levels).unwrap();
        let gray = Gray { width: 130, height: 80, values: vec![20.0; 130 * 80] };
        let scene = Scene::new(&gray, &cells);
        // Beside figures that reach down: a low one and one that reaches up. Beside low ones: one that reaches down and
        // one that reaches up.
        for figure in [run(90, 30, 101, 42), run(90, 23, 101, 42), run(90, 30, 101, 57), run(90, 22, 101, 49)] {
            assert!(scene.is_old_style(&figure) && !scene.is_aligned(&figure), "{figure:?}");
        }
        // A bracket, a bar, small letters without and with a descender, a degree sign.
        let others =
            [run(90, 26, 96, 55), run(90, 30, 94, 56), run(90, 36, 101, 49), run(90, 36, 101, 55), run(90, 28, 97, 35)];
        for other in others {
            assert!(!scene.is_old_style(&other), "{other:?}");
        }
    }
}
