//! Corners to a lens, with the standard errors of all that is found.
//!
//! In: the corners of each view. Out: the lens and the poses of least squares, what they leave, and the covariance of
//! the lens' parameters and of each pose. Errors of different corners are taken as independent and alike in x and y;
//! their size is taken from what is left.
//!
//! The covariance is our own, from OpenCV's derivatives: `calibrateCameraExtended` of OpenCV 4.6 divides the residuals'
//! sum of squares by the number of points less that of parameters, not by twice the number of points, so that its
//! standard errors are 1.45 times too long (measured, 12 views of 9 x 6 corners; the test below).

use nalgebra::{DMatrix, SMatrix, SVector, Vector3};

use super::error::CameraError;
use crate::vision::{Calibration, Corners, Intrinsics, PARAMETERS, Pose, calibrate, project, undistorted};

/// Parameters of a pose: rotation, then translation.
const OF_POSE: usize = 6;
/// Parameters of a lens: fx, fy, cx, cy, k1, k2, p1, p2, k3.
pub(super) const OF_LENS: usize = PARAMETERS - OF_POSE;

type PoseMatrix = SMatrix<f64, OF_POSE, OF_POSE>;
type LensMatrix = SMatrix<f64, OF_LENS, OF_LENS>;

/// Of one view: the inverse of its pose's own normal equations, those it shares with the lens, its residuals.
type Part = (PoseMatrix, DMatrix<f64>, Vec<[f64; 2]>);

/// What was fitted.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    pub(super) lens: Intrinsics,
    pub(super) views: Vec<FittedView>,
    /// The standard deviation of a corner's coordinate, from what is left, pixels.
    pub(super) corner_sd_px: f64,
    /// Root mean square distance between corners and where the lens shows them, pixels.
    pub(super) rms_px: f64,
    /// Covariance of the lens' parameters; zero of those that were held.
    pub(super) covariance: LensMatrix,
}

/// A view's pose, and what is left of it.
#[derive(Debug, Clone)]
pub(super) struct FittedView {
    pub(super) pose: Pose,
    /// Covariance of the rotation (radians) and the translation.
    pub(super) covariance: PoseMatrix,
    /// Corner less where the lens shows it, pixels.
    pub(super) residuals_px: Vec<[f64; 2]>,
}

impl FittedView {
    /// Root mean square distance, pixels.
    pub(super) fn rms_px(&self) -> f64 {
        let squares: f64 = self.residuals_px.as_flattened().iter().map(|rest| rest * rest).sum();
        (squares / self.residuals_px.len() as f64).sqrt()
    }

    /// The board's normal, of length 1, towards the camera.
    pub(super) fn normal(&self) -> Vector3<f64> {
        normal(self.pose.rotation_rad)
    }

    /// Covariance of the normal's direction.
    pub(super) fn normal_covariance(&self) -> SMatrix<f64, 3, 3> {
        const STEP: f64 = 1e-6;
        let column = |axis: usize| {
            let moved = |step: f64| {
                let mut rotation = self.pose.rotation_rad;
                rotation[axis] += step;
                normal(rotation)
            };
            (moved(STEP) - moved(-STEP)) / (2.0 * STEP)
        };
        let slope = SMatrix::<f64, 3, 3>::from_columns(&[column(0), column(1), column(2)]);
        slope * self.covariance.fixed_view::<3, 3>(0, 0) * slope.transpose()
    }
}

fn normal(rotation_rad: [f64; 3]) -> Vector3<f64> {
    let away = nalgebra::Rotation3::from_scaled_axis(Vector3::from(rotation_rad)) * Vector3::z();
    if away.z > 0.0 { -away } else { away }
}

