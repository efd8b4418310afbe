//! Boxes on a picture of ink that may hold its one digit.

use super::grey::{FULL, Grey};
use crate::vision::{Neighbours, Part, Parts, parts};

/// Shares of the full contrast from which a sample is ink.
const THRESHOLDS: [f32; 3] = [0.5, 0.38, 0.62];
/// Smaller ink is dirt, as a share of the picture's area.
const DIRT: f32 = 0.002;
/// A digit is at least so tall, as a share of the picture's height.
const TALL: f32 = 0.35;
/// A digit's box is at least so wide, as a share of its height.
const NARROW: f32 = 0.16;
/// Nearer than this to a side, ink counts as being at the border; as a share of the picture.
const NEAR: f32 = 0.03;
/// A frame takes so much of a side and is no broader than this; a sliver is finer than any stroke; shares of the
/// picture.
const LONG: f32 = 0.8;
const THIN: f32 = 0.16;
const SLIVER: f32 = 0.06;
/// Pieces nearer than this hang together, as a share of the picture.
const GAP: f32 = 0.12;
/// The gap of a display's `1` holds at most this share of its other rows' ink.
const GAP_DEEP: f32 = 0.8;
/// Ink from this share of the full contrast on must lie in the digit's box, but for this share of it.
const FAINT: f32 = 0.3;
const LEFT_OUT: f32 = 0.06;

/// One connected piece of ink: left, top, right, bottom (samples, inclusive).
struct Piece {
    extent: [usize; 4],
    /// How many samples it has, and the label that they have.
    area: usize,
    label: i32,
}

/// The box around two boxes.
fn around(a: [usize; 4], b: [usize; 4]) -> [usize; 4] {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]
}

impl Grey {
    /// Boxes that may hold the digit: all ink but frames, without slivers at the border, or what hangs together; as
    /// long as next to no ink is left outside.
    pub(super) fn boxes(&self) -> Vec<[usize; 4]> {
        let mut found: Vec<[usize; 4]> = Vec::new();
        let (mut faint, labels) = self.pieces(FAINT * FULL);
        faint.retain(|piece| !self.is_frame(piece) && !self.is_sliver(piece));
        let is_faint = |label: i32| faint.iter().any(|piece| piece.label == label);
        let ink = labels.iter().zip(&self.values).map(|(&label, &value)| if is_faint(label) { value } else { 0.0 });
        let ink: Vec<f32> = ink.collect();
        for threshold in THRESHOLDS {
            let (mut pieces, _) = self.pieces(threshold * FULL);
            pieces.retain(|piece| !self.is_frame(piece));
            let all = || pieces.iter().map(|piece| piece.extent);
            let clear = pieces.iter().filter(|piece| !self.is_sliver(piece)).map(|piece| piece.extent);
            for extent in [all().reduce(around), clear.reduce(around), self.cluster(&pieces)].into_iter().flatten() {
                let [x0, y0, x1, y1] = extent;
                let (wide, tall) = ((x1 - x0 + 1) as f32, (y1 - y0 + 1) as f32);
                let fits = tall >= TALL * self.height as f32 && wide >= NARROW * tall && !self.is_strip(extent);
                if fits && !found.contains(&extent) && self.left_out(&ink, extent) <= LEFT_OUT {
                    found.push(extent);
                }
            }
        }
        found
    }

    /// The share of ink that lies outside of a box, a sample's breadth around it aside.
    fn left_out(&self, ink: &[f32], [x0, y0, x1, y1]: [usize; 4]) -> f32 {
        let is_outside = |k: usize| {
            let (x, y) = (k % self.width, k / self.width);
            x + 1 < x0 || x > x1 + 1 || y + 1 < y0 || y > y1 + 1
        };
        let outside: f32 = ink.iter().enumerate().filter(|(k, _)| is_outside(*k)).map(|(_, value)| value).sum();
        outside / ink.iter().sum::<f32>().max(1.0)
    }

