//! What a run would do and leave out.

use crate::camera::error::CameraError;
use crate::camera::options::{CameraOptions, Inputs};
use crate::camera::views::files;
use crate::job::Outputs;
use crate::photograph::is_picture;
use crate::stages::Step;

/// Plans a run; `outputs` may have no place yet.
///
/// # Errors
/// A folder that can't be listed or holds no photographs.
pub fn plan(inputs: &Inputs, options: &CameraOptions, outputs: &Outputs) -> Result<Vec<Step>, CameraError> {
    let files = files(&inputs.views)?;
    let videos = files.iter().filter(|file| !is_picture(file)).count();
    Ok(steps(Some([files.len() - videos, videos]), inputs.plane.is_some(), options, outputs))
}

/// The one table of steps: the plan shows them, a run's report lists those that are left out. `counts` are photographs
/// and videos, where they are known.
pub(in crate::camera) fn steps(
    counts: Option<[usize; 2]>,
    has_plane: bool,
    options: &CameraOptions,
    outputs: &Outputs,
) -> Vec<Step> {
    let [photographs, videos] = counts.unwrap_or([1, 1]);
    let said = |count: usize, what: String| match counts {
        None => "as the inputs are".to_owned(),
        Some(_) if count == 0 => "there are none".to_owned(),
        Some(_) => what,
    };
    let figures = outputs.figures;
    let held = match options.coefficients {
        5 => "",
        4 => ", k3 held at 0",
        _ => ", no distortion",
    };
    let of_plane = if has_plane { "its view is one of the lens' too" } else { "no --plane" };
    vec![
        Step::new("photographs", photographs > 0, said(photographs, format!("{photographs}, turned upright"))),
        Step::new("videos", videos > 0, said(videos, format!("{videos}, a frame every {} s", options.every))),
        Step::new("corners", true, format!("of boards of {} inner corners", options.board)),
        Step::new("lens", true, format!("focal lengths, axis, {} coefficients{held}", options.coefficients)),
        Step::new("plane of the finger", has_plane, of_plane.to_owned()),
        Step::new("pictures undistorted", false, "points are, by the jobs that measure".to_owned()),
        Step::figures(figures, "corners on the picture"),
    ]
}
