//! What detection had in hand and refused: no nails of a result, but what a person who misses one should see.

use super::Outline;

/// A place that looked like a nail and was refused.
#[derive(Debug, Clone, PartialEq)]
pub struct Refused {
    /// As it was found, photograph pixels.
    pub outline: Outline,
    /// Why it was refused.
    pub why: Refusal,
}

/// Why a place was refused.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refusal {
    /// Its confidence is less than that of a doubtful find.
    Unsure(f64),
    /// A surer find lies over it, another one than itself; its own confidence.
    Overlapped(f64),
    /// A nail of this probability on one look at the photograph, and none on the closer one.
    NotSeenAgain(f64),
}

/// What refused places have at least to be shown (assumed): a confidence of this part of a doubtful find's least, or of
/// all of it under another find; a probability on the one look. By the network on 66 real photographs these are 62
/// places; seen once with any probability are 181.
const UNSURE_SHOWS: f64 = 1.0 / 6.0;
const NOT_SEEN_AGAIN_SHOWS: f64 = 0.8;
/// Overlap with a surer find from which it is the same one, seen twice.
const SAME_FIND: f64 = 0.5;

impl Refused {
    /// Whether it helps a person to see it beside the finds that were `kept`, the least confidence of which is
    /// `doubtful`.
    pub(super) fn is_shown<'a>(&self, doubtful: f64, mut kept: impl Iterator<Item = &'a Outline>) -> bool {
        let sure = match self.why {
            Refusal::Unsure(confidence) => confidence >= UNSURE_SHOWS * doubtful,
            Refusal::Overlapped(confidence) => confidence >= doubtful,
            Refusal::NotSeenAgain(probability) => probability >= NOT_SEEN_AGAIN_SHOWS,
        };
        sure && !kept.any(|other| other.iou(&self.outline) >= SAME_FIND)
    }
}
