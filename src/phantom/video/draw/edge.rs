//! Edges as the optics show them, and which pixels of a row a thing can reach.

use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Edges end after so many standard deviations of the focus.
pub(in crate::phantom::video) const EDGE: f64 = 5.0;

/// The share of light of a straight edge's inner side at a distance, in standard deviations, from it (negative inside).
pub(in crate::phantom::video) fn soft(distance: f64) -> f32 {
    const STEPS: usize = 4096;
    static TABLE: LazyLock<Vec<f32>> = LazyLock::new(|| {
        let step = 2.0 * EDGE / STEPS as f64;
        let mut above = 0.0;
        let mut shares: Vec<f32> = Vec::with_capacity(STEPS + 2);
        shares.push(0.0);
        for k in 0..=STEPS {
            let x: f64 = -EDGE + (k as f64 + 0.5) * step;
            above += step * (-0.5 * x * x).exp() / TAU.sqrt();
            shares.push(above.min(1.0) as f32);
        }
        shares
    });
    let at = ((EDGE - distance) / (2.0 * EDGE) * STEPS as f64).clamp(0.0, STEPS as f64);
    let (low, part) = (at as usize, at.fract() as f32);
    TABLE[low] + part * (TABLE[low + 1] - TABLE[low])
}

/// The columns of row `y`, first and last, within reach of a line (from, to, reach) in a picture so wide; `moves` are
/// the least and greatest steps that undo the lens in this row, to the right and down.
pub(in crate::phantom::video) fn columns(
    ([x0, y0], [x1, y1], reach): ([f64; 2], [f64; 2], f64),
    y: usize,
    width: usize,
    [[left, right], [up, down]]: [[f64; 2]; 2],
) -> Option<[usize; 2]> {
    let (top, bottom) = (y as f64 + up - reach, y as f64 + down + reach);
    // The part of the line whose rows are within reach of this one.
    let (low, high) = if (y1 - y0).abs() < 1e-9 {
        if !(top..=bottom).contains(&y0) {
            return None;
        }
        (0.0, 1.0)
    } else {
        let (a, b) = ((top - y0) / (y1 - y0), (bottom - y0) / (y1 - y0));
        (a.min(b).max(0.0), a.max(b).min(1.0))
    };
    let (a, b) = (x0 + low * (x1 - x0), x0 + high * (x1 - x0));
    let (first, last) = (a.min(b) - reach - right, a.max(b) + reach - left);
    (low <= high && last >= 0.0 && first < width as f64)
        .then(|| [first.max(0.0) as usize, (last as usize).min(width - 1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_soft_discs_centroid_is_exact() {
        // Measured: 0.0011 at 3.94 px, 0.0005 at 10.5.
        const NEAR_PX: f64 = 0.002;
        for radius in [3.94, 10.5] {
            for k in 0..50 {
                let centre = [20.0 + 0.137 * f64::from(k) % 1.0, 20.0 + 0.331 * f64::from(k) % 1.0];
                let (mut weight, mut sum) = (0.0, [0.0; 2]);
                for (x, y) in (0..41).flat_map(|x| (0..41).map(move |y| (f64::from(x), f64::from(y)))) {
                    let share = f64::from(soft(((x - centre[0]).hypot(y - centre[1]) - radius) / 0.55));
                    weight += share;
                    sum[0] += share * x;
                    sum[1] += share * y;
                }
                let miss = (sum[0] / weight - centre[0]).hypot(sum[1] / weight - centre[1]);
                assert!(miss <= NEAR_PX, "{radius} {miss}");
            }
        }
    }

    #[test]
    fn no_pixel_within_reach_of_a_line_is_left_out() {
        let mut within = 0;
        for k in 0..40 {
            let k = f64::from(k);
            let (from, to) =
                ([40.0 * (k * 0.7).sin(), 30.0 * k.cos()], [60.0 - 3.0 * k, 20.0 + 25.0 * (2.0 * k).sin()]);
            let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
            for y in 0..40 {
                let found = columns((from, to, 7.0), y, 50, [[0.0; 2]; 2]);
                for x in 0..50 {
                    let (px, py) = (x as f64 - from[0], y as f64 - from[1]);
                    let along = ((px * dx + py * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
                    if (px - along * dx).hypot(py - along * dy) <= 7.0 {
                        within += 1;
                        assert!(found.is_some_and(|[first, last]| (first..=last).contains(&x)), "{k} {x} {y}");
                    }
                }
            }
        }
        assert!(within > 10_000);
    }
}
