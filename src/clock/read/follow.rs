//! Crops to readings, once the clock is learnt.
//!
//! In: crops of one rectangle, in order. Out: a [`Reading`] of each. Every cell's look is held against the clock's own
//! glyphs ([`crate::clock::cell::bank`]). What is like one of them, yet not quite, is read where the network says the
//! same; what is like none of them is shown to the network once it has stood still for a few frames, and what lies
//! between two of them is not read.

use super::learn::{FAINT, Model};
use crate::clock::beside::Beside;
use crate::clock::cell::bank::Verdict;
use crate::clock::cell::judge::Page;
use crate::clock::cell::look::{Cut, Look};
use crate::clock::cell::names::{NAMED, Place, places};
use crate::clock::format::ClockFormat;
use crate::clock::glyph::SURE;
use crate::clock::ink::crop::Gray;
use crate::clock::{Doubt, ReaderEffort, Reading};

/// A look that is new has to stand still for so many frames before the network's word makes it a glyph.
const STEADY: u32 = 3;
/// And the network is asked again where it was not sure.
const ASKED: [u32; 3] = [STEADY, 10, 30];
/// How probable the network has to find the digit of the nearest glyph.
const AGREED: f64 = 0.6;
/// And that of a glyph that is hit by moving the cell.
const NOT_AGAINST: f64 = 0.3;
/// How far cells are moved, in their widths and heights: half a pixel and one where digits are 13 high.
const SHIFTS: [[f32; 2]; 8] =
    [[0.06, 0.0], [-0.06, 0.0], [0.0, 0.035], [0.0, -0.035], [0.12, 0.0], [-0.12, 0.0], [0.06, 0.035], [-0.06, -0.035]];

/// Reads one clock.
#[derive(Debug, Clone)]
pub(super) struct Follower {
    pub(super) model: Model,
    format: ClockFormat,
    places: Vec<Place>,
    /// Reads also where the format does not fit.
    pub(super) regardless: bool,
    /// The format did not fit where the clock was learnt: it is not read.
    pub(super) misfit: bool,
    /// Each cell's last look, and for how many frames it has been that.
    last: Vec<(Look, u32)>,
}

impl Follower {
    pub(super) fn new(model: Model, format: &ClockFormat) -> Self {
        Self {
            model,
            format: format.clone(),
            places: places(format),
            regardless: false,
            misfit: false,
            last: Vec::new(),
        }
    }

    /// Reads the clock in the next crop.
    pub(super) fn read(&mut self, gray: &Gray, effort: &mut ReaderEffort) -> Reading {
        let model = &self.model;
        let Some(boxes) = model.cells.boxes(gray, &self.format) else {
            return Reading::Abstained(Doubt::Unclear);
        };
        let looks: Vec<Look> = boxes.iter().map(|&cut| Look::cut(gray, cut)).collect();
        effort.digits += looks.len() as u64;
        if self.last.is_empty() {
            self.last = looks.iter().map(|look| (look.clone(), 0)).collect();
        }
        for ((last, stood), look) in self.last.iter_mut().zip(&looks) {
            if look.norm > FAINT * model.contrast && model.is_same(look, last) {
                *stood += 1;
            } else {
                (*last, *stood) = (look.clone(), 1);
            }
        }
        let mut page = None;
        let mut verdicts = Vec::with_capacity(looks.len());
        for (cell, look) in looks.iter().enumerate() {
            let first = self.model.judge(look);
            let verdict = match first {
                Verdict::Known { glyph, .. } => {
                    if self.last[cell].1 >= 2 && self.model.bank.cell(glyph) == cell {
                        self.model.bank.refine(glyph, look);
                    }
                    first
                }
                Verdict::Likely(_) | Verdict::Strange | Verdict::Between => {
                    self.ask(first, (cell, boxes[cell]), look, gray, &mut page, effort)
                }
                Verdict::Faint => first,
            };
            verdicts.push(verdict);
        }
        self.reading(&verdicts, gray, &boxes)
    }

    /// Asks the network where the glyphs don't tell.
    fn ask(
        &mut self,
        first: Verdict,
        (cell, cut): (usize, Cut),
        look: &Look,
        gray: &Gray,
        page: &mut Option<Page>,
        effort: &mut ReaderEffort,
    ) -> Verdict {
        let stood = self.last[cell].1;
        if !matches!(first, Verdict::Likely(_)) && !ASKED.contains(&stood) {
            return first;
        }
        let Some(ink) = self.model.cells.ink(gray, cut) else { return first };
        effort.judged += 1;
        let page = page.get_or_insert_with(|| Page::new(gray));
        let (digit, sure) = page.judge(ink, self.model.cells.levels).likeliest();
        let shifted = self.shifted(gray, cut);
        let alike = first == Verdict::Likely(digit) || shifted.is_some_and(|(known, _)| known == digit);
        let against = match first {
            Verdict::Likely(other) => other != digit,
            // A change during the exposure does not last.
            Verdict::Between => !alike && sure < SURE,
            _ => false,
        };
        if against || digit > self.places[cell].highest {
            return first;
        }
        let steady = stood >= STEADY;
        let confidence = match shifted {
            Some((known, confidence)) if known == digit && sure >= NOT_AGAINST => confidence.max(sure),
            _ => sure,
        };
        if steady && confidence >= if alike { AGREED } else { NAMED } {
            self.model.bank.add(cell, digit, look.clone(), confidence.max(NAMED));
        }
        if (alike || steady) && confidence >= NAMED {
            Verdict::Known { digit, confidence, glyph: usize::MAX }
        } else {
            first
        }
    }

    /// What a cell shows where another cell's glyphs lie between the samples otherwise than its own do.
    fn shifted(&self, gray: &Gray, cut: Cut) -> Option<(u8, f64)> {
        SHIFTS.iter().find_map(|&[right, down]| {
            let moved = Cut { left: cut.left + right * cut.width, top: cut.top + down * cut.height, ..cut };
            match self.model.judge(&Look::cut(gray, moved)) {
                Verdict::Known { digit, confidence, .. } => Some((digit, confidence)),
                _ => None,
            }
        })
    }

    fn reading(&self, verdicts: &[Verdict], gray: &Gray, boxes: &[Cut]) -> Reading {
        let mut confidence = 1.0;
        let mut digits = Vec::with_capacity(verdicts.len());
        for verdict in verdicts {
            if let Verdict::Known { digit, confidence: sure, .. } = *verdict {
                digits.push(digit);
                confidence *= sure;
            }
        }
        if digits.len() < verdicts.len() {
            let faint = verdicts.iter().filter(|&&verdict| verdict == Verdict::Faint).count();
            let gone = digits.is_empty() || 2 * faint > verdicts.len();
            return Reading::Abstained(if gone { Doubt::NotFound } else { Doubt::Unclear });
        }
        let [Some(&first), Some(&last)] = [boxes.first(), boxes.last()] else {
            return Reading::Abstained(Doubt::Unclear);
        };
        let beside = Beside::look(gray, &self.model.cells, [first, last]);
        if !self.regardless && (self.misfit || beside.misfit(&self.format).is_some()) {
            return Reading::Abstained(Doubt::OtherFormat);
        }
        let half = beside.half(&self.format);
        if self.format.has_half() && half.is_none() {
            return Reading::Abstained(Doubt::HalfUnclear);
        }
        match self.format.seconds(&digits, half) {
            Some(shown_s) => Reading::Read { shown_s, confidence },
            None => Reading::Abstained(Doubt::Unclear),
        }
    }
}
