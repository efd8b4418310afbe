//! `lunula camera`: views of a chessboard to a lens.

use clap::Args;
use lunula::camera::{self, CameraOptions, CameraReport, Inputs};
use lunula::job::Given;

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

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

pub(crate) fn run(args: &CameraArgs) -> anyhow::Result<Outcome> {
    let CameraArgs { given, inputs, results } = args;
    let options = CameraOptions { threads: results.job.common.threads(), ..given.options.clone() };
    jobs::run(
        &results.request("camera", "files", &given.said),
        || Ok(camera::plan(inputs, &options, &results.outputs())?),
        |watch| Ok(camera::run(inputs, &options, &results.outputs(), watch)?),
        |common, report| say(common, inputs, report),
    )
}

fn say(common: &Common, inputs: &Inputs, report: &CameraReport) {
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
        report.looked_at + usize::from(inputs.plane.is_some()),
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