/// Fits a lens with 0, 4 or 5 coefficients of distortion; `None`: the views leave it undetermined.
pub(super) fn fit(
    points: &[[f64; 3]],
    views: &[Corners],
    size: (usize, usize),
    coefficients: usize,
) -> Result<Option<Fit>, CameraError> {
    let free = if coefficients == 0 { 4 } else { 4 + coefficients };
    let Ok(Calibration { intrinsics: lens, poses }) = calibrate(points, views, size, coefficients) else {
        // OpenCV's descent ends in what is no number.
        return Ok(None);
    };
    let mut normal_equations = DMatrix::zeros(free, free);
    let (mut squares, mut parts) = (0.0, Vec::new());
    for (corners, pose) in views.iter().zip(&poses) {
        let shown = project(points, pose, &lens)?;
        let residuals_px: Vec<[f64; 2]> = corners
            .iter()
            .zip(&shown.at_px)
            .map(|(corner, at)| [f64::from(corner[0]) - at[0], f64::from(corner[1]) - at[1]])
            .collect();
        squares += residuals_px.as_flattened().iter().map(|rest| rest * rest).sum::<f64>();
        let mut own = PoseMatrix::zeros();
        let mut shared = DMatrix::zeros(OF_POSE, free);
        for row in &shown.derivatives {
            let of_pose = SVector::<f64, OF_POSE>::from_column_slice(&row[..OF_POSE]);
            let of_lens = nalgebra::DVector::from_column_slice(&row[OF_POSE..OF_POSE + free]);
            own += of_pose * of_pose.transpose();
            shared += of_pose * of_lens.transpose();
            normal_equations += &of_lens * of_lens.transpose();
        }
        let Some(own) = own.try_inverse() else { return Ok(None) };
        normal_equations -= shared.transpose() * own * &shared;
        parts.push((own, shared, residuals_px));
    }
    let count: usize = views.iter().map(Vec::len).sum();
    let freedom = (2 * count) as f64 - (free + OF_POSE * views.len()) as f64;
    let Some(inverse) = inverse(&normal_equations).filter(|_| freedom > 0.0) else { return Ok(None) };
    let variance = squares / freedom;
    let of_view = |(pose, (own, shared, residuals_px)): (Pose, Part)| {
        let spread = own * &shared;
        let by_lens = &spread * &inverse * spread.transpose();
        let by_lens = PoseMatrix::from_iterator(by_lens.iter().copied());
        FittedView { pose, covariance: variance * (own + by_lens), residuals_px }
    };
    let fitted = poses.into_iter().zip(parts).map(of_view).collect();
    let mut covariance = LensMatrix::zeros();
    covariance.view_mut((0, 0), (free, free)).copy_from(&(variance * inverse));
    let rms_px = (squares / count as f64).sqrt();
    Ok(Some(Fit { lens, views: fitted, corner_sd_px: variance.sqrt(), rms_px, covariance }))
}

/// The inverse of a positive definite matrix; none where it is singular to rounding.
fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    /// Of the smallest eigenvalue to the largest, once all diagonals are 1.
    const SINGULAR: f64 = 1e-13;
    let scale = matrix.diagonal().map(|d| 1.0 / d.max(f64::MIN_POSITIVE).sqrt());
    let scaled = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| matrix[(r, c)] * scale[r] * scale[c]);
    if !scaled.iter().all(|value| value.is_finite()) {
        return None;
    }
    let eigen = scaled.symmetric_eigen();
    if eigen.eigenvalues.min() <= SINGULAR * eigen.eigenvalues.max() {
        return None;
    }
    let inverted = DMatrix::from_diagonal(&eigen.eigenvalues.map(f64::recip));
    let inverted = &eigen.eigenvectors * inverted * eigen.eigenvectors.transpose();
    Some(DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| inverted[(r, c)] * scale[r] * scale[c]))
}

