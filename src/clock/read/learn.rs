//! A clock's cells and glyphs out of the first crops.
//!
//! In: crops of about a second. Out: [`Model`], which reads crops. Each crop's ink is split at several thresholds and
//! in both polarities; where runs of ink can be the format's characters, the network has to agree. What stands at one
//! place in most crops is the clock. A cell's glyphs are what it shows in at least two frames one after the other, so
//! that no glyph is a blend of two digits; they get their names from the network, by all that was seen of each.

use crate::clock::beside::{Beside, Misfit};
use crate::clock::cell::bank::{Bank, Verdict};
use crate::clock::cell::cells::Cells;
use crate::clock::cell::judge::Page;
use crate::clock::cell::look::{CELLS, Cut, Look};
use crate::clock::cell::names::{self, NAMED, Stand, Steady, UNLIKELIEST, places};
use crate::clock::format::ClockFormat;
use crate::clock::glyph::Levels;
use crate::clock::ink::crop::Gray;
use crate::clock::ink::line::{Row, lines, rows};
use crate::clock::ink::pieces::{pieces, split};
use crate::median::median_of;

/// What is known of a clock.
#[derive(Debug, Clone)]
pub(super) struct Model {
    pub(super) cells: Cells,
    pub(super) bank: Bank,
    /// The usual length of a look.
    pub(super) contrast: f32,
    /// How far one look is from the next of the same digit.
    pub(super) noise: f32,
}

/// What crops show.
#[derive(Debug, Clone, Default)]
pub(super) struct Learnt {
    /// The clock, if there is one.
    pub(super) model: Option<Model>,
    /// What stands beside its digits that the format does not have.
    pub(super) misfit: Option<Misfit>,
}

struct RowInCrop {
    crop: usize,
    /// Which threshold, and whether ink is lighter.
    way: (usize, bool),
    row: Row,
    levels: Levels,
}

const SEARCHED: usize = 11;
/// Every third of them first; its multiples hit each of a number of crops that it does not divide.
const TURNS: usize = 3;
/// A place that shows no row in so many crops shows none.
const GIVEN_UP: usize = 4;
/// So many crops of a place are shown to the network.
const JUDGED: usize = 4;
/// The mean (geometric) probability of the likeliest digits from which on a row is taken for the clock's.
const LIKELY: f64 = 0.5;

/// A format does not fit where more stands beside its digits in this share of the crops.
const MISFITS: f64 = 0.4;
/// Looks of a digit differ by so much from frame to frame at least, noise or none.
const LEAST_NOISE: f32 = 0.04;
/// And looks of different digits by more than that.
const MOST_NOISE: f32 = 0.12;
/// Where cells that stay are read in a smaller share of the crops, digits may move.
const MOVING: f64 = 0.5;
/// Looks within so many times the noise are of one digit.
pub(super) const SAME: f32 = 3.0;
/// And means of looks of one digit, where there is little noise left, are no further apart than this: seven-segment
/// digits that differ in one segment are 0.42 apart.
const MOST_APART: f32 = 0.25;
/// A look shorter than this share of the usual one is of no digit.
pub(super) const FAINT: f32 = 0.4;

impl Model {
    /// The clock that these crops show, if they do; one that the format fits before others.
    pub(super) fn learn(crops: &[Gray], times_s: &[f64], format: &ClockFormat) -> Learnt {
        let found = search(crops, format);
        let mut chosen: Option<(Cells, Option<Misfit>)> = None;
        for place in likely_places(crops, &found, format) {
            let seen: Vec<&Row> = place.iter().map(|found| &found.row).collect();
            let middle = &place[place.len() / 2];
            let Some(cells) = Cells::around(&seen, format, middle.levels) else { continue };
            let misfit = misfit(crops, &place, &cells, format);
            let fits = misfit.is_none();
            if fits || chosen.is_none() {
                chosen = Some((cells, misfit));
            }
            if fits {
                break;
            }
        }
        let Some((still, misfit)) = chosen else { return Learnt::default() };
        Learnt { model: Self::of(still, crops, times_s, format), misfit }
    }

    /// The better one of cells that stay and cells that move.
    fn of(still: Cells, crops: &[Gray], times_s: &[f64], format: &ClockFormat) -> Option<Self> {
        let (model, read) = Self::with(still.clone(), crops, times_s, format)?;
        if read >= MOVING * crops.len() as f64 {
            return Some(model);
        }
        match Self::with(still.moving(), crops, times_s, format) {
            Some((other, more)) if more > read => Some(other),
            _ => Some(model),
        }
        .filter(|model| !model.bank.is_empty())
    }

