//! The camera job: views and options in, a lens with its report and pictures out; the one entry that command line and
//! pipelines call.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::camera::draw::draw;
use crate::camera::error::CameraError;
use crate::camera::fit::{Fit, fit};
use crate::camera::judge::{FEWEST_VIEWS, Sorted, View, refuse, sort, warnings, words};
use crate::camera::options::{CameraOptions, Inputs};
use crate::camera::report::{CameraReport, figures};
use crate::camera::run::plan::steps;
use crate::camera::views::{Look, files, look};
use crate::files::{Places, beside};
use crate::input::same_to_the_byte;
use crate::job::{Outputs, Report, Watch};
use crate::photograph::is_picture;
use crate::stages::{Stages, left_out};

/// The picture's name, after the table's.
const PICTURE: &str = "corners";
/// More views than this are thinned out evenly: the lens gains little, and the work grows with their square.
const MOST_VIEWS: usize = 100;

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`CameraError`] where there is no lens: nothing is written.
pub fn run(
    inputs: &Inputs,
    options: &CameraOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<CameraReport, CameraError> {
    let stages = Stages::default();
    let mut files = files(&inputs.views)?;
    let copied = leave_copies_out(&mut files, inputs.plane.as_deref());
    let report_at = outputs.report.then(|| beside(&outputs.out, ".run.json"));
    let mut places = Places::not_over(files.iter().chain(&inputs.plane));
    places.check([Some(&outputs.out), report_at.as_ref()].into_iter().flatten())?;
    let looks = look(&files, options, &stages, watch)?;
    let looked_at = looks.len();
    let mut sorted = sort(looks)?;
    let mut notes = thin(&mut sorted.views);
    if let Some(plane) = &inputs.plane {
        let view = of_plane(plane, &sorted, options, &stages, watch)?;
        sorted.views.push(view);
    }
    watch.go_on()?;
    let Sorted { kind, views, failed } = sorted;
    let fitted = stages.time("lens", || of_views(&views, kind.size, options, &failed))?;
    let held = stages.time("lens", || held_at_0(&fitted, &views, kind.size, options))?;
    let figures = figures(&fitted, &views, kind.size, options, looked_at, inputs.plane.is_some(), &outputs.out)?;
    notes.extend(weak_k3(&fitted, options));
    notes.extend(not_measured(&fitted));
    places.write(&outputs.out, &figures.toml())?;
    let mut pictures = Vec::new();
    if outputs.figures {
        pictures.push(places.draw(&outputs.out, PICTURE, |png, svg| {
            stages.time("figures", || draw(&fitted, &views, kind.size, png, svg))
        })?);
    }
    watch.go_on()?;
    let videos = files.iter().filter(|file| !is_picture(file)).count();
    let counts = Some([files.len() - videos, videos]);
    let mut report = Report {
        left_out: left_out(steps(counts, inputs.plane.is_some(), options, outputs)),
        warnings: [copied, warnings(&fitted, &views, figures.covered, options.board), held].concat(),
        notes,
        failed,
        pictures,
        ..Report::new("camera", watch, figures)
    };
    if videos == 0 {
        report.unused(&["every"], "the views are photographs");
    }
    Ok(report.timed(&stages).commit(places, report_at.as_deref())?)
}

/// Takes away files that are another's copy to the byte, or the plane's: a view counted twice is no second view.
fn leave_copies_out(files: &mut Vec<PathBuf>, plane: Option<&Path>) -> Vec<String> {
    let (mut copies, mut said) = (BTreeSet::new(), Vec::new());
    let views = files.iter().map(PathBuf::as_path).enumerate().map(|(at, path)| (Some(at), path));
    for group in same_to_the_byte(plane.map(|path| (None, path)).into_iter().chain(views)) {
        let (first, of_plane) = (group[0].1.display(), if group[0].0.is_none() { " of --plane" } else { "" });
        copies.extend(group[1..].iter().filter_map(|(at, _)| *at));
        let names: Vec<String> = group[1..].iter().map(|(_, path)| path.display().to_string()).collect();
        said.push(format!("{}: the same to the byte as {first}{of_plane}, and not counted", names.join(", ")));
    }
    let mut at = 0..;
    files.retain(|_| !at.next().is_some_and(|at: usize| copies.contains(&at)));
    said
}

/// The lens that views determine.
fn of_views(
    views: &[View],
    size: (usize, usize),
    options: &CameraOptions,
    failed: &[String],
) -> Result<Fit, CameraError> {
    if views.len() < FEWEST_VIEWS {
        let why = format!(
            "{} view(s) show the board, and {FEWEST_VIEWS} are the fewest that can determine a lens; 10 to 20 with the \
             board tilted to all sides do it well",
            views.len()
        );
        return Err(CameraError::Undetermined { why, failed: failed.to_vec() });
    }
    refuse(fit_of(views, size, options, options.coefficients)?, views, failed)
}

fn fit_of(
    views: &[View],
    size: (usize, usize),
    options: &CameraOptions,
    coefficients: usize,
) -> Result<Option<Fit>, CameraError> {
    let corners: Vec<_> = views.iter().map(|view| view.corners.clone()).collect();
    fit(&options.board.points_mm(options.square_mm), &corners, size, coefficients)
}

/// Keeps at most [`MOST_VIEWS`], evenly.
fn thin(views: &mut Vec<View>) -> Vec<String> {
    let all = views.len();
    if all <= MOST_VIEWS {
        return Vec::new();
    }
    let mut at = 0;
    views.retain(|_| {
        at += 1;
        at * MOST_VIEWS / all > (at - 1) * MOST_VIEWS / all
    });
    vec![format!("of {all} views with the board {} are used, evenly spaced", views.len())]
}

/// The view of the board in the finger's plane.
fn of_plane(
    path: &Path,
    sorted: &Sorted,
    options: &CameraOptions,
    stages: &Stages,
    watch: &Watch<'_>,
) -> Result<View, CameraError> {
    let refused = |why: String| CameraError::Input { path: path.to_owned(), why };
    if path.is_dir() {
        return Err(refused("--plane takes one photograph or video of the board in the finger's plane".to_owned()));
    }
    let looks = look(&[path.to_owned()], options, stages, watch)?;
    let first = looks.iter().find(|one| one.board.is_ok()).or(looks.first());
    let Some(Look { name, kind, board, .. }) = first.cloned() else {
        return Err(refused("has no frames".to_owned()));
    };
    let corners = board.map_err(refused)?;
    if kind != sorted.kind {
        let why = format!("is {}, the views are {}; take it as the video is filmed", words(kind), words(sorted.kind));
        return Err(refused(why));
    }
    Ok(View { name, corners })
}

/// A coefficient that could as well be nothing.
fn weak_k3(fit: &Fit, options: &CameraOptions) -> Option<String> {
    let (k3, sd) = (fit.lens.distortion[4], fit.sd()[8]);
    let weak = options.coefficients == 5 && k3.abs() < 2.0 * sd;
    weak.then(|| format!("k3 is {k3:.3} with a standard error of {sd:.3}: --coefficients 4 leaves it out"))
}

/// That a standard error of undistorted points is not known.
fn not_measured(fit: &Fit) -> Option<String> {
    (!fit.measures_distortion()).then(|| {
        "the distortion was not measured: it is held at 0, and points stay where the lens shows them".to_owned()
    })
}

/// Residuals of held coefficients that are so many times those of free ones are warned of (assumed).
const HELD_TIMES: f64 = 3.0;

/// Warns where coefficients that are held at 0 leave more than free ones would.
fn held_at_0(
    fitted: &Fit,
    views: &[View],
    size: (usize, usize),
    options: &CameraOptions,
) -> Result<Vec<String>, CameraError> {
    const ALL: usize = 5;
    if options.coefficients == ALL {
        return Ok(Vec::new());
    }
    let free = fit_of(views, size, options, ALL)?;
    let warned = free.filter(|free| fitted.rms_px > HELD_TIMES * free.rms_px).map(|free| {
        format!(
            "--coefficients {} leaves residuals of {:.3} px RMS, and {ALL} coefficients leave {:.3} px: what is held \
             at 0 is not 0 for this lens; measure it with --coefficients {ALL}",
            options.coefficients, fitted.rms_px, free.rms_px
        )
    });
    Ok(warned.into_iter().collect())
}