impl Fit {
    /// How far the residuals of corners that are neighbours on a board of so many columns go together: a correlation,
    /// of noise a little below 0 (-0.05 to -0.07 in 12 views of phantoms: the fit takes some of it).
    pub(super) fn neighbours(&self, columns: usize) -> f64 {
        let [mut together, mut pairs, mut alone, mut all] = [0.0; 4];
        for rest in self.views.iter().map(|view| &view.residuals_px) {
            let product = |a: usize, b: usize| rest[a][0] * rest[b][0] + rest[a][1] * rest[b][1];
            for k in 0..rest.len() {
                alone += product(k, k);
                all += 1.0;
                let next = [(k + 1) % columns != 0, k + columns < rest.len()];
                for other in [k + 1, k + columns].into_iter().zip(next).filter_map(|(k, is)| is.then_some(k)) {
                    together += product(k, other);
                    pairs += 1.0;
                }
            }
        }
        (together / pairs) / (alone / all)
    }

    /// Standard errors of fx, fy, cx, cy, k1, k2, p1, p2, k3; zero of what was held.
    pub(super) fn sd(&self) -> [f64; OF_LENS] {
        std::array::from_fn(|k| self.covariance[(k, k)].max(0.0).sqrt())
    }

    /// By which share fx is more than fy, and its standard error.
    pub(super) fn wider(&self) -> [f64; 2] {
        let [fx, fy] = self.lens.focal_px;
        let [xx, xy, yy] = [(0, 0), (0, 1), (1, 1)].map(|at| self.covariance[at]);
        let variance = xx / (fx * fx) - 2.0 * xy / (fx * fy) + yy / (fy * fy);
        [fx / fy - 1.0, variance.max(0.0).sqrt()]
    }

    /// Whether any coefficient of distortion was free.
    pub(super) fn measures_distortion(&self) -> bool {
        self.sd()[4..].iter().any(|sd| *sd > 0.0)
    }

    /// The standard error of a point without distortion, on a picture of the same focal lengths and axis, root mean
    /// square over the picture, pixels. What was held counts as known.
    pub(super) fn undistorted_sd_px(&self, (width, height): (usize, usize)) -> Result<f64, CameraError> {
        const STEPS: usize = 12;
        let (focal, centre) = (self.lens.focal_px, self.lens.centre_px);
        let at = |k: usize, side: usize| (k as f64 + 0.5) / STEPS as f64 * side as f64 - 0.5;
        let shown: Vec<[f64; 2]> = (0..STEPS * STEPS).map(|k| [at(k % STEPS, width), at(k / STEPS, height)]).collect();
        let straight = undistorted(&shown, &self.lens)?;
        let ray = |at: &[f64; 2]| [(at[0] - centre[0]) / focal[0], (at[1] - centre[1]) / focal[1], 1.0];
        let rays: Vec<[f64; 3]> = straight.iter().map(ray).collect();
        let here = Pose { rotation_rad: [0.0; 3], translation: [0.0; 3] };
        let rows = project(&rays, &here, &self.lens)?.derivatives;
        let mut sum = 0.0;
        for (ray, rows) in rays.iter().zip(rows.chunks_exact(2)) {
            let mut by_lens = SMatrix::<f64, 2, OF_LENS>::from_fn(|row, k| rows[row][OF_POSE + k]);
            // Where the picture shows a point by where it would without distortion: a step of the ray, of length 1.
            let by_place = SMatrix::<f64, 2, 2>::from_fn(|row, axis| rows[row][3 + axis] / focal[axis]);
            // That place held, the ray changes with focal length and axis.
            for axis in [0, 1] {
                let by_ray = by_place.column(axis).into_owned();
                by_lens.column_mut(axis).axpy(-ray[axis], &by_ray, 1.0);
                by_lens.column_mut(2 + axis).axpy(-1.0, &by_ray, 1.0);
            }
            let Some(back) = by_place.try_inverse() else { return Ok(f64::NAN) };
            let moved = back * by_lens;
            sum += (moved * self.covariance * moved.transpose()).trace();
        }
        Ok((sum / rays.len() as f64).max(0.0).sqrt())
    }
}
