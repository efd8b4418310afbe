//! What was measured: the JSON beside the lens.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::board::BoardSize;
use super::error::CameraError;
use super::fit::{Fit, FittedView, OF_LENS};
use super::judge::{View, covered};
use super::options::CameraOptions;
use crate::job::Report;

/// What a run did.
pub type CameraReport = Report<CameraFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct CameraFigures {
    /// The table `[camera]`.
    pub camera: PathBuf,
    /// Inner corners of the board.
    pub board: BoardSize,
    /// Side of a square.
    pub square_mm: f64,
    /// Width and height of the upright pictures.
    pub picture_px: [usize; 2],
    /// The lens.
    pub lens: LensFigures,
    /// Its standard errors.
    pub lens_sd: LensFigures,
    /// Root mean square distance between corners and where the lens shows them.
    pub rms_px: f64,
    /// The standard deviation of a corner's coordinate, from what is left.
    pub corner_sd_px: f64,
    /// How far what is left of neighbouring corners goes together, a correlation: about 0 of noise.
    pub neighbours: f64,
    /// The standard error of an undistorted point, root mean square over the picture; none where the distortion was not
    /// measured but held at 0.
    pub undistorted_sd_px: Option<f64>,
    /// The share of the picture's 8 x 6 cells with a corner.
    pub covered: f64,
    /// How far from the picture's middle the farthest corner is, as a share of half the diagonal.
    pub reach: f64,
    /// The plane of the finger.
    pub plane: Option<PlaneFigures>,
    /// The views that were used; the plane's is the last.
    pub views: Vec<ViewFigures>,
    /// Pictures in which the board was looked for.
    pub looked_at: usize,
}

/// A lens, or its standard errors; 0 of what was held.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LensFigures {
    /// Focal length along rows.
    pub fx_px: f64,
    /// Focal length along columns.
    pub fy_px: f64,
    /// Column of the optical axis.
    pub cx_px: f64,
    /// Row of the optical axis.
    pub cy_px: f64,
    /// k1, k2, p1, p2, k3.
    pub distortion: [f64; 5],
}

impl LensFigures {
    /// Of fx, fy, cx, cy, k1, k2, p1, p2, k3.
    fn of([fx_px, fy_px, cx_px, cy_px, distortion @ ..]: [f64; OF_LENS]) -> Self {
        Self { fx_px, fy_px, cx_px, cy_px, distortion }
    }
}

/// The plane of the finger.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PlaneFigures {
    /// Its normal, of length 1, towards the camera: right, down, forwards.
    pub normal: [f64; 3],
    /// Between the normal and the optical axis.
    pub tilt_deg: f64,
    /// The standard error of the normal's direction, in its worst direction.
    pub normal_sd_deg: f64,
}

impl PlaneFigures {
    pub(super) fn of(view: &FittedView) -> Self {
        let normal = view.normal();
        let worst = view.normal_covariance().symmetric_eigenvalues().max().max(0.0);
        Self { normal: normal.into(), tilt_deg: tilt_deg(view), normal_sd_deg: worst.sqrt().to_degrees() }
    }
}

/// A view of the board.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ViewFigures {
    /// The file, and of a video the frame.
    pub view: String,
    /// Root mean square distance between its corners and where the lens shows them.
    pub rms_px: f64,
    /// Between the board's normal and the optical axis.
    pub tilt_deg: f64,
    /// From the camera to the board's first corner.
    pub distance_mm: f64,
}

fn tilt_deg(view: &FittedView) -> f64 {
    (-view.normal().z).clamp(-1.0, 1.0).acos().to_degrees()
}

/// The figures of a fit to views of a `size`, of the `looked_at` ones; with a plane, the last view shows it. The table
/// goes to `camera`.
pub(super) fn figures(
    fit: &Fit,
    views: &[View],
    size: (usize, usize),
    options: &CameraOptions,
    looked_at: usize,
    has_plane: bool,
    camera: &Path,
) -> Result<CameraFigures, CameraError> {
    let covered = covered(views, size);
    let lens = fit.lens;
    let ([fx, fy], [cx, cy], [k1, k2, p1, p2, k3]) = (lens.focal_px, lens.centre_px, lens.distortion);
    let of = |(fitted, view): (&FittedView, &View)| ViewFigures {
        view: view.name.clone(),
        rms_px: fitted.rms_px(),
        tilt_deg: tilt_deg(fitted),
        distance_mm: fitted.pose.translation.iter().map(|t| t * t).sum::<f64>().sqrt(),
    };
    Ok(CameraFigures {
        camera: camera.to_owned(),
        board: options.board,
        square_mm: options.square_mm,
        picture_px: [size.0, size.1],
        lens: LensFigures::of([fx, fy, cx, cy, k1, k2, p1, p2, k3]),
        lens_sd: LensFigures::of(fit.sd()),
        rms_px: fit.rms_px,
        corner_sd_px: fit.corner_sd_px,
        neighbours: fit.neighbours(options.board.columns),
        undistorted_sd_px: fit.measures_distortion().then(|| fit.undistorted_sd_px(size)).transpose()?,
        covered: covered.cells,
        reach: covered.reach,
        plane: fit.views.last().filter(|_| has_plane).map(PlaneFigures::of),
        views: fit.views.iter().zip(views).map(of).collect(),
        looked_at,
    })
}

impl CameraFigures {
    /// The table `[camera]`, as marker files have it.
    #[must_use]
    pub fn toml(&self) -> String {
        let Self { lens, lens_sd: sd, picture_px: [width, height], .. } = self;
        let mut text = format!(
            "# From {} views of a board of {} inner corners; residuals {:.3} px RMS.\n# Standard errors: fx {:.2}, fy \
             {:.2}, cx {:.2}, cy {:.2} px.\n[camera]\nsize = [{width}, {height}]\n",
            self.views.len(),
            self.board,
            self.rms_px,
            sd.fx_px,
            sd.fy_px,
            sd.cx_px,
            sd.cy_px
        );
        for (key, value) in [("fx", lens.fx_px), ("fy", lens.fy_px), ("cx", lens.cx_px), ("cy", lens.cy_px)] {
            text += &format!("{key} = {value:?}\n");
        }
        text += &format!("distortion = {:?}\n", lens.distortion);
        if let Some(plane) = &self.plane {
            text += &format!(
                "\n# The plane of the finger, {:.2} degrees off straight, standard error {:.3} degrees.\n\
                 [camera.plane]\nnormal = {:?}\n",
                plane.tilt_deg, plane.normal_sd_deg, plane.normal
            );
        }
        text
    }
}
