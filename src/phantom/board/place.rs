//! Where a board is before the camera.

use std::f64::consts::TAU;

use nalgebra::{Rotation3, Vector3};
use rand::RngExt;

use super::BoardOptions;
use crate::phantom::nail::numbers;
use crate::phantom::scene::lens::{Mapping, Oblique};

const KIND_PLACES: u32 = 31;
/// Tries for a place in which all of the board is in the picture; each is nearer to the middle, and smaller.
const TRIES: u32 = 400;
/// The picture's corners from its middle, as shares of its sides.
const CORNERS: [[f64; 2]; 4] = [[-0.5, -0.5], [0.5, 0.5], [0.5, -0.5], [-0.5, 0.5]];

/// A board before the camera: x of the camera = rotation x of the board + translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Rotation.
    pub rotation: Rotation3<f64>,
    /// Where the board's first inner corner is, millimetres.
    pub translation_mm: Vector3<f64>,
}

impl View {
    /// A place at random, in which all of the board's squares are in the picture; none where there is none. Views go to
    /// the picture's corners in turn, every fifth anywhere.
    pub(super) fn random(options: &BoardOptions, mapping: &Mapping, index: usize) -> Option<Self> {
        let mut rng = numbers(options.seed, KIND_PLACES, index as u32);
        let mut within = |low: f64, high: f64| if low < high { rng.random_range(low..high) } else { low };
        let middle = middle_mm(options);
        let size = [f64::from(options.size.0), f64::from(options.size.1)];
        let tilt = within(options.tilt[0], options.tilt[1]).to_radians();
        let towards = within(0.0, TAU);
        let roll = within(-0.3, 0.3);
        let share = within(0.4, 0.58);
        let axis = nalgebra::Unit::new_normalize(Vector3::new(towards.cos(), towards.sin(), 0.0));
        let rotation = Rotation3::from_axis_angle(&axis, tilt) * Rotation3::from_axis_angle(&Vector3::z_axis(), roll);
        let anywhere = [within(-0.5, 0.5), within(-0.5, 0.5)];
        let goal = CORNERS.get(index % 5).copied().unwrap_or(anywhere);
        (0..TRIES).find_map(|tried| {
            let room = 1.0 - f64::from(tried) / f64::from(TRIES);
            let aim = [0, 1].map(|k| (0.5 + room * goal[k]) * (size[k] - 1.0));
            let ray = mapping.ray(aim)?;
            let depth = options.focal_px()[0] * 2.0 * middle.x / (share * (0.4 + 0.6 * room) * size[0]);
            let there = depth * Vector3::new(ray[0], ray[1], 1.0);
            let view = Self { rotation, translation_mm: there - rotation * middle };
            view.is_in(options, mapping).then_some(view)
        })
    }

    /// The board in an oblique plane, its middle where the optical axis meets it, as large as fits.
    pub(super) fn in_plane(options: &BoardOptions, mapping: &Mapping, plane: Oblique) -> Option<Self> {
        let axes = plane.axes().map(Vector3::from);
        let rotation = Rotation3::from_matrix(&nalgebra::Matrix3::from_columns(&axes));
        let middle = middle_mm(options);
        let near = options.focal_px()[0] * 2.0 * middle.x / (0.85 * f64::from(options.size.0));
        (0..40).find_map(|step| {
            let there = Vector3::new(0.0, 0.0, near * 1.05_f64.powi(step));
            let view = Self { rotation, translation_mm: there - rotation * middle };
            view.is_in(options, mapping).then_some(view)
        })
    }

    /// The ray, on the plane z = 1, to a point of the board's plane.
    pub(super) fn ray(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let at = self.rotation * Vector3::new(x, y, 0.0) + self.translation_mm;
        [at.x / at.z, at.y / at.z]
    }

    /// The inner corners as the lens shows them, row after row, pixels.
    pub(super) fn corners_px(&self, options: &BoardOptions, mapping: &Mapping) -> Vec<[f64; 2]> {
        let points = options.board.points_mm(options.square_mm);
        points.into_iter().map(|[x, y, _]| mapping.picture_of(self.ray([x, y]))).collect()
    }

    /// Between the board and the picture, degrees.
    pub(super) fn tilt_deg(&self) -> f64 {
        self.rotation[(2, 2)].abs().min(1.0).acos().to_degrees()
    }

    /// All squares, and half a square about them, lie in the picture.
    fn is_in(&self, options: &BoardOptions, mapping: &Mapping) -> bool {
        let side = options.square_mm;
        let far = |count: usize| (count as f64 + 0.5) * side;
        let ends = [[-1.5 * side, far(options.board.columns)], [-1.5 * side, far(options.board.rows)]];
        let (width, height) = (f64::from(options.size.0), f64::from(options.size.1));
        let edge = (0..=8).flat_map(|k| {
            let at = |[from, to]: [f64; 2]| from + (to - from) * f64::from(k) / 8.0;
            [[at(ends[0]), ends[1][0]], [at(ends[0]), ends[1][1]], [ends[0][0], at(ends[1])], [ends[0][1], at(ends[1])]]
        });
        edge.into_iter().all(|point| {
            let before = (self.rotation * Vector3::new(point[0], point[1], 0.0) + self.translation_mm).z > 0.0;
            let [x, y] = mapping.picture_of(self.ray(point));
            before && (0.0..=width - 1.0).contains(&x) && (0.0..=height - 1.0).contains(&y)
        })
    }
}

/// The middle of the board's inner corners.
fn middle_mm(options: &BoardOptions) -> Vector3<f64> {
    let half = |count: usize| 0.5 * (count as f64 - 1.0) * options.square_mm;
    Vector3::new(half(options.board.columns), half(options.board.rows), 0.0)
}
