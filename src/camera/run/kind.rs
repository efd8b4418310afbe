//! `camera` in a pipeline: views of a chessboard to a lens.

use std::path::PathBuf;

use crate::camera::options::{CameraOptions, Inputs};
use crate::camera::run::job::run;
use crate::camera::run::plan::{plan, steps};
use crate::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Quality, Role, Takes, Work};
use crate::stages::Step;

const CAMERA: &str = "camera.toml";

impl Job for CameraOptions {
    const KIND: Kind = Kind::of::<Self>(
        "camera",
        &[
            Role::new("views", Takes::Many, "photographs or videos of a chessboard"),
            Role::new("plane", Takes::Optional, "the board in the finger's plane"),
        ],
        &[Part::new("camera", CAMERA), Part::pictures("camera-corners.png")],
    )
    .revision(6);

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let outputs = demand.outputs(CAMERA);
        let plane = Foreseen::of(inputs, "plane").map(|input| input.path.clone());
        if inputs.iter().any(|input| !input.exists) {
            return Ok(steps(None, plane.is_some(), self, &outputs));
        }
        let views = inputs.iter().filter(|input| input.role == "views").map(|input| input.path.clone()).collect();
        plan(&Inputs { views, plane }, self, &outputs).map_err(|why| why.to_string())
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        (BYTES_AT_LEAST, S_A_VIEW * inputs.len() as f64)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let mut views: Vec<PathBuf> = work.of("views").map(|input| input.path.clone()).collect();
        views.sort();
        let inputs = Inputs { views, plane: work.one("plane").map(|input| input.path.clone()) };
        let options = CameraOptions { threads: work.threads, ..self.clone() };
        let outputs = order.demand.outputs(work.folder.join(CAMERA));
        let report = work.run(order.said, |watch| run(&inputs, &options, &outputs, watch))?;
        let share = 100.0 * report.lens_sd.fx_px / report.lens.fx_px;
        let undistorted = |sd_px| Quality::stated("undistorted points", sd_px, "pixels, standard error, RMS");
        let fx = Quality::stated("fx", share, "per cent, standard error");
        let quality = std::iter::once(fx).chain(report.undistorted_sd_px.map(undistorted)).collect();
        Ok(report.made(quality))
    }
}

/// Memory and time (assumed: photographs of 12 megapixels).
const BYTES_AT_LEAST: u64 = 200 << 20;
const S_A_VIEW: f64 = 0.2;
