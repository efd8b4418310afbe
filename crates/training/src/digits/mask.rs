//! Drawn characters, kept as pictures that can be looked at anywhere.

/// Rows of a mask that a digit's height takes.
pub(super) const FINE: f32 = 48.0;

/// The ink of a character or a segment. Units are a digit's height: y from 0 at a digit's top to 1 at its bottom, x
/// from the character's left.
#[derive(Debug, Clone)]
pub(super) struct Mask {
    pub(super) width: usize,
    /// Of its first column and row, units.
    pub(super) left: f32,
    pub(super) top: f32,
    pub(super) ink: Vec<u8>,
    /// Both ends of each row's ink, for tight boxes.
    pub(super) edge: Vec<[f32; 2]>,
}

impl Mask {
    /// A picture so many pixels wide.
    pub(super) fn new(width: usize, [left, top]: [f32; 2], ink: Vec<u8>) -> Self {
        let mut edge = Vec::new();
        for (y, row) in ink.chunks_exact(width.max(1)).enumerate() {
            let inked = |k: &u8| *k > 127;
            if let (Some(first), Some(last)) = (row.iter().position(inked), row.iter().rposition(inked)) {
                for [x, y] in [[first, y], [first, y + 1], [last + 1, y], [last + 1, y + 1]] {
                    edge.push([left + x as f32 / FINE, top + y as f32 / FINE]);
                }
            }
        }
        Self { width, left, top, ink, edge }
    }

    /// Draws what `ink` says, with 3 x 3 looks a pixel, from `left`, `top` on.
    pub(super) fn draw([left, top, right, bottom]: [f32; 4], ink: impl Fn(f32, f32) -> bool) -> Self {
        let (width, height) = (((right - left) * FINE).ceil() as usize, ((bottom - top) * FINE).ceil() as usize);
        let look = |x: usize, y: usize| {
            let hits = (0..9).filter(|k| {
                let (sx, sy) = ((k % 3) as f32 / 3.0 + 1.0 / 6.0, (k / 3) as f32 / 3.0 + 1.0 / 6.0);
                ink(left + (x as f32 + sx) / FINE, top + (y as f32 + sy) / FINE)
            });
            (hits.count() * 255 / 9) as u8
        };
        let ink = (0..width * height).map(|k| look(k % width, k / width)).collect();
        Self::new(width, [left, top], ink)
    }
}

/// All that is drawn of a scene, in the units of its masks, to be looked at anywhere.
pub(super) struct Sheet {
    width: usize,
    height: usize,
    left: f32,
    top: f32,
    ink: Vec<f32>,
}

impl Sheet {
    /// Nothing, from `left`, `top` to `right`, `bottom`.
    pub(super) fn new([left, top, right, bottom]: [f32; 4]) -> Self {
        let (width, height) = (((right - left) * FINE) as usize + 2, ((bottom - top) * FINE) as usize + 2);
        Self { width, height, left, top, ink: vec![0.0; width * height] }
    }

    /// Adds a mask's ink, `x` further right, to the next whole pixel.
    pub(super) fn add(&mut self, mask: &Mask, x: f32, share: f32) {
        let from_left = ((mask.left + x - self.left) * FINE).round() as i64;
        let from_top = ((mask.top - self.top) * FINE).round() as i64;
        let (first, last) = ((-from_left).max(0), (self.width as i64 - from_left).min(mask.width as i64));
        for (y, row) in mask.ink.chunks_exact(mask.width).enumerate() {
            let y = y as i64 + from_top;
            if first >= last || !(0..self.height as i64).contains(&y) {
                continue;
            }
            let at = (y * self.width as i64 + from_left + first) as usize;
            for (sum, ink) in self.ink[at..].iter_mut().zip(&row[first as usize..last as usize]) {
                *sum = (*sum + share / 255.0 * f32::from(*ink)).min(1.0);
            }
        }
    }

    /// Ink at a point, between its pixels.
    pub(super) fn at(&self, x: f32, y: f32) -> f32 {
        let (fx, fy) = ((x - self.left) * FINE - 0.5, (y - self.top) * FINE - 0.5);
        if !(fx >= 0.0 && fy >= 0.0 && fx < (self.width - 1) as f32 && fy < (self.height - 1) as f32) {
            return 0.0;
        }
        let (x0, y0) = (fx as usize, fy as usize);
        let (sx, sy) = (fx - x0 as f32, fy - y0 as f32);
        let k = y0 * self.width + x0;
        let upper = (1.0 - sx) * self.ink[k] + sx * self.ink[k + 1];
        let lower = (1.0 - sx) * self.ink[k + self.width] + sx * self.ink[k + self.width + 1];
        (1.0 - sy) * upper + sy * lower
    }
}

/// The box around points: left, top, right, bottom.
pub(super) fn tight(points: impl Iterator<Item = [f32; 2]>) -> [f32; 4] {
    points.fold([f32::MAX, f32::MAX, f32::MIN, f32::MIN], |b, [x, y]| {
        [b[0].min(x), b[1].min(y), b[2].max(x), b[3].max(y)]
    })
}