    /// The box around the largest piece and all that are near it, or near those.
    fn cluster(&self, pieces: &[Piece]) -> Option<[usize; 4]> {
        let mut extent = pieces.iter().max_by_key(|piece| piece.area)?.extent;
        let gap = (GAP * self.width.min(self.height) as f32) as usize;
        loop {
            let near = |e: &[usize; 4]| {
                e[0] <= extent[2] + gap && e[1] <= extent[3] + gap && extent[0] <= e[2] + gap && extent[1] <= e[3] + gap
            };
            let joined = pieces.iter().map(|piece| piece.extent).filter(near).fold(extent, around);
            if joined == extent {
                return Some(extent);
            }
            extent = joined;
        }
    }

    /// The sides of the picture (left, top, right, bottom) that a piece comes near.
    fn sides(&self, piece: &Piece) -> [bool; 4] {
        let near = (self.width.min(self.height) as f32 * NEAR).ceil() as usize;
        let [x0, y0, x1, y1] = piece.extent;
        [x0 < near, y0 < near, x1 + near >= self.width, y1 + near >= self.height]
    }

    /// Whether a piece is a display's frame or its shadow: a line along most of a side, or around a corner, much longer
    /// than broad.
    fn is_frame(&self, piece: &Piece) -> bool {
        let [x0, y0, x1, y1] = piece.extent;
        let (w, h) = ((x1 - x0 + 1) as f32, (y1 - y0 + 1) as f32);
        let (wide, tall) = (w / self.width as f32, h / self.height as f32);
        let [left, top, right, bottom] = self.sides(piece);
        let fill = piece.area as f32 / (w * h);
        let along = (left || right) && tall >= LONG && wide <= THIN || (top || bottom) && wide >= LONG && tall <= THIN;
        let corner = (left || right) && (top || bottom) && fill <= 0.2;
        let through = left && right && tall <= 0.3 || top && bottom && (left || right);
        along || corner || through
    }

    /// Whether a narrow box at the left or right border is one solid strip: what is beside a display, or a `1` that
    /// can't be distinguished from it. A display's `1` has a gap in its middle.
    fn is_strip(&self, [x0, y0, x1, y1]: [usize; 4]) -> bool {
        let (wide, tall) = (x1 - x0 + 1, y1 - y0 + 1);
        if 2 * wide > tall || (x0 > 1 && x1 + 2 < self.width) {
            return false;
        }
        let mut rows: Vec<f32> =
            (y0 + tall / 3..y1 - tall / 3).map(|y| (x0..=x1).map(|x| self.values[y * self.width + x]).sum()).collect();
        rows.sort_by(f32::total_cmp);
        rows.first().is_none_or(|least| *least > GAP_DEEP * rows[rows.len() / 2])
    }

    /// Whether a piece lies along the border and is too thin for a stroke.
    fn is_sliver(&self, piece: &Piece) -> bool {
        let [x0, y0, x1, y1] = piece.extent;
        let thin = ((x1 - x0).min(y1 - y0) + 1) as f32 <= SLIVER * self.width.min(self.height) as f32;
        thin && self.sides(piece).contains(&true)
    }

    /// Connected pieces of ink over a threshold, without dirt, and the label of each sample.
    fn pieces(&self, threshold: f32) -> (Vec<Piece>, Vec<i32>) {
        let ink: Vec<u8> = self.values.iter().map(|&value| u8::from(value >= threshold)).collect();
        let Parts { all, labels } = parts(&ink, [self.width, self.height], Neighbours::Eight);
        let least = DIRT * (self.width * self.height) as f32;
        let piece = |(part, label): (&Part, i32)| {
            let extent = [part.left, part.top, part.right, part.bottom];
            (part.area as f32 >= least).then_some(Piece { extent, area: part.area, label })
        };
        (all.iter().zip(1..).filter_map(piece).collect(), labels)
    }
}
