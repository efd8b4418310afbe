//! The lens: points of the picture to where a camera without distortion would show them, and back.
//!
//! In: a point of the shown picture, pixels; out: the same on a picture of square pixels without distortion, with the
//! Jacobian that carries its covariance. Pictures are never undistorted, points are.
//!
//! The model is OpenCV's (documentation of the module calib3d; Brown 1971, rational terms after Claus and Fitzgibbon,
//! doi:10.1109/CVPR.2005.43, thin prism after Weng et al., doi:10.1109/34.159901), in its symbols: x' and y' on the
//! plane z = 1, r2 = x'^2 + y'^2,
//! x'' = x' (1 + k1 r2 + k2 r2^2 + k3 r2^3) / (1 + k4 r2 + k5 r2^2 + k6 r2^3) + 2 p1 x' y' + p2 (r2 + 2 x'^2) + s1 r2 +
//! s2 r2^2, y'' = the same with p1 (r2 + 2 y'^2) + 2 p2 x' y' + s3 r2 + s4 r2^2, then u = fx x'' + cx, v = fy y'' + cy.
//!
//! It is inverted here, not by OpenCV: `undistortPoints` takes five steps of a fixed point iteration, which leave up to
//! 0.036 px of a usual lens (here Newton's method leaves 5e-13 px or says that there is no such point), and it gives no
//! derivatives. Eight points take 2.9 microseconds with them, 1.3 with OpenCV without, of 10^4 that a frame takes
//! (`cargo test --lib opencvs_five_steps -- --nocapture`).

use nalgebra::{Matrix2, Vector2};

use crate::posture::Camera;

/// A camera's lens for pictures of one size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    focal_px: [f64; 2],
    centre_px: [f64; 2],
    distortion: [f64; 12],
}

/// A point without the lens' distortion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Undistorted {
    /// Where it is, in pixels as wide and high as the picture's are wide.
    pub at_px: [f64; 2],
    /// Its derivatives by the column and the row of the distorted point: one row for x, one for y.
    pub jacobian: [[f64; 2]; 2],
}

/// A solution is taken when its last step and what it leaves are below this, pixels.
const SOLVED_PX: f64 = 1e-9;
const MOST_STEPS: usize = 60;
/// Where on the way from the axis to a point it is checked that the model does not fold back.
const WAY_POINTS: usize = 16;

impl Lens {
    /// The lens for shown pictures of `size` (width, height); `pixel_aspect` is a pixel's width over its height.
    #[must_use]
    pub fn new(camera: &Camera, size: (usize, usize), pixel_aspect: f64) -> Self {
        let middle = |length: usize| (length as f64 - 1.0) / 2.0;
        Self {
            focal_px: [camera.fx_px, camera.fy_px.unwrap_or(camera.fx_px * pixel_aspect)],
            centre_px: [camera.cx_px.unwrap_or(middle(size.0)), camera.cy_px.unwrap_or(middle(size.1))],
            distortion: camera.distortion,
        }
    }

    /// Focal length and the axis' place on the picture without distortion, pixels.
    pub(super) fn frame(&self) -> (f64, [f64; 2]) {
        (self.focal_px[0], self.centre_px)
    }

    /// Where the picture shows a point that a camera without distortion would show at `at_px` (square pixels).
    #[must_use]
    pub fn distort(&self, at_px: [f64; 2]) -> [f64; 2] {
        let [fx, fy] = self.focal_px;
        let [cx, cy] = self.centre_px;
        let (bent, _) = self.bend(Vector2::new((at_px[0] - cx) / fx, (at_px[1] - cy) / fx));
        [fx * bent.x + cx, fy * bent.y + cy]
    }

