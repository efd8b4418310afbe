//! AM and PM.
//!
//! In: runs of ink beside a clock's digits that stand close enough together to be a word. Out: AM, PM, or neither for
//! sure. Capitals and small letters, with dots or without, of any typeface are recognised by what all typefaces share:
//! the right side of an A or a reaches down to the line, that of a P or p does not, and an M or m has a stem on either
//! side. Two letters that touch are parted where there is least ink.

use crate::clock::format::Half;
use crate::clock::glyph::Levels;
use crate::clock::ink::crop::Gray;
use crate::clock::ink::line::Run;

/// A run this much lower than the highest of its word is a dot.
const DOT: f64 = 0.4;
/// Letters of one word are this much alike in height: an `m` has no descender, a `p` has.
const UNLIKE: f64 = 0.5;
/// Lower letters can't be distinguished, samples.
const LEAST_HEIGHT: usize = 5;
/// One run this much wider than high may be two letters that touch; they part between these shares of its width.
const TOUCHING: [f64; 2] = [1.3, 3.0];
const PARTING: [f64; 2] = [0.3, 0.62];
/// An M is no narrower than this share of its height.
const NARROWEST_M: f64 = 0.55;
/// Ink covers a side where the mean over its rows of the darkest place in each is this share of the letter's darkest
/// ink, and leaves it free below the second share (assumed; no AM read as PM or the reverse on 48 typefaces at three
/// heights, 5760 frames over noon and midnight).
const COVERED: f32 = 0.6;
const FREE: f32 = 0.27;
/// An M is no digit for the network: it finds anything else at least this probable.
const NO_DIGIT: f64 = 0.5;

/// A word that is AM or PM.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::clock) enum Word {
    Half(Half),
    /// One of them, for an M follows another letter.
    Unclear,
}

/// What a word of these runs, from the left to the right, is, if it is AM or PM; `other` is how probably the network
/// finds no digit in a run.
pub(in crate::clock) fn word(gray: &Gray, word: &[Run], levels: Levels, other: impl Fn(&Run) -> f64) -> Option<Word> {
    let most = word.iter().map(Run::height).max().filter(|&most| most >= LEAST_HEIGHT)?;
    let letters: Vec<Run> = word.iter().filter(|run| run.height() as f64 > DOT * most as f64).copied().collect();
    let [first, second] = match letters[..] {
        [first, second] if first.height().min(second.height()) as f64 >= UNLIKE * most as f64 => [first, second],
        [both] if (TOUCHING[0]..=TOUCHING[1]).contains(&(both.width() as f64 / both.height() as f64)) => {
            part(gray, both, levels)?
        }
        _ => return None,
    };
    let letter = Letter::new(gray, second, levels)?;
    let is_m = letter.covers([0.0, 0.38], [0.15, 0.85]) >= COVERED
        && letter.covers([0.62, 1.0], [0.15, 0.85]) >= COVERED
        && second.width() as f64 >= NARROWEST_M * second.height() as f64
        && other(&second) >= NO_DIGIT;
    let half = Letter::new(gray, first, levels)?.half();
    is_m.then(|| half.map_or(Word::Unclear, Word::Half))
}

/// Two letters that touch.
fn part(gray: &Gray, both: Run, levels: Levels) -> Option<[Run; 2]> {
    let width = both.width() as f64;
    let column = |x: usize| -> f32 { (both.top..=both.bottom).map(|y| ink(gray.row(y)[x], levels)).sum() };
    let [from, to] = PARTING.map(|share| both.left + (share * width) as usize);
    let at = (from..=to.min(both.right)).min_by(|&a, &b| column(a).total_cmp(&column(b)))?;
    // Each letter's own rows: an m is lower than a p.
    let limit = 0.5;
    let tight = |left: usize, right: usize| {
        let inked = |&y: &usize| (left..=right).any(|x| ink(gray.row(y)[x], levels) > limit);
        let top = (both.top..=both.bottom).find(inked)?;
        let bottom = (both.top..=both.bottom).rev().find(inked)?;
        Some(Run { left, right, top, bottom, area: both.area })
    };
    let [first, second] = [tight(both.left, at.checked_sub(1)?)?, tight(at + 1, both.right)?];
    (first.height().min(second.height()) >= LEAST_HEIGHT).then_some([first, second])
}

