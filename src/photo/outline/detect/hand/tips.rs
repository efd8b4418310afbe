//! Finger ends on a silhouette: rounded caps whose sides run on in parallel.
//!
//! For a point of the contour and a width `w`, the contour a quarter circle away on either side (arc `pi w / 4`) must
//! be `w` apart with the silhouette between, and stay so a little further down. Every width of a geometric series is
//! tried at every point; the best that do not overlap are kept.

use image::GrayImage;

use super::super::search::best_apart;
use crate::vision::borders;

/// The end of a finger in pixels of the working picture.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Tip {
    /// The foremost point.
    pub(in super::super) apex: [f64; 2],
    /// Unit vector along the finger, outwards.
    pub(in super::super) out: [f64; 2],
    /// Width of the finger.
    pub(in super::super) width: f64,
    /// How well the cap and sides fit, 0 to 1.
    pub(in super::super) fit: f64,
}

/// Narrowest finger that is looked for, working pixels.
const NARROWEST: f64 = 8.0;
/// Ratio of one width to the next.
const RATIO: f64 = 1.15;
/// Worst fit that is kept.
const WORST: f64 = 0.25;

/// The ends on one mask.
pub(in super::super) fn tips(mask: &GrayImage) -> Vec<Tip> {
    let widest = 0.6 * f64::from(mask.width().max(mask.height()));
    let mut found = Vec::new();
    let size = [mask.width(), mask.height()].map(|n| n as usize);
    for border in borders(mask.as_raw(), size) {
        let points: Vec<[f64; 2]> = border.iter().map(|p| p.map(f64::from)).collect();
        if (points.len() as f64) < 3.0 * NARROWEST {
            continue;
        }
        let ring = Ring::new(&points);
        let mut width = NARROWEST;
        while width < widest && 2.6 * width < ring.length() {
            let stride = ((width / 8.0) as usize).max(1);
            for s in (0..ring.points.len()).step_by(stride) {
                found.extend(cap(&ring, mask, s as f64, width).filter(|tip| tip.fit > WORST));
            }
            width *= RATIO;
        }
    }
    found
}

/// Keeps the best of `found` that do not stand for the same end, at most `most`.
pub(in super::super) fn strongest(found: Vec<Tip>, most: usize) -> Vec<Tip> {
    let is_same = |tip: &Tip, kept: &Tip| {
        let turn = kept.out[0] * tip.out[0] + kept.out[1] * tip.out[1];
        let ratio = (kept.width / tip.width).max(tip.width / kept.width);
        apart(kept.apex, tip.apex) < 0.45 * kept.width.min(tip.width) && turn > 0.7 && ratio < 1.35
    };
    best_apart(found, most, |tip| tip.fit, is_same)
}

/// A closed contour resampled at one pixel of arc.
struct Ring {
    points: Vec<[f64; 2]>,
}

impl Ring {
    fn new(corners: &[[f64; 2]]) -> Self {
        // A chain of pixels is smoothed over five steps: stairs would lengthen the arc.
        let n = corners.len();
        let smooth: Vec<[f64; 2]> = (0..n)
            .map(|i| [0, 1].map(|c| (0..5).map(|k| corners[(i + n + k - 2) % n][c]).sum::<f64>() / 5.0))
            .collect();
        let mut points = vec![smooth[0]];
        let mut left = 1.0;
        for i in 0..n {
            let (a, b) = (smooth[i], smooth[(i + 1) % n]);
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            let mut at = left;
            while at <= length {
                let t = at / length;
                points.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
                at += 1.0;
            }
            left = at - length;
        }
        Self { points }
    }

    fn length(&self) -> f64 {
        self.points.len() as f64
    }

    fn at(&self, s: f64) -> [f64; 2] {
        let n = self.points.len() as i64;
        self.points[(s.round() as i64).rem_euclid(n) as usize]
    }
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn middle(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]
}