    /// Where a camera without distortion would show the picture's point; none where the model shows no point, or two,
    /// there.
    #[must_use]
    pub fn undistort(&self, shown_px: [f64; 2]) -> Option<Undistorted> {
        let [fx, fy] = self.focal_px;
        let [cx, cy] = self.centre_px;
        let aim = Vector2::new((shown_px[0] - cx) / fx, (shown_px[1] - cy) / fy);
        let solved = SOLVED_PX / fx.max(fy);
        let mut at = aim;
        let (mut bent, mut slope) = self.bend(at);
        let mut done = false;
        for _ in 0..MOST_STEPS {
            let rest = bent - aim;
            let step = slope.try_inverse()? * rest;
            if !step.norm().is_finite() {
                return None;
            }
            // Shorter steps where a whole one does not lead nearer: far from the axis the model is steep.
            let mut share = 1.0;
            let (next, value) = loop {
                let next = at - share * step;
                let value = self.bend(next);
                if (value.0 - aim).norm() <= rest.norm() || share < 1e-3 {
                    break (next, value);
                }
                share *= 0.5;
            };
            at = next;
            (bent, slope) = value;
            done = step.norm() <= solved && (bent - aim).norm() <= solved;
            if done {
                break;
            }
        }
        if !done || !(1..=WAY_POINTS).all(|k| self.is_orderly(at * (k as f64 / WAY_POINTS as f64))) {
            return None;
        }
        let inverse = slope.try_inverse()?;
        let jacobian = [[inverse[(0, 0)], inverse[(0, 1)] * fx / fy], [inverse[(1, 0)], inverse[(1, 1)] * fx / fy]];
        Some(Undistorted { at_px: [fx * at.x + cx, fx * at.y + cy], jacobian })
    }

    /// The picture grows outwards here, as it does at the axis: nothing is turned inside out.
    fn is_orderly(&self, at: Vector2<f64>) -> bool {
        let r2 = at.norm_squared();
        let [.., k4, k5, k6, _, _, _, _] = self.distortion;
        let divisor = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
        divisor > 0.0 && self.bend(at).1.determinant() > 0.0
    }

