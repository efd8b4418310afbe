//! The clock's own glyphs, and what a look is when held against them.
//!
//! In: looks whose digit is known. Out: for another look the digit whose glyph it is, or doubt: it is like none of
//! them, or it lies between two of them, as it does when the digit changes during the exposure. A look between the
//! glyphs `a` and `b` is `s = alpha a + beta b`; the share of `b` is `beta / (alpha + beta)`, by least squares,
//! whatever the gain.

use super::look::{CELLS, Look, dot};

/// A glyph of the clock.
#[derive(Debug, Clone)]
struct Glyph {
    cell: usize,
    digit: u8,
    look: Look,
    /// How many looks it is the mean of, at most [`MOST_SEEN`].
    seen: f32,
    /// How probably it is that digit.
    sure: f64,
}

/// What a look is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::clock) enum Verdict {
    /// A digit.
    Known { digit: u8, confidence: f64, glyph: usize },
    /// Most like this digit, yet not its glyph.
    Likely(u8),
    /// Between two digits.
    Between,
    /// Like no glyph so far.
    Strange,
    /// Hardly any contrast.
    Faint,
}

/// All glyphs so far.
#[derive(Debug, Clone, Default)]
pub(in crate::clock) struct Bank {
    glyphs: Vec<Glyph>,
}

/// A glyph is the mean of the last so many looks, as a sliding one.
const MOST_SEEN: f32 = 30.0;
/// A clock of 24 cells has no more glyphs than this that are worth keeping.
const MOST_GLYPHS: usize = 320;
/// A look this near to a glyph ([`Look::distance`]) is that glyph. Seven-segment digits that differ in one segment are
/// 0.42 apart, others 0.69, and the same digit in another cell up to 0.24 where it is 50 pixels high and 0.37 where 13.
const NEAR: f32 = 0.16;
/// A look this near to a glyph is that glyph where all ten digits are known.
const NEAR_OF_ALL: f32 = 0.25;
/// A look this near to a glyph may be that digit.
const LIKELY: f32 = 0.45;
/// And nearer by this to it than to another digit's.
const LEAD: f32 = 0.12;
/// A second digit's share from which on it is not sure any more which one is shown.
const BLENDED: f32 = 0.3;

impl Bank {
    pub(in crate::clock) fn is_empty(&self) -> bool {
        self.glyphs.is_empty()
    }

    /// The glyphs' digits that a cell has shown. Glyphs of two digits that look the same contradict each other, and
    /// none of them is kept.
    pub(in crate::clock) fn add(&mut self, cell: usize, digit: u8, look: Look, sure: f64) {
        let before = self.glyphs.len();
        self.glyphs.retain(|glyph| glyph.digit == digit || glyph.look.distance(&look) > NEAR);
        if self.glyphs.len() < before {
            return;
        }
        if self.glyphs.len() < MOST_GLYPHS {
            self.glyphs.push(Glyph { cell, digit, look, seen: 1.0, sure });
        }
    }