/// The end of a finger of `width` with its apex at arc `s`, if there is one.
fn cap(ring: &Ring, mask: &GrayImage, s: f64, width: f64) -> Option<Tip> {
    let quarter = std::f64::consts::FRAC_PI_4 * width;
    let apex = ring.at(s);
    let (left, right) = (ring.at(s - quarter), ring.at(s + quarter));
    let at_cap = apart(left, right) / width;
    if !(0.72..1.2).contains(&at_cap) {
        return None;
    }
    let base = middle(left, right);
    let inside = |p: [f64; 2]| {
        let (x, y) = (p[0].round(), p[1].round());
        x >= 0.0
            && y >= 0.0
            && (x as u32) < mask.width()
            && (y as u32) < mask.height()
            && mask.get_pixel(x as u32, y as u32)[0] > 0
    };
    let height = apart(apex, base) / width;
    if !(0.25..0.75).contains(&height) || !inside(base) {
        return None;
    }
    let (left2, right2) = (ring.at(s - quarter - 0.5 * width), ring.at(s + quarter + 0.5 * width));
    let at_side = apart(left2, right2) / width;
    let root = middle(left2, right2);
    let axis = if (0.7..1.45).contains(&at_side) { root } else { base };
    let reach = apart(apex, axis);
    let out = [(apex[0] - axis[0]) / reach, (apex[1] - axis[1]) / reach];
    // The chord across the cap stands square to the axis.
    let chord = [(right[0] - left[0]) / (at_cap * width), (right[1] - left[1]) / (at_cap * width)];
    let skew = (chord[0] * out[0] + chord[1] * out[1]).abs();
    if skew > 0.5 {
        return None;
    }
    let bell = |x: f64, sd: f64| (-(x / sd).powi(2) / 2.0).exp();
    let sides = bell(at_side - 1.03, 0.25).max(0.3);
    let fit = bell(at_cap - 0.96, 0.1) * bell(height - 0.46, 0.12) * sides * bell(skew, 0.25);
    // Ends cut off by the picture's border are the border's corners, not fingers'.
    let edge = |p: [f64; 2]| {
        p[0] < 2.0 || p[1] < 2.0 || p[0] > f64::from(mask.width()) - 3.0 || p[1] > f64::from(mask.height()) - 3.0
    };
    if edge(apex) || (edge(left) && edge(right)) {
        return None;
    }
    Some(Tip { apex, out, width, fit })
}

#[cfg(test)]
mod tests {
    use image::Luma;

    use super::*;

    /// A finger of `width` from the lower border up to `end`, tilted by `turn`.
    fn finger(width: f64, end: [f64; 2], turn: f64) -> GrayImage {
        let (sin, cos) = turn.sin_cos();
        GrayImage::from_fn(200, 200, |x, y| {
            let (dx, dy) = (f64::from(x) - end[0], f64::from(y) - end[1]);
            let (u, v) = (dx * cos + dy * sin, dy * cos - dx * sin - width / 2.0);
            let inside = if v < 0.0 { u.hypot(v) < width / 2.0 } else { u.abs() < width / 2.0 };
            Luma([if inside { 255 } else { 0 }])
        })
    }

    #[test]
    fn the_end_of_a_finger_is_found() {
        for (width, turn) in [(30.0, 0.0), (48.0, 0.3), (22.0, -0.6)] {
            let found = strongest(tips(&finger(width, [100.0, 60.0], turn)), 1);
            let tip = found.first().expect("one end");
            // Measured: 4 % of the width for the apex, 6 % for the width, 0.05 rad.
            assert!((tip.apex[0] - 100.0).hypot(tip.apex[1] - 60.0) <= 0.12 * width, "{tip:?}");
            assert!((tip.width / width - 1.0).abs() <= 0.15, "{tip:?}");
            let expected = [turn.sin(), -turn.cos()];
            assert!(tip.out[0] * expected[0] + tip.out[1] * expected[1] >= 0.97, "{tip:?}");
        }
    }

    #[test]
    fn a_square_and_nothing_have_no_strong_end() {
        assert!(tips(&GrayImage::new(100, 100)).is_empty());
        assert!(tips(&GrayImage::from_pixel(100, 100, Luma([255]))).is_empty());
    }
}
