//! The fingertip's silhouette around the nail: nearly straight sides and a rounded tip.

/// The fingertip's form, in half nail widths from the middle of the nail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingerShape {
    /// Half width of the finger where its tip begins to round.
    pub half_width: f64,
    /// From the hyponychium to the end of the fingertip.
    pub tip: f64,
    /// How much the finger widens towards the palm, relative per half nail width.
    pub widening: f64,
    /// How much blunter than an ellipse the tip is, 0 to 0.5: the share of the fourth power across beside the square.
    pub blunt: f64,
    /// How far to the right of the nail the finger's middle lies.
    pub offset: f64,
}

/// Beyond this many half widths, only that it is far from the finger is known: the distance there is over [`FAR_EDGE`]
/// for every finger.
const FAR: f64 = 1.9;

/// The distance given there, in half nail widths; beyond every shadow.
const FAR_EDGE: f64 = 0.8;

/// Where a place lies with respect to the finger.
#[derive(Debug, Clone, Copy)]
pub(super) struct FingerPlace {
    /// Distance to the silhouette in half nail widths, negative inside.
    pub(super) edge: f64,
    /// 0 on the finger's ridge, 1 at the silhouette.
    pub(super) slope: f64,
    /// Across the finger, -1..1 at its sides.
    pub(super) x: f64,
}

impl FingerShape {
    /// Where (`across`, `along`) lies; the nail is `aspect` half widths long on either side of its middle.
    pub(super) fn place(&self, across: f64, along: f64, aspect: f64) -> FingerPlace {
        let end = aspect + self.tip;
        let begin = end - 1.25 * self.half_width;
        let below = (begin - along).max(0.0);
        // The widening sets in smoothly where the tip ends.
        let half = self.half_width * (1.0 + self.widening * below * below / (below + 0.5));
        let x = (across - self.offset) / half;
        let y = ((along - begin) / (end - begin)).max(0.0);
        if x.abs() > FAR || y > FAR {
            return FingerPlace { edge: FAR_EDGE, slope: FAR, x };
        }
        let x2 = x * x;
        let level = x2 * (1.0 - self.blunt + self.blunt * x2) + y * y;
        let slope = [2.0 * x * (1.0 - self.blunt + 2.0 * self.blunt * x2) / half, 2.0 * y / (end - begin)];
        let gradient = (slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
        let edge = 2.0 * (level - level.sqrt()) / gradient.max(1e-9);
        FingerPlace { edge, slope: level, x }
    }
}