/// How much ink covers a sample.
fn ink(value: f32, levels: Levels) -> f32 {
    (value - levels.background) / (levels.ink - levels.background)
}

/// One letter and what its darkest ink is worth.
struct Letter<'a> {
    gray: &'a Gray,
    run: Run,
    levels: Levels,
    most: f32,
}

impl<'a> Letter<'a> {
    fn new(gray: &'a Gray, run: Run, levels: Levels) -> Option<Self> {
        let mut values: Vec<f32> = (run.top..=run.bottom)
            .flat_map(|y| gray.row(y)[run.left..=run.right].iter().map(|&value| ink(value, levels)))
            .collect();
        values.sort_unstable_by(f32::total_cmp);
        // Noise makes single samples too dark.
        let most = values[values.len() - 1 - values.len() / 10];
        (most > 0.3 && most.is_finite()).then_some(Self { gray, run, levels, most })
    }

    /// The mean over the rows of a part of the letter's box of the darkest place in each row, as a share of the
    /// letter's darkest ink.
    fn covers(&self, across: [f64; 2], down: [f64; 2]) -> f32 {
        const LOOKS: usize = 8;
        let Run { left, top, right, bottom, .. } = self.run;
        let at = |low: usize, high: usize, share: f64| low as f64 - 0.5 + share * (high - low + 1) as f64;
        let [from, to] = across.map(|share| at(left, right, share));
        let steps = (2.0 * (to - from)).ceil().max(1.0) as usize;
        let row = |look: usize| {
            let y = at(top, bottom, down[0] + (down[1] - down[0]) * (look as f64 + 0.5) / LOOKS as f64);
            let place = |step: usize| from + (to - from) * (step as f64 + 0.5) / steps as f64;
            (0..steps).map(|step| self.between(place(step), y)).fold(0.0, f32::max)
        };
        (0..LOOKS).map(row).sum::<f32>() / (LOOKS as f32 * self.most)
    }

    fn between(&self, x: f64, y: f64) -> f32 {
        let (x, y) = (x.clamp(0.0, (self.gray.width - 1) as f64), y.clamp(0.0, (self.gray.height - 1) as f64));
        let (x0, y0) = (x as usize, y as usize);
        let (x1, y1) = ((x0 + 1).min(self.gray.width - 1), (y0 + 1).min(self.gray.height - 1));
        let (fx, fy) = ((x - x0 as f64) as f32, (y - y0 as f64) as f32);
        let row = |y: usize| (1.0 - fx) * self.gray.row(y)[x0] + fx * self.gray.row(y)[x1];
        ink((1.0 - fy) * row(y0) + fy * row(y1), self.levels)
    }

    /// AM of an A, PM of a P.
    fn half(&self) -> Option<Half> {
        // A p's bowl reaches further down than a P's, and the dot after a P may stand under its bowl.
        let [middle, low] = [[0.64, 0.84], [0.84, 0.97]].map(|down| self.covers([0.64, 0.97], down));
        let left = |down: [f64; 2]| self.covers([0.0, 0.42], down);
        let bowl = self.covers([0.55, 1.0], [0.12, 0.4]) >= COVERED && left([0.12, 0.4]) >= COVERED;
        if middle >= COVERED && low >= COVERED && left([0.84, 0.97]) >= COVERED {
            Some(Half::Am)
        } else if middle.min(low) <= FREE && middle.max(low) < COVERED && left([0.64, 0.97]) >= COVERED && bowl {
            Some(Half::Pm)
        } else {
            None
        }
    }
}
