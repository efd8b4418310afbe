//! A camera's lens from views of a flat board, and where that lens shows points.
//!
//! In: the board's points on its own plane, and where each view shows them, pixels. Out: focal lengths, the axis' place
//! and the distortion, the pose of the board in each view, and the derivatives of all that is seen. Units of length are
//! those of the board's points; only poses have them.
//!
//! Source: Z. Zhang, "A flexible new technique for camera calibration", 2000, doi:10.1109/34.888718, as OpenCV's
//! `calibrateCamera` minimises it; k1, k2, p1, p2, k3 as its documentation has them.

use opencv::calib3d::{self, CALIB_FIX_K1, CALIB_FIX_K2, CALIB_FIX_K3, CALIB_USE_LU, CALIB_ZERO_TANGENT_DIST};
use opencv::core::{Mat, Point2f, Point3f, Size, TermCriteria, TermCriteria_Type, Vector};
use opencv::prelude::*;

use super::{VisionError, ready, view};

/// Focal lengths, the axis' place on the picture, and the lens' distortion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Intrinsics {
    /// fx and fy, pixels.
    pub(crate) focal_px: [f64; 2],
    /// cx and cy, pixels.
    pub(crate) centre_px: [f64; 2],
    /// k1, k2, p1, p2, k3.
    pub(crate) distortion: [f64; 5],
}

impl Intrinsics {
    /// OpenCV's camera matrix, row after row.
    fn matrix(&self) -> [f64; 9] {
        let ([fx, fy], [cx, cy]) = (self.focal_px, self.centre_px);
        [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]
    }
}

/// Where a board is: x of the camera = R x of the board + t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    /// The axis of R times its angle in radians (Rodrigues).
    pub(crate) rotation_rad: [f64; 3],
    /// t, in the board's units.
    pub(crate) translation: [f64; 3],
}

/// What `calibrateCamera` found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Calibration {
    pub(crate) intrinsics: Intrinsics,
    /// One for each view.
    pub(crate) poses: Vec<Pose>,
}

/// How much OpenCV's descent may take: steps, and the relative change at which it ends.
const MOST_STEPS: i32 = 200;
const LEAST_CHANGE: f64 = 1e-12;

/// The lens that shows the board's `points` where each of `views` has them, with 0, 4 (k1, k2, p1, p2) or 5 (and k3)
/// coefficients of distortion.
pub(crate) fn calibrate(
    points: &[[f64; 3]],
    views: &[Vec<[f32; 2]>],
    (width, height): (usize, usize),
    coefficients: usize,
) -> Result<Calibration, VisionError> {
    const CALL: &str = "calibrateCamera";
    ready()?;
    let (boards, seen) = boards(points, views);
    let flags = CALIB_USE_LU
        | match coefficients {
            0 => CALIB_ZERO_TANGENT_DIST | CALIB_FIX_K1 | CALIB_FIX_K2 | CALIB_FIX_K3,
            4 => CALIB_FIX_K3,
            _ => 0,
        };
    let end = TermCriteria_Type::COUNT as i32 | TermCriteria_Type::EPS as i32;
    let end = TermCriteria::new(end, MOST_STEPS, LEAST_CHANGE).map_err(VisionError::of(CALL))?;
    let (mut matrix, mut distortion) = (Mat::default(), Mat::default());
    let (mut rotations, mut translations) = (Vector::<Mat>::new(), Vector::<Mat>::new());
    calib3d::calibrate_camera(
        &boards,
        &seen,
        Size::new(width as i32, height as i32),
        &mut matrix,
        &mut distortion,
        &mut rotations,
        &mut translations,
        flags,
        end,
    )
    .map_err(VisionError::of(CALL))?;
    let matrix: [f64; 9] = numbers(CALL, &matrix)?;
    let poses = rotations.iter().zip(translations.iter()).map(|(rotation, translation)| {
        Ok(Pose { rotation_rad: numbers(CALL, &rotation)?, translation: numbers(CALL, &translation)? })
    });
    let poses: Vec<Pose> = poses.collect::<Result<_, VisionError>>()?;
    if poses.len() != views.len() {
        return Err(VisionError::lacking(CALL, format!("{} poses of {} views", poses.len(), views.len())));
    }
    let intrinsics = Intrinsics {
        focal_px: [matrix[0], matrix[4]],
        centre_px: [matrix[2], matrix[5]],
        distortion: numbers(CALL, &distortion)?,
    };
    Ok(Calibration { intrinsics, poses })
}

/// The board's points, and where they are seen, for each view.
fn boards(points: &[[f64; 3]], views: &[Vec<[f32; 2]>]) -> (Vector<Vector<Point3f>>, Vector<Vector<Point2f>>) {
    let board: Vector<Point3f> = points.iter().map(|p| Point3f::new(p[0] as f32, p[1] as f32, p[2] as f32)).collect();
    let seen = |view: &Vec<[f32; 2]>| view.iter().map(|at| Point2f::new(at[0], at[1])).collect::<Vector<Point2f>>();
    (views.iter().map(|_| board.clone()).collect(), views.iter().map(seen).collect())
}

/// Where a lens shows a board, and how that changes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Projected {
    /// A place for each point, pixels.
    pub(crate) at_px: Vec<[f64; 2]>,
    /// Two rows for each point, x then y: derivatives by rotation (3), translation (3), fx, fy, cx, cy, k1, k2, p1, p2,
    /// k3.
    pub(crate) derivatives: Vec<[f64; PARAMETERS]>,
}