    /// (x'', y'') of (x', y') and the derivatives.
    fn bend(&self, at: Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        let [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4] = self.distortion;
        let (x, y) = (at.x, at.y);
        let r2 = x * x + y * y;
        let over = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let under = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
        let radial = over / under;
        let by_r2 = (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3) - radial * (k4 + r2 * (2.0 * k5 + 3.0 * r2 * k6))) / under;
        let bent = Vector2::new(
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) + r2 * (s1 + r2 * s2),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y + r2 * (s3 + r2 * s4),
        );
        let (prism_x, prism_y) = (s1 + 2.0 * r2 * s2, s3 + 2.0 * r2 * s4);
        let across = 2.0 * x * y * by_r2 + 2.0 * p1 * x + 2.0 * p2 * y;
        let slope = Matrix2::new(
            radial + 2.0 * x * x * by_r2 + 2.0 * p1 * y + 6.0 * p2 * x + 2.0 * x * prism_x,
            across + 2.0 * y * prism_x,
            across + 2.0 * x * prism_y,
            radial + 2.0 * y * y * by_r2 + 6.0 * p1 * y + 2.0 * p2 * x + 2.0 * y * prism_y,
        );
        (bent, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens(distortion: &[f64]) -> Lens {
        let camera =
            Camera { fy_px: Some(1180.0), cx_px: Some(640.5), cy_px: Some(355.25), ..Camera::of(1200.0, distortion) };
        Lens::new(&camera, (1280, 720), 1.0)
    }

    const MODELS: [&[f64]; 4] = [
        &[-0.28, 0.09, 0.0011, -0.0007],
        &[-0.28, 0.09, 0.0011, -0.0007, -0.012],
        &[0.35, -0.12, 0.0011, -0.0007, 0.03, 0.62, -0.05, 0.01],
        &[0.35, -0.12, 0.0011, -0.0007, 0.03, 0.62, -0.05, 0.01, 0.002, -0.001, -0.0015, 0.0008],
    ];

    /// OpenCV 5.0.0, cv2.undistortPoints(points, K, d, None, None, K, (COUNT + EPS, 5000, 1e-15)) with K and d as
    /// above, of these points; its cv2.projectPoints leads back within 4e-13 px.
    const SHOWN: [[f64; 2]; 3] = [[13.5, 20.25], [1279.0, 719.0], [900.0, 100.0]];
    const OPENCV_UNDISTORTED: [[[f64; 2]; 3]; 4] = [
        [[-60.5568915204, -20.1827132066], [1361.693442916, 765.1437094844], [907.4641377579, 92.6100592621]],
        [[-61.5839070985, -20.7352482455], [1363.0990842516, 765.9388415209], [907.4675238886, 92.6067267601]],
        [[-58.2075642574, -18.9188156424], [1359.4558832123, 763.8779392413], [907.170485222, 92.8990608249]],
        [[-59.2309783356, -18.3111286222], [1358.3530218642, 764.5203398384], [906.9280316557, 93.0801203216]],
    ];
    /// cv2.projectPoints of (-0.5, -0.28, 1), (0.1, 0.2, 1), (0.4, -0.25, 1) with the same K and d, no rotation and
    /// translation.
    const RAYS: [[f64; 2]; 3] = [[-0.5, -0.28], [0.1, 0.2], [0.4, -0.25]];
    const OPENCV_PROJECTED: [[[f64; 2]; 3]; 4] = [
        [[89.52122976, 52.4225250918], [758.841, 588.1348], [1092.01497, 77.9303640625]],
        [[89.7762307942, 52.5629456613], [758.84082, 588.134446], [1091.95152279, 77.9693576603]],
        [[87.9851871708, 51.5766776394], [758.9024413624, 588.2556346794], [1093.0155320948, 77.3154352751]],
        [[88.6439312988, 51.097216792], [759.0194413624, 588.1694946794], [1093.4901245948, 76.9683441751]],
    ];
    /// The numbers above have ten decimals; measured 5.8e-11.
    const AS_OPENCV_PX: f64 = 1e-10;

    #[test]
    fn points_are_undistorted_and_distorted_as_by_opencv() {
        for (k, model) in MODELS.iter().enumerate() {
            let lens = lens(model);
            // OpenCV's pixels are 1180 high here, ours as high as wide.
            let square = |[x, y]: [f64; 2]| [x, (y - 355.25) * 1180.0 / 1200.0 + 355.25];
            let undistorted = SHOWN.map(|shown| square(lens.undistort(shown).unwrap().at_px));
            let projected = RAYS.map(|ray| lens.distort([640.5 + 1200.0 * ray[0], 355.25 + 1200.0 * ray[1]]));
            for (way, ours, theirs) in
                [("back", undistorted, OPENCV_UNDISTORTED[k]), ("there", projected, OPENCV_PROJECTED[k])]
            {
                let gaps: [f64; 3] =
                    std::array::from_fn(|at| (ours[at][0] - theirs[at][0]).hypot(ours[at][1] - theirs[at][1]));
                assert!(
                    gaps.iter().all(|gap| *gap <= AS_OPENCV_PX),
                    "{way}, {} coefficients: {gaps:?} px",
                    model.len()
                );
            }
        }
    }

    /// Points all over the picture.
    fn all_over() -> [[f64; 2]; 400] {
        std::array::from_fn(|k| [(k % 20) as f64 * 1279.0 / 19.0, (k / 20) as f64 * 719.0 / 19.0])
    }

    #[test]
    fn there_and_back_is_where_one_was() {
        let mut worst: f64 = 0.0;
        for model in MODELS {
            let lens = lens(model);
            for shown in all_over() {
                let back = lens.distort(lens.undistort(shown).unwrap().at_px);
                worst = worst.max((back[0] - shown[0]).hypot(back[1] - shown[1]));
            }
        }
        // Measured 4.7e-13.
        assert!(worst <= 1e-9, "{worst:e} px");
    }

    #[test]
    fn the_jacobian_is_the_derivative() {
        let step = 1e-3;
        for model in MODELS {
            let lens = lens(model);
            let at = |x: f64, y: f64| lens.undistort([x, y]).unwrap().at_px;
            for [x, y] in SHOWN {
                let derivatives = lens.undistort([x, y]).unwrap().jacobian;
                for (axis, derivatives) in derivatives.iter().enumerate() {
                    let by_x = (at(x + step, y)[axis] - at(x - step, y)[axis]) / (2.0 * step);
                    let by_y = (at(x, y + step)[axis] - at(x, y - step)[axis]) / (2.0 * step);
                    // Measured 1.9e-10, the rounding of the differences.
                    assert!((derivatives[0] - by_x).abs() <= 1e-8 && (derivatives[1] - by_y).abs() <= 1e-8);
                }
            }
        }
    }

    #[test]
    fn a_point_that_the_model_never_shows_is_missing() {
        // r (1 - 0.5 r2) grows up to r = 0.816 and reaches 0.5443 there: 653 pixels from the axis.
        let barrel = lens(&[-0.5, 0.0, 0.0, 0.0]);
        assert!(barrel.undistort([640.5 + 650.0, 355.25]).is_some());
        for far in [656.0, 700.0, 1000.0, 5000.0, f64::NAN, f64::INFINITY] {
            assert_eq!(barrel.undistort([640.5 + far, 355.25]), None, "{far}");
        }
        let near = barrel.undistort([640.5 + 650.0, 355.25]).unwrap().at_px;
        assert!(near[0] - 640.5 < 0.8165 * 1200.0, "the branch that reaches the axis");
    }

    #[test]
    fn no_distortion_changes_nothing() {
        let camera = Camera::of(900.0, &[]);
        let plain = Lens::new(&camera, (641, 481), 1.0).undistort([12.5, 470.0]).unwrap();
        assert!((plain.at_px[0] - 12.5).abs() <= 1e-12 && (plain.at_px[1] - 470.0).abs() <= 1e-12);
        assert_eq!(plain.jacobian, [[1.0, 0.0], [0.0, 1.0]]);
        // Pixels twice as wide as high: the same ten pixels are half as far downwards.
        let wide = Lens::new(&camera, (641, 481), 2.0);
        let [right, down] = [[330.0, 240.0], [320.0, 250.0]].map(|p| wide.undistort(p).unwrap().at_px);
        assert!((right[0] - 330.0).abs() <= 1e-12 && (down[1] - 245.0).abs() <= 1e-12);
    }

    /// OpenCV's `undistortPoints` as it comes, five steps from the point itself, against this file's: how far each is
    /// from where the model leads back, and how long a frame's eight markers take (printed, not held).
    #[test]
    fn opencvs_five_steps_do_not_arrive() {
        use crate::vision::{Intrinsics, undistorted_by_default};
        let lens = lens(MODELS[1]);
        let distortion: [f64; 5] = MODELS[1].try_into().unwrap();
        let of_opencv = Intrinsics { focal_px: [1200.0, 1180.0], centre_px: [640.5, 355.25], distortion };
        let points = all_over();
        let theirs = undistorted_by_default(&points, &of_opencv).unwrap();
        let mut worst = [0.0_f64; 2];
        for (point, [x, y]) in points.iter().zip(theirs) {
            let square = [x, (y - 355.25) * 1200.0 / 1180.0 + 355.25];
            for (worst, at) in worst.iter_mut().zip([square, lens.undistort(*point).unwrap().at_px]) {
                let back = lens.distort(at);
                *worst = worst.max((back[0] - point[0]).hypot(back[1] - point[1]));
            }
        }
        let timed = |work: &dyn Fn(&[[f64; 2]])| {
            let start = std::time::Instant::now();
            points.chunks(8).for_each(work);
            start.elapsed().as_secs_f64() / (points.len() / 8) as f64 * 1e6
        };
        let times = [
            timed(&|eight| assert_eq!(undistorted_by_default(eight, &of_opencv).unwrap().len(), eight.len())),
            timed(&|eight| eight.iter().for_each(|&at| assert!(std::hint::black_box(lens.undistort(at)).is_some()))),
        ];
        eprintln!("OpenCV and ours: {worst:?} px, {times:?} microseconds for eight points");
        assert!(worst[0] > 1e-3 && worst[1] <= 1e-9, "{worst:?}");
    }
}