    /// What is learnt with these cells, and in how many crops every digit is known then.
    fn with(cells: Cells, crops: &[Gray], times_s: &[f64], format: &ClockFormat) -> Option<(Self, f64)> {
        let blank = || vec![Look::of([0.0; CELLS]); format.digits()];
        let boxes: Vec<Option<Vec<Cut>>> = crops.iter().map(|crop| cells.boxes(crop, format)).collect();
        let look = |(crop, boxes): (&Gray, &Option<Vec<Cut>>)| {
            boxes.as_ref().map_or_else(blank, |boxes| boxes.iter().map(|&cut| Look::cut(crop, cut)).collect())
        };
        let looks: Vec<Vec<Look>> = crops.iter().zip(&boxes).map(look).collect();
        let contrast = median_of(looks.iter().flatten().map(|look| look.norm).filter(|&norm| norm > 0.0))?;
        let noise = noise(&looks).clamp(LEAST_NOISE, MOST_NOISE);
        let mut model = Self { cells, bank: Bank::default(), contrast, noise };
        model.name_glyphs(crops, times_s, (&boxes, &looks), format);
        let known = |look: &Look| matches!(model.judge(look), Verdict::Known { .. });
        let read = looks.iter().filter(|looks| looks.iter().all(known)).count();
        Some((model, read as f64))
    }

    /// Finds what the cells show steadily and names it.
    fn name_glyphs(
        &mut self,
        crops: &[Gray],
        times_s: &[f64],
        (all, looks): (&[Option<Vec<Cut>>], &[Vec<Look>]),
        format: &ClockFormat,
    ) {
        for (cell, place) in places(format).into_iter().enumerate() {
            let mut steady: Vec<Steady> = Vec::new();
            let mut start = 0;
            for end in 1..=looks.len() {
                let goes_on = end < looks.len()
                    && self.is_same(&looks[end][cell], &looks[end - 1][cell])
                    && self.is_same(&looks[end][cell], &looks[start][cell]);
                if goes_on {
                    continue;
                }
                if end - start >= 2
                    && looks[start][cell].norm > FAINT * self.contrast
                    && let Some(boxes) = &all[start]
                {
                    // A box that moves is the first crop's; those of cells that stay are all alike.
                    let stays = (start..end).all(|k| all[k].as_ref().is_some_and(|other| other[cell] == boxes[cell]));
                    let mean = if stays { mean(&crops[start..end]) } else { crops[start].clone() };
                    let look = Look::cut(&mean, boxes[cell]);
                    let ink = self.cells.ink(&mean, boxes[cell]);
                    let scores = ink.map(|ink| Page::new(&mean).judge(ink, self.cells.levels));
                    if let Some(scores) = scores {
                        let log_digits = scores.digits.map(|digit| digit.max(UNLIKELIEST).ln());
                        let stand = Stand { middle_s: 0.5 * (times_s[start] + times_s[end - 1]), log_digits };
                        let one = Steady { look, stands: vec![stand] };
                        match steady.iter().position(|known| self.is_one(known, &one)) {
                            Some(k) => steady[k].stands.extend(one.stands),
                            None => steady.push(one),
                        }
                    }
                }
                start = end;
            }
            let names = names::by_order(&steady, place).unwrap_or_else(|| names::one_by_one(&steady, place));
            for (steady, name) in steady.into_iter().zip(names) {
                if let Some((digit, sure)) = name {
                    self.bank.add(cell, digit, steady.look, sure);
                }
            }
        }
    }

    /// Whether two looks that stood are of one digit: the nearer ones, unless the network is sure that they are not.
    fn is_one(&self, a: &Steady, b: &Steady) -> bool {
        let sure = |one: &Steady| names::network(one).filter(|(_, sure)| *sure >= NAMED).map(|(digit, _)| digit);
        let differ = sure(a).zip(sure(b)).is_some_and(|(a, b)| a != b);
        a.look.distance(&b.look) <= (SAME * self.noise).min(MOST_APART) && !differ
    }

    pub(super) fn is_same(&self, a: &Look, b: &Look) -> bool {
        a.distance(b) <= SAME * self.noise
    }

    /// What a cell shows.
    pub(super) fn judge(&self, look: &Look) -> Verdict {
        if look.norm < FAINT * self.contrast { Verdict::Faint } else { self.bank.judge(look) }
    }
}

/// Rows of characters in crops spread evenly; none where the first ones show none.
fn search(crops: &[Gray], format: &ClockFormat) -> Vec<RowInCrop> {
    let count = crops.len().min(SEARCHED);
    let mut found = Vec::new();
    for k in 0..count {
        // In an order in which the first few are spread as well.
        let crop = (k * TURNS % count) * crops.len() / count;
        if k == GIVEN_UP && found.is_empty() {
            break;
        }
        search_one(crop, &crops[crop], format, k >= GIVEN_UP, &mut found);
    }
    found.sort_by_key(|one| one.crop);
    found
}

