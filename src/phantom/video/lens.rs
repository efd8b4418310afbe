//! A lens: OpenCV's model of distortion, both ways.
//!
//! In: a point as a lens without distortion would show it. Out: where this lens shows it, and back. Coefficients in
//! OpenCV's order k1, k2, p1, p2, k3, k4, k5, k6; the optical axis meets the picture's middle.

use rayon::prelude::*;
use serde::Serialize;

/// A camera's focal length and its lens' coefficients.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Lens {
    /// Focal length; none: as in `1200 / 1280` of the picture's width.
    pub fx_px: Option<f64>,
    /// k1, k2, p1, p2, k3, k4, k5, k6; those left out are 0.
    pub distortion: Vec<f64>,
}

/// A lens before a picture of given size.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mapping {
    /// Focal length.
    pub(super) fx_px: f64,
    coefficients: [f64; 8],
    middle: [f64; 2],
}

impl Mapping {
    pub(super) fn new(lens: &Lens, width: usize, height: usize) -> Self {
        let mut coefficients = [0.0; 8];
        coefficients.iter_mut().zip(&lens.distortion).for_each(|(into, &from)| *into = from);
        Self {
            fx_px: lens.fx_px.unwrap_or(1200.0 / 1280.0 * width as f64),
            coefficients,
            middle: [0.5 * (width as f64 - 1.0), 0.5 * (height as f64 - 1.0)],
        }
    }

    /// Where the lens shows a point.
    pub(super) fn shown(&self, point: [f64; 2]) -> [f64; 2] {
        self.picture(self.bend(self.plane(point)))
    }

    /// The point that the lens shows at `shown`; none where the lens folds the picture there.
    pub(super) fn straight(&self, shown: [f64; 2]) -> Option<[f64; 2]> {
        const STEP: f64 = 1e-6;
        let goal = self.plane(shown);
        let mut at = goal;
        for _ in 0..50 {
            let is = self.bend(at);
            let miss = [goal[0] - is[0], goal[1] - is[1]];
            if miss[0].hypot(miss[1]) < 1e-12 {
                break;
            }
            let [right, below] = [self.bend([at[0] + STEP, at[1]]), self.bend([at[0], at[1] + STEP])];
            let [a, c] = [(right[0] - is[0]) / STEP, (right[1] - is[1]) / STEP];
            let [b, d] = [(below[0] - is[0]) / STEP, (below[1] - is[1]) / STEP];
            let area = a * d - b * c;
            at[0] += (d * miss[0] - b * miss[1]) / area;
            at[1] += (a * miss[1] - c * miss[0]) / area;
        }
        let is = self.bend(at);
        let near = (is[0] - goal[0]).hypot(is[1] - goal[1]) <= 1e-7;
        // Beyond the fold, the picture runs backwards.
        let outwards = self.bend([at[0] * 1.001, at[1] * 1.001]);
        let grows = outwards[0].hypot(outwards[1]) >= is[0].hypot(is[1]);
        (near && grows).then(|| self.picture(at))
    }

    /// What to add to the place of each pixel of the shown picture to get the point that is shown there, row after row.
    pub(super) fn straighten(&self, width: usize, height: usize) -> Vec<[f32; 2]> {
        let step = |k: usize| {
            let shown = [(k % width) as f64, (k / width) as f64];
            // The check of the options has seen that the corners can be undone.
            let [x, y] = self.straight(shown).unwrap_or([f64::INFINITY; 2]);
            [(x - shown[0]) as f32, (y - shown[1]) as f32]
        };
        (0..width * height).into_par_iter().map(step).collect()
    }

    fn plane(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.middle[0]) / self.fx_px, (y - self.middle[1]) / self.fx_px]
    }

    fn picture(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x * self.fx_px + self.middle[0], y * self.fx_px + self.middle[1]]
    }

    fn bend(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [k1, k2, p1, p2, k3, k4, k5, k6] = self.coefficients;
        let r2 = x * x + y * y;
        let radial = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)));
        [
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        ]
    }
}

/// The least and greatest of these steps in each row: to the right, down.
pub(super) fn row_moves(moves: &[[f32; 2]], width: usize) -> Vec<[[f64; 2]; 2]> {
    let range = |row: &[[f32; 2]], axis: usize| {
        let steps = row.iter().map(|step| f64::from(step[axis]));
        steps.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], step| [low.min(step), high.max(step)])
    };
    moves.chunks_exact(width).map(|row| [range(row, 0), range(row, 1)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_undoes_shown() {
        let lens = Lens { fx_px: None, distortion: vec![-0.25, 0.08, 0.001, -0.002, 0.01] };
        let mapping = Mapping::new(&lens, 1280, 720);
        for point in [[0.0, 0.0], [1279.0, 10.0], [640.0, 360.0], [300.0, 700.0]] {
            let back = mapping.shown(mapping.straight(point).unwrap());
            assert!((back[0] - point[0]).hypot(back[1] - point[1]) < 1e-6);
        }
    }

    #[test]
    fn a_lens_that_folds_the_picture_shows_nothing_there() {
        let lens = Lens { fx_px: Some(300.0), distortion: vec![-0.5] };
        assert_eq!(Mapping::new(&lens, 1280, 720).straight([0.0, 0.0]), None);
    }
}
