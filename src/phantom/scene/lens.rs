//! A camera before a flat scene: OpenCV's model of the lens, and the perspective of a plane seen obliquely; both ways.
//!
//! In: a point of the scene, as a camera without distortion that looks straight at it would show it. Out: where this
//! camera shows it, and back. Coefficients in OpenCV's order k1, k2, p1, p2, k3, k4, k5, k6. A plane is turned about
//! the optical axis' foot, and moved away as far as it has to be for all of the scene to stay in the picture.

use rayon::prelude::*;
use serde::Serialize;

use crate::median::ends;

/// A camera's focal length and its lens' coefficients; the optical axis meets the picture's middle.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Lens {
    /// Focal length; none: as in `1200 / 1280` of the picture's width.
    pub fx_px: Option<f64>,
    /// k1, k2, p1, p2, k3, k4, k5, k6; those left out are 0.
    pub distortion: Vec<f64>,
}

/// The most that a plane may be turned from the picture, degrees.
pub(in crate::phantom) const MOST_TILT_DEG: f64 = 60.0;

/// A plane that the camera does not look at straight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Oblique {
    /// Between the optical axis and the plane's normal.
    pub tilt_deg: f64,
    /// The direction on the picture in which the plane recedes, clockwise from the right.
    pub towards_deg: f64,
}

impl Oblique {
    /// The plane's axes in the camera's frame (x right, y down, z forward): two in the plane, those of the picture
    /// where it is seen straight, and the third away from the camera.
    #[must_use]
    pub fn axes(self) -> [[f64; 3]; 3] {
        let (sin, cos) = self.tilt_deg.to_radians().sin_cos();
        let (down, right) = self.towards_deg.to_radians().sin_cos();
        // What points to where the plane recedes turns away from the camera, what is across it stays.
        let turned = |[x, y]: [f64; 2]| {
            let (towards, across) = (x * right + y * down, y * right - x * down);
            [towards * cos * right - across * down, towards * cos * down + across * right, towards * sin]
        };
        [turned([1.0, 0.0]), turned([0.0, 1.0]), [-sin * right, -sin * down, cos]]
    }

    /// The plane's normal, of length 1, towards the camera.
    #[must_use]
    pub fn normal(self) -> [f64; 3] {
        self.axes()[2].map(|part| -part)
    }
}

#[derive(Debug, Clone, PartialEq)]
struct Plane {
    axes: [[f64; 3]; 3],
    /// Of the optical axis' foot, in focal lengths of the scene.
    distance: f64,
}

impl Plane {
    /// Such that a scene of these half sides, in focal lengths, stays within them.
    fn new(oblique: Oblique, half: [f64; 2]) -> Self {
        let axes = oblique.axes();
        let corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
        let needs = corners.iter().map(|sign| {
            let at = [0, 1, 2].map(|k| sign[0] * half[0] * axes[0][k] + sign[1] * half[1] * axes[1][k]);
            (at[0].abs() / half[0]).max(at[1].abs() / half[1]) - at[2]
        });
        Self { axes, distance: needs.fold(1.0, f64::max) }
    }

    /// The ray, on the plane z = 1, to a point of the scene.
    fn ray(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let at = [0, 1, 2].map(|k| x * self.axes[0][k] + y * self.axes[1][k]);
        let depth = at[2] + self.distance;
        [at[0] / depth, at[1] / depth]
    }

    /// The point of the scene on a ray; none where the ray does not meet the plane before the camera.
    fn point(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let along = |axis: [f64; 3], z: f64| axis[0] * x + axis[1] * y + axis[2] * z;
        let facing = along(self.axes[2], 1.0);
        let depth = self.distance * self.axes[2][2] / facing;
        // What the distance has of it on the axes in the plane is taken off.
        let on = |axis: [f64; 3]| depth * along(axis, 1.0) - self.distance * axis[2];
        (facing > 0.0).then(|| [on(self.axes[0]), on(self.axes[1])])
    }
}

/// A camera before a picture of given size.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::phantom) struct Mapping {
    /// Focal lengths along rows and columns.
    focal_px: [f64; 2],
    coefficients: [f64; 8],
    /// Where the optical axis meets the picture.
    centre_px: [f64; 2],
    plane: Option<Plane>,
}

impl Mapping {
    pub(in crate::phantom) fn new(lens: &Lens, width: usize, height: usize) -> Self {
        let fx = lens.fx_px.unwrap_or(1200.0 / 1280.0 * width as f64);
        let middle = [0.5 * (width as f64 - 1.0), 0.5 * (height as f64 - 1.0)];
        Self::of([fx; 2], middle, &lens.distortion)
    }

