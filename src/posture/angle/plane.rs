//! The plane in which the finger moves: points of the undistorted picture to where a camera that looks straight at that
//! plane would show them.
//!
//! In: a point of a picture without distortion, pixels as high as wide. Out: the same on a picture of the plane seen
//! straight, on the same scale where the optical axis meets the plane, with the Jacobian. Angles on it are those in
//! the plane; lengths are not known, as the plane's distance is not. Markers beside the plane, nearer to the camera or
//! farther, are seen where their ray meets it.

use super::lens::Undistorted;

/// A plane before a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    focal_px: f64,
    centre_px: [f64; 2],
    /// Directions in the plane, of length 1: as near as can be to the picture's right, and the one across it, down.
    right: [f64; 3],
    down: [f64; 3],
    /// Its normal, away from the camera.
    away: [f64; 3],
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Plane {
    /// Of the plane's `normal` of length 1, towards the camera; the optical axis meets the picture at `centre_px`.
    pub(super) fn new(normal: [f64; 3], focal_px: f64, centre_px: [f64; 2]) -> Self {
        let away = normal.map(|part| -part);
        let along = [1.0 - away[0] * away[0], -away[0] * away[1], -away[0] * away[2]];
        let length = dot(along, along).sqrt();
        let right = along.map(|part| part / length);
        let down = [
            away[1] * right[2] - away[2] * right[1],
            away[2] * right[0] - away[0] * right[2],
            away[0] * right[1] - away[1] * right[0],
        ];
        Self { focal_px, centre_px, right, down, away }
    }

    /// Where a camera straight before the plane would show a point; none where its ray does not meet the plane.
    pub(super) fn straight(&self, at_px: [f64; 2]) -> Option<Undistorted> {
        let [x, y] = [0, 1].map(|axis| (at_px[axis] - self.centre_px[axis]) / self.focal_px);
        let ray = [x, y, 1.0];
        let facing = dot(self.away, ray);
        if facing.is_nan() || facing <= 0.0 {
            return None;
        }
        // The plane passes the axis at a distance of one focal length.
        let depth = self.away[2] / facing;
        let place = |axis: [f64; 3]| depth * dot(axis, ray) - axis[2];
        let slope = |axis: [f64; 3]| [0, 1].map(|k| depth * (axis[k] - self.away[k] / facing * dot(axis, ray)));
        let [right, down] = [place(self.right), place(self.down)];
        Some(Undistorted {
            at_px: [self.focal_px * right + self.centre_px[0], self.focal_px * down + self.centre_px[1]],
            jacobian: [slope(self.right), slope(self.down)],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phantom::video::Oblique;

    const CENTRE_PX: [f64; 2] = [640.0, 350.0];

    #[test]
    fn a_plane_seen_straight_changes_nothing() {
        let plane = Plane::new([0.0, 0.0, -1.0], 1200.0, CENTRE_PX);
        let there = plane.straight([12.5, 700.0]).unwrap();
        assert!((there.at_px[0] - 12.5).abs() <= 1e-12 && (there.at_px[1] - 700.0).abs() <= 1e-12);
        assert_eq!(there.jacobian, [[1.0, 0.0], [0.0, 1.0]]);
    }

    #[test]
    fn angles_in_the_plane_are_kept_and_the_jacobian_is_the_derivative() {
        for (tilt_deg, towards_deg) in [(30.0, 0.0), (30.0, 90.0), (50.0, -130.0), (75.0, 20.0)] {
            let oblique = Oblique { tilt_deg, towards_deg };
            let [right, down, _] = oblique.axes();
            let plane = Plane::new(oblique.normal(), 1200.0, CENTRE_PX);
            // Points of the plane as the camera shows them.
            let seen = |[x, y]: [f64; 2]| {
                let at: [f64; 3] = std::array::from_fn(|k| x * right[k] + y * down[k] + if k == 2 { 2.0 } else { 0.0 });
                [0, 1].map(|k| 1200.0 * at[k] / at[2] + CENTRE_PX[k])
            };
            let corner = [[0.1, 0.2], [-0.3, 0.25], [0.15, -0.2]].map(|at| plane.straight(seen(at)).unwrap().at_px);
            let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
                let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
                (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1])
            };
            let truth = turn([0.1, 0.2], [-0.3, 0.25], [0.15, -0.2]);
            assert!((turn(corner[0], corner[1], corner[2]) - truth).abs() <= 1e-12, "{tilt_deg}");
            let here = [700.0, 300.0];
            let slope = plane.straight(here).unwrap().jacobian;
            for (axis, slope) in slope.iter().enumerate() {
                for k in 0..2 {
                    let at = |step: f64| {
                        let mut moved = here;
                        moved[k] += step;
                        plane.straight(moved).unwrap().at_px[axis]
                    };
                    // Measured 3e-9.
                    assert!((slope[k] - (at(1e-3) - at(-1e-3)) / 2e-3).abs() <= 1e-6);
                }
            }
        }
        let steep = Plane::new(Oblique { tilt_deg: 75.0, towards_deg: 0.0 }.normal(), 300.0, CENTRE_PX);
        assert_eq!(steep.straight([640.0 + 2000.0, 350.0]), None, "beyond the plane's horizon");
    }
}
