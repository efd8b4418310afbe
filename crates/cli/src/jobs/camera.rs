//! `lunula camera`: views of a chessboard to a lens.

use clap::Args;
use lunula::camera::{CameraFigures, CameraOptions, CameraReport, Inputs, plan, run};
use lunula::job::{Given, Watch};

use crate::Common;
use crate::jobs::{Command, Plan, Request, ResultArgs, needed};

/// Measure a camera's lens from views of a chessboard, for the [camera] of a marker file
///
/// Print a chessboard, glue it to something flat, and take 10 to 20 photographs of it with the camera, zoom and focus
/// of the videos: all of the board in each, tilted by 20 to 40 degrees to all sides, near the picture's corners as well
/// as in its middle. Results: the table [camera], which goes into the marker file as it is, and beside it
/// <camera>.run.json and a picture of where the corners were seen. Views that do not determine the lens are refused.
#[derive(Debug, Args)]
#[command(mut_arg("out", |out| out.value_name("CAMERA.toml").help("The lens, as a marker file has it")))]
pub(crate) struct CameraArgs {
    #[command(flatten)]
    given: Given<CameraOptions>,
    #[command(flatten)]
    inputs: Inputs,
    #[command(flatten)]
    results: ResultArgs,
}

impl CameraArgs {
    fn options(&self) -> CameraOptions {
        CameraOptions { threads: self.results.job.common.threads(), ..self.given.options.clone() }
    }
}

impl Command for CameraArgs {
    type Figures = CameraFigures;

    const NAME: &'static str = "camera";

    const UNIT: &'static str = "files";

    fn given(&self) -> Request<'_> {
        self.results.given(&self.given.said)
    }

    fn plan(&self) -> anyhow::Result<Plan> {
        Ok(plan(&self.inputs, &self.options(), self.results.outputs().as_ref())?.into())
    }

    fn run(&self, watch: &Watch<'_>) -> anyhow::Result<CameraReport> {
        Ok(run(&self.inputs, &self.options(), &needed(self.results.outputs())?, watch)?)
    }

    fn say(&self, common: &Common, report: &CameraReport) {
        let (lens, sd) = (report.lens, report.lens_sd);
        for (name, value, sd) in [
            ("fx", lens.fx_px, sd.fx_px),
            ("fy", lens.fy_px, sd.fy_px),
            ("cx", lens.cx_px, sd.cx_px),
            ("cy", lens.cy_px, sd.cy_px),
        ] {
            common.say(&format!("{name}  {value:>9.2} ± {sd:.2} px"));
        }
        for ((name, value), sd) in ["k1", "k2", "p1", "p2", "k3"].iter().zip(lens.distortion).zip(sd.distortion) {
            let sd = if sd == 0.0 { "held".to_owned() } else { format!("± {sd:.5}") };
            common.say(&format!("{name}  {value:>9.5} {sd}"));
        }
        let undistorted = match report.undistorted_sd_px {
            Some(sd_px) => format!("points are undistorted to ± {sd_px:.3} px"),
            None => "the distortion was not measured".to_owned(),
        };
        common.say(&format!(
            "{} of {} views used; residuals {:.3} px RMS; {undistorted}; corners cover {:.0} % of the picture",
            report.views.len(),
            report.looked_at + usize::from(self.inputs.plane.is_some()),
            report.rms_px,
            100.0 * report.covered
        ));
        if let Some(plane) = report.plane {
            common.say(&format!(
                "plane of the finger: {:.2} ± {:.2} degrees off straight",
                plane.tilt_deg, plane.normal_sd_deg
            ));
        }
    }
}
