//! A scene: subject, pose, light and camera together, and what is exactly true of its photograph.

use image::DynamicImage;
use ndarray::Array2;
use thiserror::Error;

use super::{Camera, Field, Light, Pose, RenderOptions, Subject, render};
use crate::nail::{Axis, Outline};

/// Why a scene can't be drawn.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum SceneFault {
    #[error(
        "a picture of {width} x {height} pixels is too small; at least {least} x {least} are needed",
        least = NailScene::LEAST_SIDE
    )]
    PictureTooSmall { width: u32, height: u32 },
    /// The nail is no wider than a pixel or two, or its size is no number.
    #[error("a nail {0} px wide can't be drawn; it must be at least {least} px wide", least = NailScene::LEAST_NAIL_PX)]
    NailTooSmall(f64),
    /// A number of the scene is NaN or infinite, or negative where it can't be.
    #[error("{0} of the scene is not a usable number")]
    BadNumber(&'static str),
}

/// One fingertip in one pose, light and camera.
#[derive(Debug, Clone, PartialEq)]
pub struct NailScene {
    /// Whose fingertip.
    pub subject: Subject,
    /// What it does.
    pub pose: Pose,
    /// The light on it.
    pub light: Light,
    /// Where it stands on the picture.
    pub camera: Camera,
}

impl NailScene {
    /// The smallest side of a picture, pixels.
    pub const LEAST_SIDE: u32 = 8;
    /// The smallest width of a nail, pixels.
    pub const LEAST_NAIL_PX: f64 = 4.0;

    /// Can this scene be drawn?
    ///
    /// # Errors
    /// [`SceneFault`], what is wrong with it.
    pub fn check(&self) -> Result<(), SceneFault> {
        let Camera { width, height, centre_px, nail_width_px, blur_px, .. } = self.camera;
        if width < Self::LEAST_SIDE || height < Self::LEAST_SIDE {
            return Err(SceneFault::PictureTooSmall { width, height });
        }
        if !(nail_width_px.is_finite() && nail_width_px >= Self::LEAST_NAIL_PX) {
            return Err(SceneFault::NailTooSmall(nail_width_px));
        }
        if !centre_px.iter().all(|c| c.is_finite()) {
            return Err(SceneFault::BadNumber("the nail's centre"));
        }
        if !(blur_px.is_finite() && blur_px > 0.0) {
            return Err(SceneFault::BadNumber("the optics' blur"));
        }
        if !(self.light.brightness.is_finite() && self.light.brightness > 0.0) {
            return Err(SceneFault::BadNumber("the light's brightness"));
        }
        Ok(())
    }

    /// The scene made ready to be evaluated.
    pub fn field(&self) -> Field<'_> {
        Field::new(self)
    }

    /// The photograph.
    ///
    /// # Errors
    /// [`SceneFault`] where the scene can't be drawn.
    pub fn render(&self, options: &RenderOptions) -> Result<DynamicImage, SceneFault> {
        self.check()?;
        Ok(render::render(self, options))
    }

    /// The nail's length along the axis in pixels.
    pub fn length_px(&self) -> f64 {
        self.camera.nail_width_px * self.subject.nail.aspect
    }

    /// The nail's width across the axis in pixels.
    pub fn width_px(&self) -> f64 {
        self.camera.nail_width_px
    }

    /// From the eponychium to the hyponychium.
    pub fn axis(&self) -> Axis {
        self.camera.axis
    }

    /// The ends of the axis, `[x_px, y_px]`: proximal, distal.
    pub fn axis_ends_px(&self) -> [[f64; 2]; 2] {
        [self.picture_from_nail(0.0, -1.0), self.picture_from_nail(0.0, 1.0)]
    }

    /// The place on the picture, `[x_px, y_px]`, of a place on the nail.
    pub fn picture_from_nail(&self, u: f64, v: f64) -> [f64; 2] {
        let (right, distal) = (self.camera.axis.right(), self.camera.axis.distal());
        let (a, b) = (0.5 * u * self.width_px(), 0.5 * v * self.length_px());
        std::array::from_fn(|k| self.camera.centre_px[k] + a * right[k] + b * distal[k])
    }

    /// The nail's outline: corners exactly on its border.
    ///
    /// # Errors
    /// [`SceneFault`] where the scene can't be drawn.
    pub fn outline(&self) -> Result<Outline, SceneFault> {
        self.check()?;
        let corners: Vec<_> =
            self.subject.nail.corners().into_iter().map(|[u, v]| self.picture_from_nail(u, v)).collect();
        Outline::new(&corners).map_err(|_| SceneFault::BadNumber("the nail's shape"))
    }

    /// Place on the nail (`u`, `v`) of a place on the normalized picture, in its pixels (row `i`, column `j`; fractions
    /// within).
    fn nail_from_normalized(size: usize, margin: f64, i: f64, j: f64) -> [f64; 2] {
        let half = 0.5 * size as f64;
        let scale = margin / half;
        [(j + 0.5 - half) * scale, -(i + 0.5 - half) * scale]
    }

    /// Is a place on the picture within the photograph, that is on one of its pixels?
    fn photographed(&self, [x, y]: [f64; 2]) -> bool {
        let (width, height) = (f64::from(self.camera.width), f64::from(self.camera.height));
        x >= -0.5 && y >= -0.5 && x <= width - 0.5 && y <= height - 0.5
    }

    /// The exact normalized green: fraction of full scale as encoded, without noise and rounding; `size` x `size`, the
    /// nail's box filling 1/`margin` of it, distal up. NaN where the pixel's centre is outside the photograph.
    ///
    /// A pixel that covers no more than one of the camera's in a direction has the value at its centre; one that covers
    /// more has the mean over its area, from samples two thirds of a camera pixel apart.
    pub fn normalized(&self, size: usize, margin: f64) -> Array2<f32> {
        self.normalized_of(&self.field(), size, margin)
    }

    /// The same of a field of this scene, as of [`Field::at_moment`].
    pub fn normalized_of(&self, field: &Field<'_>, size: usize, margin: f64) -> Array2<f32> {
        let samples = [self.length_px(), self.width_px()].map(|side| {
            let covers = side * margin / size as f64;
            if covers <= 1.0 { 1 } else { (1.5 * covers).ceil() as usize }
        });
        let at = |n: usize, k: usize| (k as f64 + 0.5) / n as f64 - 0.5;
        Array2::from_shape_fn((size, size), |(i, j)| {
            let place = |di: f64, dj: f64| {
                let [u, v] = Self::nail_from_normalized(size, margin, i as f64 + di, j as f64 + dj);
                self.picture_from_nail(u, v)
            };
            if !self.photographed(place(0.0, 0.0)) {
                return f32::NAN;
            }
            let mut sum = 0.0;
            for k in 0..samples[0] {
                for l in 0..samples[1] {
                    let [x, y] = place(at(samples[0], k), at(samples[1], l));
                    sum += field.colour(x, y)[1];
                }
            }
            (sum / (samples[0] * samples[1]) as f64) as f32
        })
    }

    /// Which pixels of the normalized picture have their centre within the outline.
    pub fn inside(&self, size: usize, margin: f64) -> Array2<bool> {
        Array2::from_shape_fn((size, size), |(i, j)| {
            let [u, v] = Self::nail_from_normalized(size, margin, i as f64, j as f64);
            self.subject.nail.contains(u, v)
        })
    }
}