    pub(in crate::clock) fn judge(&self, look: &Look) -> Verdict {
        let mut nearest: [Option<(f32, usize)>; 10] = [None; 10];
        for (k, glyph) in self.glyphs.iter().enumerate() {
            let distance = look.distance(&glyph.look);
            let slot = &mut nearest[usize::from(glyph.digit)];
            if slot.is_none_or(|(least, _)| distance < least) {
                *slot = Some((distance, k));
            }
        }
        let Some((distance, best)) = nearest.iter().flatten().copied().min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return Verdict::Strange;
        };
        let own = &self.glyphs[best];
        let mut most = 0.0f32;
        for (_, other) in nearest.iter().flatten().filter(|(_, k)| *k != best) {
            most = most.max(share(look, &own.look, &self.glyphs[*other].look));
        }
        let all = nearest.iter().all(Option::is_some);
        let second =
            nearest.iter().flatten().filter(|(_, k)| *k != best).map(|(d, _)| *d).fold(f32::INFINITY, f32::min);
        if distance > LIKELY {
            Verdict::Strange
        } else if most > BLENDED {
            Verdict::Between
        } else if distance <= if all { NEAR_OF_ALL } else { NEAR } {
            // As sure as the glyph, less what leans to another digit.
            let leaning = f64::from((most / BLENDED).clamp(0.0, 1.0).powi(4));
            Verdict::Known { digit: own.digit, confidence: own.sure * (1.0 - 0.05 * leaning), glyph: best }
        } else if second - distance >= LEAD {
            Verdict::Likely(own.digit)
        } else {
            Verdict::Strange
        }
    }

    /// Takes a look that is this glyph into its mean.
    pub(in crate::clock) fn refine(&mut self, glyph: usize, look: &Look) {
        let glyph = &mut self.glyphs[glyph];
        let share = 1.0 / (glyph.seen + 1.0);
        let mut values = [0.0; CELLS];
        for ((value, old), new) in values.iter_mut().zip(&glyph.look.values).zip(&look.values) {
            *value = old + share * (new - old);
        }
        glyph.look = Look::of(values);
        glyph.seen = (glyph.seen + 1.0).min(MOST_SEEN);
    }

    pub(in crate::clock) fn cell(&self, glyph: usize) -> usize {
        self.glyphs[glyph].cell
    }
}

/// The share of `b` in a look that is made of `a` and `b`.
fn share(look: &Look, a: &Look, b: &Look) -> f32 {
    let (aa, bb, ab) = (a.norm * a.norm, b.norm * b.norm, dot(&a.values, &b.values));
    let (sa, sb) = (dot(&look.values, &a.values), dot(&look.values, &b.values));
    let alpha = sa * bb - sb * ab;
    let beta = sb * aa - sa * ab;
    // Both are the least squares' answers times the same positive determinant.
    if alpha + beta > 0.0 { beta / (alpha + beta) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ink in some of four bars.
    fn look(bars: [f32; 4], gain: f32, offset: f32) -> Look {
        Look::of(std::array::from_fn(|k| offset + gain * bars[4 * k / CELLS]))
    }

    #[test]
    fn glyphs_are_known_at_any_gain_and_blends_by_their_share() {
        let mut bank = Bank::default();
        assert_eq!(bank.judge(&look([1.0, 0.0, 0.0, 1.0], 90.0, 10.0)), Verdict::Strange);
        bank.add(0, 3, look([1.0, 0.0, 0.0, 1.0], 100.0, 20.0), 0.99);
        bank.add(0, 4, look([1.0, 1.0, 0.0, 1.0], 100.0, 20.0), 0.98);
        let judge = |share: f32| bank.judge(&look([1.0, share, 0.0, 1.0], 80.0, 60.0));
        assert!(matches!(judge(0.0), Verdict::Known { digit: 3, glyph: 0, .. }));
        assert!(matches!(judge(1.0), Verdict::Known { digit: 4, glyph: 1, .. }));
        assert_eq!(judge(0.5), Verdict::Between);
        assert_eq!(judge(0.4), Verdict::Between);
        assert_eq!(bank.judge(&look([0.0, 0.0, 1.0, 0.0], 80.0, 60.0)), Verdict::Strange);
    }

    #[test]
    fn glyphs_that_contradict_each_other_are_not_kept() {
        let mut bank = Bank::default();
        bank.add(0, 3, look([1.0, 0.0, 0.0, 1.0], 100.0, 20.0), 0.99);
        bank.add(0, 4, look([1.0, 1.0, 0.0, 1.0], 100.0, 20.0), 0.98);
        bank.add(1, 2, look([1.0, 0.0, 0.0, 1.0], 90.0, 30.0), 0.99);
        assert!(!matches!(bank.judge(&look([1.0, 0.0, 0.0, 1.0], 80.0, 60.0)), Verdict::Known { .. }));
        assert!(matches!(bank.judge(&look([1.0, 1.0, 0.0, 1.0], 80.0, 60.0)), Verdict::Known { digit: 4, .. }));
    }
}