    /// Of both focal lengths, the axis' place and the coefficients.
    pub(in crate::phantom) fn of(focal_px: [f64; 2], centre_px: [f64; 2], distortion: &[f64]) -> Self {
        let mut coefficients = [0.0; 8];
        coefficients.iter_mut().zip(distortion).for_each(|(into, &from)| *into = from);
        Self { focal_px, coefficients, centre_px, plane: None }
    }

    /// Before a plane that is seen obliquely.
    pub(in crate::phantom) fn before(mut self, oblique: Option<Oblique>) -> Self {
        let half = [0, 1].map(|axis| (self.centre_px[axis] + 0.5) / self.focal_px[axis]);
        self.plane = oblique.map(|oblique| Plane::new(oblique, half));
        self
    }

    /// Focal length along rows.
    pub(in crate::phantom) fn fx_px(&self) -> f64 {
        self.focal_px[0]
    }

    /// Where the camera shows a point.
    pub(in crate::phantom) fn shown(&self, point: [f64; 2]) -> [f64; 2] {
        let at = self.plane(point);
        self.picture_of(self.plane.as_ref().map_or(at, |plane| plane.ray(at)))
    }

    /// The point that the camera shows at `shown`; none where the lens folds the picture there, or the plane ends.
    pub(in crate::phantom) fn straight(&self, shown: [f64; 2]) -> Option<[f64; 2]> {
        let ray = self.ray(shown)?;
        let at = self.plane.as_ref().map_or(Some(ray), |plane| plane.point(ray))?;
        Some(self.picture(at))
    }

    /// Where the camera shows a ray, which is its point on the plane z = 1.
    pub(in crate::phantom) fn picture_of(&self, ray: [f64; 2]) -> [f64; 2] {
        self.picture(self.bend(ray))
    }

    /// The ray, on the plane z = 1, that the camera shows at `shown`; none where the lens folds the picture there.
    pub(in crate::phantom) fn ray(&self, shown: [f64; 2]) -> Option<[f64; 2]> {
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
        (near && grows).then_some(at)
    }

    /// What to add to the place of each pixel of the shown picture to get the point that is shown there, row after row.
    pub(in crate::phantom) fn straighten(&self, width: usize, height: usize) -> Vec<[f32; 2]> {
        let step = |k: usize| {
            let shown = [(k % width) as f64, (k / width) as f64];
            // The check of the options has seen that the corners can be undone.
            let [x, y] = self.straight(shown).unwrap_or([f64::INFINITY; 2]);
            [(x - shown[0]) as f32, (y - shown[1]) as f32]
        };
        (0..width * height).into_par_iter().map(step).collect()
    }

    fn plane(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.centre_px[0]) / self.focal_px[0], (y - self.centre_px[1]) / self.focal_px[1]]
    }

    fn picture(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x * self.focal_px[0] + self.centre_px[0], y * self.focal_px[1] + self.centre_px[1]]
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
pub(in crate::phantom) fn row_moves(moves: &[[f32; 2]], width: usize) -> Vec<[[f64; 2]; 2]> {
    let range = |row: &[[f32; 2]], axis: usize| ends(row.iter().map(|step| f64::from(step[axis])));
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

    #[test]
    fn an_oblique_plane_is_undone_and_stays_in_the_picture() {
        let lens = Lens { fx_px: None, distortion: vec![-0.1, 0.02] };
        for (tilt_deg, towards_deg) in [(30.0, 0.0), (30.0, 137.0), (45.0, -60.0), (0.0, 0.0)] {
            let oblique = Oblique { tilt_deg, towards_deg };
            let mapping = Mapping::new(&lens, 1280, 720).before(Some(oblique));
            for point in [[0.0, 0.0], [1279.0, 10.0], [640.0, 360.0], [300.0, 719.0]] {
                let shown = mapping.shown(point);
                assert!((-0.5..1279.5).contains(&shown[0]) && (-0.5..719.5).contains(&shown[1]), "{shown:?}");
                let back = mapping.straight(shown).unwrap();
                assert!((back[0] - point[0]).hypot(back[1] - point[1]) < 1e-6);
            }
            let [right, down, away] = oblique.axes();
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let all = [dot(right, right) - 1.0, dot(down, down) - 1.0, dot(away, away) - 1.0];
            let apart = [dot(right, down), dot(right, away), dot(down, away)];
            assert!(all.iter().chain(&apart).all(|rest| rest.abs() < 1e-12));
        }
    }
}
