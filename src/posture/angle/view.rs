//! From the stored picture to the shown one, and on to the plane on which angles are measured.
//!
//! In: a marker's centre on the stored picture with its covariance; out: the same on the shown (upright) picture, or on
//! a picture of square pixels without the lens' distortion and, where the camera looks obliquely at the plane in which
//! the finger moves, with that plane seen straight. All: pixels, x right, y down.

use super::lens::Lens;
use super::plane::Plane;
use crate::posture::{Camera, Centre};
use crate::video::{Info, Turn};

use crate::posture::layout::Layout;

/// A point with the covariance of its error: variance of x, covariance, variance of y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spot {
    /// Column and row.
    pub at_px: [f64; 2],
    /// Variance of x, covariance, variance of y.
    pub covariance_px2: [f64; 3],
}

impl Spot {
    /// The spot's image under a map that takes its place to `at_px` and has the derivatives `jacobian` there.
    fn carried(self, at_px: [f64; 2], [[a, b], [c, d]]: [[f64; 2]; 2]) -> Self {
        let [xx, xy, yy] = self.covariance_px2;
        let covariance_px2 = [
            a * a * xx + 2.0 * a * b * xy + b * b * yy,
            a * c * xx + (a * d + b * c) * xy + b * d * yy,
            c * c * xx + 2.0 * c * d * xy + d * d * yy,
        ];
        Self { at_px, covariance_px2 }
    }
}

/// How a video's stored picture is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct View {
    turn: Turn,
    stored_size: (usize, usize),
    /// Width of the shown picture's pixels over their height.
    aspect: f64,
    lens: Option<Lens>,
    plane: Option<Plane>,
}

/// Lenses have their axis nearer to the middle than this share of a side (assumed; a few hundredths are usual).
const FAR: f64 = 0.15;

impl View {
    /// The view of a video, through the layout's camera where it names one.
    #[must_use]
    pub(crate) fn new(layout: &Layout, info: &Info) -> Self {
        let size = (info.format.width, info.format.height);
        Self::of(layout.camera.as_ref(), size, info.turn, info.pixel_aspect)
    }

    /// The view of a picture of `stored_size`, whose pixels' width over height is `pixel_aspect`.
    pub(in crate::posture) fn of(
        camera: Option<&Camera>,
        stored_size: (usize, usize),
        turn: Turn,
        pixel_aspect: f64,
    ) -> Self {
        let size = turn.shown_size(stored_size);
        let aspect = if turn.is_aside() { pixel_aspect.recip() } else { pixel_aspect };
        let lens = camera.map(|camera| Lens::new(camera, size, aspect));
        let plane = camera.zip(lens).and_then(|(camera, lens)| {
            let (focal_px, centre_px) = lens.frame();
            camera.plane.map(|normal| Plane::new(normal, focal_px, centre_px))
        });
        Self { turn, stored_size, aspect, lens, plane }
    }

    /// What to say of a layout's camera beside a video, whose pictures it may not be measured on.
    pub(crate) fn doubt(layout: &Layout, info: &Info) -> Result<Option<String>, String> {
        let Some(camera) = &layout.camera else { return Ok(None) };
        let (width, height) = info.turn.shown_size((info.format.width, info.format.height));
        if let Some([columns, rows]) = camera.size_px {
            if [columns, rows] == [width, height] {
                return Ok(None);
            }
            let scaled = if columns * height == rows * width {
                let ratio = width as f64 / columns as f64;
                format!(
                    "; where all of its view is in them, only smaller or larger, multiply fx and fy by {ratio}, and \
                     make of cx and cy (c + 0.5) {ratio} - 0.5, as (0, 0) is the middle of a pixel"
                )
            } else {
                String::new()
            };
            return Err(format!(
                "[camera] was measured on pictures of {columns} x {rows} px, and these are {width} x {height}: measure \
                 the lens at this size (`lunula camera`){scaled}, and correct `size`"
            ));
        }
        let middle = |length: usize| (length as f64 - 1.0) / 2.0;
        let axis = [camera.cx_px.unwrap_or(middle(width)), camera.cy_px.unwrap_or(middle(height))];
        let off = |at: f64, length: usize| (at - middle(length)).abs() / length as f64;
        let is_far = off(axis[0], width).max(off(axis[1], height)) > FAR;
        Ok(is_far.then(|| {
            format!(
                "the optical axis of [camera] is at ({:.1}, {:.1}) px, far from the middle of these pictures of \
                 {width} x {height} px: was the lens measured at this size? Then say `size = [{width}, {height}]` in \
                 [camera]",
                axis[0], axis[1]
            )
        }))
    }

    #[must_use]
    pub(crate) fn shown(&self, centre: &Centre) -> Spot {
        let stored = Spot { at_px: centre.at_px, covariance_px2: centre.covariance_px2 };
        let at_px = self.turn.shown_from_stored(centre.at_px, self.stored_size);
        let jacobian = match self.turn {
            Turn::None => [[1.0, 0.0], [0.0, 1.0]],
            Turn::Quarter => [[0.0, -1.0], [1.0, 0.0]],
            Turn::Half => [[-1.0, 0.0], [0.0, -1.0]],
            Turn::ThreeQuarters => [[0.0, 1.0], [-1.0, 0.0]],
        };
        stored.carried(at_px, jacobian)
    }

    /// The centre on square pixels without distortion, the finger's plane seen straight; none where the lens' model
    /// shows no such point.
    #[must_use]
    pub(crate) fn flat(&self, centre: &Centre) -> Option<Spot> {
        let shown = self.shown(centre);
        match &self.lens {
            Some(lens) => {
                let there = lens.undistort(shown.at_px)?;
                let flat = shown.carried(there.at_px, there.jacobian);
                let Some(plane) = &self.plane else { return Some(flat) };
                let straight = plane.straight(flat.at_px)?;
                Some(flat.carried(straight.at_px, straight.jacobian))
            }
            None => {
                let [x, y] = shown.at_px;
                Some(shown.carried([x * self.aspect, y], [[self.aspect, 0.0], [0.0, 1.0]]))
            }
        }
    }
}