/// Of one view: its pose and all of the lens.
pub(crate) const PARAMETERS: usize = 15;

/// Where the lens shows the board's `points` at `pose`.
pub(crate) fn project(points: &[[f64; 3]], pose: &Pose, lens: &Intrinsics) -> Result<Projected, VisionError> {
    const CALL: &str = "projectPoints";
    let (matrix, rotation, translation) = (lens.matrix(), pose.rotation_rad, pose.translation);
    let (mut shown, mut jacobian) = (Mat::default(), Mat::default());
    calib3d::project_points(
        &view(points.len(), 3, points.as_flattened())?,
        &view(3, 1, &rotation)?,
        &view(3, 1, &translation)?,
        &view(3, 3, &matrix)?,
        &view(1, 5, &lens.distortion)?,
        &mut shown,
        &mut jacobian,
        0.0,
    )
    .map_err(VisionError::of(CALL))?;
    let shown = places(CALL, &shown)?;
    if shown.len() != points.len() || jacobian.rows() as usize != 2 * points.len() {
        return Err(VisionError::lacking(CALL, format!("{} of {} points", shown.len(), points.len())));
    }
    let row = |row: i32| {
        let all = jacobian.at_row::<f64>(row).map_err(VisionError::of(CALL))?;
        let first = all.get(..PARAMETERS).and_then(|first| first.try_into().ok());
        first.ok_or_else(|| VisionError::lacking(CALL, format!("{} derivatives", all.len())))
    };
    Ok(Projected { at_px: shown, derivatives: (0..jacobian.rows()).map(row).collect::<Result<_, _>>()? })
}

/// Where a camera of the same focal lengths and axis, without distortion, would show points (`undistortPoints`, with as
/// many steps as it takes).
pub(crate) fn undistorted(points: &[[f64; 2]], lens: &Intrinsics) -> Result<Vec<[f64; 2]>, VisionError> {
    let end = TermCriteria_Type::COUNT as i32 | TermCriteria_Type::EPS as i32;
    undistorted_until(points, lens, TermCriteria::new(end, 5000, 1e-15))
}

fn undistorted_until(
    points: &[[f64; 2]],
    lens: &Intrinsics,
    end: opencv::Result<TermCriteria>,
) -> Result<Vec<[f64; 2]>, VisionError> {
    const CALL: &str = "undistortPoints";
    let (matrix, mut there) = (lens.matrix(), Mat::default());
    let end = end.map_err(VisionError::of(CALL))?;
    let (matrix, none) = (view(3, 3, &matrix)?, opencv::core::no_array());
    let seen = view(points.len(), 2, points.as_flattened())?;
    calib3d::undistort_points_iter(&seen, &mut there, &matrix, &view(1, 5, &lens.distortion)?, &none, &matrix, end)
        .map_err(VisionError::of(CALL))?;
    places(CALL, &there)
}

/// The points of a matrix of them.
fn places(call: &'static str, mat: &Mat) -> Result<Vec<[f64; 2]>, VisionError> {
    let all = mat.data_typed::<opencv::core::Point2d>().map_err(VisionError::of(call))?;
    Ok(all.iter().map(|at| [at.x, at.y]).collect())
}

/// The numbers of a matrix of doubles.
fn numbers<const N: usize>(call: &'static str, mat: &Mat) -> Result<[f64; N], VisionError> {
    let all = mat.data_typed::<f64>().map_err(VisionError::of(call))?;
    let finite = all.get(..N).filter(|all| all.iter().all(|number| number.is_finite()));
    let known: Option<[f64; N]> = finite.and_then(|all| all.try_into().ok());
    known.ok_or_else(|| VisionError::lacking(call, format!("{} of {N} numbers", all.len())))
}

/// The standard errors that OpenCV's `calibrateCameraExtended` gives of fx, fy, cx, cy, k1, k2, p1, p2, k3.
#[cfg(test)]
pub(crate) fn opencvs_sd(
    points: &[[f64; 3]],
    views: &[Vec<[f32; 2]>],
    (width, height): (usize, usize),
) -> Result<[f64; 9], VisionError> {
    let (boards, seen) = boards(points, views);
    let mut mats: [Mat; 4] = std::array::from_fn(|_| Mat::default());
    let [matrix, distortion, lens_sd, rest] = &mut mats;
    let (mut rotations, mut translations) = (Vector::<Mat>::new(), Vector::<Mat>::new());
    let mut per_view = Mat::default();
    let size = Size::new(width as i32, height as i32);
    calib3d::calibrate_camera_extended_def(
        &boards,
        &seen,
        size,
        matrix,
        distortion,
        &mut rotations,
        &mut translations,
        lens_sd,
        rest,
        &mut per_view,
    )
    .map_err(VisionError::of("calibrateCameraExtended"))?;
    numbers("calibrateCameraExtended", lens_sd)
}

/// The same with the five steps that OpenCV takes by default.
#[cfg(test)]
pub(crate) fn undistorted_by_default(points: &[[f64; 2]], lens: &Intrinsics) -> Result<Vec<[f64; 2]>, VisionError> {
    undistorted_until(points, lens, TermCriteria::new(TermCriteria_Type::COUNT as i32, 5, 0.01))
}