/// One crop's rows; with `known`, only at the thresholds and in the polarities that showed some before.
fn search_one(crop: usize, gray: &Gray, format: &ClockFormat, known: bool, found: &mut Vec<RowInCrop>) {
    let Some(whole) = split(&gray.values) else { return };
    let side = |light: bool| -> Vec<f32> {
        gray.values.iter().copied().filter(|&value| (value > whole.threshold) == light).collect()
    };
    let splits = [Some(whole), split(&side(false)), split(&side(true))];
    for (which, split) in splits.into_iter().enumerate().filter_map(|(which, split)| Some((which, split?))) {
        for light in [true, false] {
            let way = (which, light);
            if known && found.iter().all(|one| one.way != way) {
                continue;
            }
            for line in lines(&pieces(gray, split.threshold, light)) {
                let levels = if light { [split.dark, split.light] } else { [split.light, split.dark] };
                let levels = Levels { background: levels[0], ink: levels[1] };
                found.extend(rows(&line, format).into_iter().map(|row| RowInCrop { crop, way, row, levels }));
            }
        }
    }
}

/// The rows at each place that may show the format, the place first that does most often and most probably.
fn likely_places<'a>(crops: &[Gray], found: &'a [RowInCrop], format: &ClockFormat) -> Vec<Vec<&'a RowInCrop>> {
    let mut places: Vec<Vec<&RowInCrop>> = Vec::new();
    for one in found {
        let same = |place: &Vec<&RowInCrop>| {
            let (a, b) = (&place[0], one);
            let slack = 0.3 * a.row.height() as f64;
            let near = |a: usize, b: usize| a.abs_diff(b) as f64 <= slack;
            (a.levels.ink > a.levels.background) == (b.levels.ink > b.levels.background)
                && near(a.row.top, b.row.top)
                && near(a.row.bottom, b.row.bottom)
                && a.row.digits.iter().zip(&b.row.digits).all(|(a, b)| near(a.left + a.right, b.left + b.right))
        };
        match places.iter_mut().find(|place| same(place)) {
            // Of several thresholds the first one counts.
            Some(place) if place.last().is_some_and(|last| last.crop == one.crop) => {}
            Some(place) => place.push(one),
            None => places.push(vec![one]),
        }
    }
    let scored = places.into_iter().map(|place| (likely(crops, &place, format), place));
    let mut scored: Vec<(f64, Vec<&RowInCrop>)> = scored
        .filter(|(likely, _)| *likely >= LIKELY)
        .map(|(likely, place)| (likely * place.len() as f64, place))
        .collect();
    // Stable: of two that are alike the first one stays first.
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    scored.into_iter().map(|(_, place)| place).collect()
}

/// What stands beside the digits of a place and is not in the format: in most of its crops the same.
fn misfit(crops: &[Gray], place: &[&RowInCrop], cells: &Cells, format: &ClockFormat) -> Option<Misfit> {
    let ends = cells.ends()?;
    let look = |found: &&RowInCrop| Beside::look(&crops[found.crop], cells, ends).misfit(format);
    let mut all: Vec<Misfit> = place.iter().filter_map(look).collect();
    let enough = all.len() as f64 >= MISFITS * place.len() as f64;
    all.sort();
    all.chunk_by(|a, b| a == b).max_by_key(|alike| alike.len()).filter(|_| enough).map(|alike| alike[0].clone())
}

/// The geometric mean of the probabilities of the likeliest digits.
fn likely(crops: &[Gray], place: &[&RowInCrop], format: &ClockFormat) -> f64 {
    let highest: Vec<u8> = places(format).iter().map(|place| place.highest).collect();
    let step = place.len().div_ceil(JUDGED).max(1);
    let (mut sum, mut count) = (0.0, 0.0);
    for found in place.iter().step_by(step) {
        let page = Page::new(&crops[found.crop]);
        for (run, &highest) in found.row.digits.iter().zip(&highest) {
            let scores = page.judge(Cut::around(run), found.levels);
            let most = scores.digits[..=usize::from(highest)].iter().copied().fold(0.0, f64::max);
            sum += most.max(1e-3).ln();
            count += 1.0;
        }
    }
    (sum / f64::max(count, 1.0)).exp()
}

/// How far a cell's look is from the next one where its digit stays: most cells do from one frame to the next.
fn noise(looks: &[Vec<Look>]) -> f32 {
    let steps = looks.windows(2).flat_map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| a.distance(b)));
    median_of(steps).unwrap_or(0.0)
}

fn mean(crops: &[Gray]) -> Gray {
    let mut sum = crops[0].clone();
    for crop in &crops[1..] {
        sum.values.iter_mut().zip(&crop.values).for_each(|(sum, value)| *sum += value);
    }
    sum.values.iter_mut().for_each(|value| *value /= crops.len() as f32);
    sum
}
