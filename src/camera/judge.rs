//! Whether views determine a lens, and how much of the picture they cover.

use super::board::BoardSize;
use super::error::CameraError;
use super::fit::Fit;
use super::views::{Kind, Look};
use crate::median::median_of;
use crate::vision::Corners;

/// The fewest views (Zhang 2000: fewer leave the axis' place or the aspect open).
pub(super) const FEWEST_VIEWS: usize = 3;
/// Fewer are warned of (assumed, after OpenCV's advice of 10).
const FEW_VIEWS: usize = 8;
/// A board whose corners are no further apart in two views, mean in pixels, rests (assumed: noise moves corners by 0.1
/// px, a hand that means to move it by tens).
const SAME_PX: f64 = 2.0;
/// Boards whose normals are all within so much of each other are alike, degrees (assumed).
const LEAST_SPREAD_DEG: f64 = 6.0;
/// A standard error of the focal lengths above which they are not determined, and one that is warned of, as a share
/// (assumed; angles are wrong by half of it at most).
const UNDETERMINED: f64 = 0.03;
const DOUBTFUL: f64 = 0.005;
/// Residuals above which the corners are no flat board's, pixels (assumed; photographs have 0.1 to 0.5).
const LARGE_RMS_PX: f64 = 1.5;
/// Residuals of neighbouring corners that go together by more than this (a correlation) are none of noise: 0.48 to 0.72
/// of rendered boards that are bent by 1 mm or printed 1 to 3 % longer one way, of a zoom that changes by 2 %, of
/// stabilised views; 0.29 or more of boards 2 % longer with corners to 0.1 px.
const TOGETHER: f64 = 0.25;
/// A camera's pixels are as wide as high to within this share (assumed), and seen to be others from so many standard
/// errors on.
const SQUARE: f64 = 0.003;
const SQUARE_SDS: f64 = 5.0;
/// A view whose residuals are so many times the others' is named.
const ODD_TIMES: f64 = 3.0;
/// Columns and rows of the cells in which corners are counted, and the share of cells under which it is warned.
pub(super) const CELLS: [usize; 2] = [8, 6];
const LITTLE_COVERED: f64 = 0.6;

/// A view that can be used.
#[derive(Debug, Clone)]
pub(super) struct View {
    pub(super) name: String,
    pub(super) corners: Corners,
}

/// The views of one size, and what could not be used.
pub(super) struct Sorted {
    pub(super) kind: Kind,
    pub(super) views: Vec<View>,
    pub(super) failed: Vec<String>,
}

/// Takes the views of the size and turn that most of them have.
pub(super) fn sort(looks: Vec<Look>) -> Result<Sorted, CameraError> {
    let mut failed: Vec<String> = Vec::new();
    let mut kinds: Vec<(Kind, Vec<View>)> = Vec::new();
    for Look { name, kind, board, .. } in looks {
        match board {
            Err(why) => failed.push(format!("{name}: {why}")),
            Ok(corners) => match kinds.iter_mut().find(|(known, _)| *known == kind) {
                Some((_, views)) => views.push(View { name, corners }),
                None => kinds.push((kind, vec![View { name, corners }])),
            },
        }
    }
    kinds.sort_by_key(|(kind, views)| (std::cmp::Reverse(views.len()), *kind));
    let undetermined = |why: String, failed: Vec<String>| Err(CameraError::Undetermined { why, failed });
    let Some((kind, views)) = kinds.first().cloned() else {
        return undetermined("no view shows the board".to_owned(), failed);
    };
    for (other, others) in &kinds[1..] {
        if others.len() == views.len() {
            let why = format!(
                "views are of different pictures, {} and {}; use those of one size",
                words(kind),
                words(*other)
            );
            return undetermined(why, failed);
        }
        let why = format!("is {}, most views are {}; take all as the video is filmed", words(*other), words(kind));
        failed.extend(others.iter().map(|view| format!("{}: {why}", view.name)));
    }
    Ok(Sorted { kind, views, failed })
}

/// As `1280 x 720 px`, and how it is turned.
pub(super) fn words(kind: Kind) -> String {
    let turned = if kind.turned == 0 { "" } else { ", stored turned" };
    format!("{} x {} px{turned}", kind.size.0, kind.size.1)
}

/// Refuses what is not determined.
pub(super) fn refuse(fit: Option<Fit>, views: &[View], failed: &[String]) -> Result<Fit, CameraError> {
    let refused = |why: String| Err(CameraError::Undetermined { why, failed: failed.to_vec() });
    let advice = "take 10 to 20 views with the board tilted by 20 to 40 degrees to all sides, as near to the picture's \
                  corners as to its middle";
    let Some(fit) = fit else {
        return refused(format!(
            "{} views leave the lens undetermined, as those that are alike do; {advice}",
            views.len()
        ));
    };
    let spread = spread_deg(&fit);
    if spread < LEAST_SPREAD_DEG {
        return refused(format!(
            "all {} views are alike: the board's tilt differs by {spread:.1} degrees only, and {LEAST_SPREAD_DEG} are \
             the least that tell focal length from distance; {advice}",
            views.len()
        ));
    }
    if fit.rms_px > LARGE_RMS_PX {
        return refused(format!(
            "the corners are {:.2} px RMS from where any lens shows a flat board; is it bent, or did the zoom change? \
             worst: {}",
            fit.rms_px,
            worst(&fit, views)
        ));
    }
    let sd = focal_sd_share(&fit);
    if sd.is_nan() || sd > UNDETERMINED {
        return refused(format!(
            "{} views leave the focal length open to {:.1} % (standard error), and {:.0} % are the most; {advice}",
            views.len(),
            100.0 * sd,
            100.0 * UNDETERMINED
        ));
    }
    Ok(fit)
}

/// The larger standard error of both focal lengths, as a share.
pub(super) fn focal_sd_share(fit: &Fit) -> f64 {
    let sd = fit.sd();
    (sd[0] / fit.lens.focal_px[0]).max(sd[1] / fit.lens.focal_px[1])
}

/// The largest angle between the normals of two views.
fn spread_deg(fit: &Fit) -> f64 {
    let normals: Vec<_> = fit.views.iter().map(super::fit::FittedView::normal).collect();
    let pairs = normals.iter().enumerate().flat_map(|(k, a)| normals[..k].iter().map(move |b| a.dot(b)));
    pairs.fold(1.0_f64, f64::min).clamp(-1.0, 1.0).acos().to_degrees()
}

fn worst(fit: &Fit, views: &[View]) -> String {
    let of = fit.views.iter().zip(views).max_by(|a, b| a.0.rms_px().total_cmp(&b.0.rms_px()));
    of.map_or(String::new(), |(view, named)| format!("{} ({:.2} px)", named.name, view.rms_px()))
}

/// Where corners are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Covered {
    /// The share of [`CELLS`] with a corner.
    pub(super) cells: f64,
    /// How far from the picture's middle the farthest corner is, as a share of half the diagonal.
    pub(super) reach: f64,
}

pub(super) fn covered(views: &[View], (width, height): (usize, usize)) -> Covered {
    let mut seen = [false; CELLS[0] * CELLS[1]];
    let mut reach = 0.0_f64;
    let middle = [0.5 * (width as f64 - 1.0), 0.5 * (height as f64 - 1.0)];
    for at in views.iter().flat_map(|view| &view.corners) {
        let [x, y] = at.map(f64::from);
        let cell = |v: f64, side: usize, count: usize| {
            (((v + 0.5) / side as f64 * count as f64).max(0.0) as usize).min(count - 1)
        };
        seen[cell(y, height, CELLS[1]) * CELLS[0] + cell(x, width, CELLS[0])] = true;
        reach = reach.max((x - middle[0]).hypot(y - middle[1]) / middle[0].hypot(middle[1]));
    }
    Covered { cells: seen.iter().filter(|seen| **seen).count() as f64 / seen.len() as f64, reach }
}

/// At how many places the board is: in frames of a film in which it rests it stays at one.
fn places(views: &[View]) -> usize {
    let is_same = |one: &View, other: &View| {
        let away = |(a, b): (&[f32; 2], &[f32; 2])| f64::from((a[0] - b[0]).hypot(a[1] - b[1]));
        let sum: f64 = one.corners.iter().zip(&other.corners).map(away).sum();
        sum < SAME_PX * one.corners.len() as f64
    };
    let mut distinct: Vec<&View> = Vec::new();
    for view in views {
        if !distinct.iter().any(|other| is_same(view, other)) {
            distinct.push(view);
        }
    }
    distinct.len()
}

/// What a person has to know before using the lens.
pub(super) fn warnings(fit: &Fit, views: &[View], covered: f64, board: BoardSize) -> Vec<String> {
    let mut warnings = Vec::new();
    let together = fit.neighbours(board.columns);
    if together > TOGETHER {
        warnings.push(format!(
            "what is left of neighbouring corners goes together (correlation {together:.2}, of noise about 0), so that \
             standard errors are too small: is the board bent, or printed longer one way (measure both sides), or did \
             zoom, focus or a stabiliser move between views?"
        ));
    }
    let [wider, sd] = fit.wider();
    if wider.abs() > SQUARE.max(SQUARE_SDS * sd) {
        let [by_width, by_height] = if wider > 0.0 { ["larger", "shorter"] } else { ["smaller", "longer"] };
        warnings.push(format!(
            "fx is {:.2} % {by_width} than fy (standard error {:.3}), and nearly all cameras have square pixels: is \
             the board {by_height} from row to row than from column to column by as much (measure both sides of the \
             print), or were the pictures stretched?",
            100.0 * wider.abs(),
            100.0 * sd
        ));
    }
    let places = places(views);
    if places < FEW_VIEWS {
        let what = match views.len() {
            few if few == places => format!("{few} views only"),
            many => format!("{many} views show {places} places of the board only, and count {many} times"),
        };
        warnings.push(format!("{what}: 10 to 20 show a bent board or a wrong view"));
    }
    let sd = focal_sd_share(fit);
    if sd > DOUBTFUL {
        warnings.push(format!(
            "the focal length is known to {:.1} % only (standard error); take more tilted views",
            100.0 * sd
        ));
    }
    if covered < LITTLE_COVERED {
        warnings.push(format!(
            "corners cover {:.0} % of the picture; elsewhere the distortion is extrapolated: hold the board there too",
            100.0 * covered
        ));
    }
    let usual = median_of(fit.views.iter().map(super::fit::FittedView::rms_px)).unwrap_or(f64::NAN);
    let odd = fit.views.iter().zip(views).filter(|(view, _)| view.rms_px() > ODD_TIMES * usual);
    warnings.extend(odd.map(|(view, named)| {
        format!(
            "{}: its corners are {:.2} px RMS off, {usual:.2} is usual; look at it, and leave it out where it is \
                 blurred",
            named.name,
            view.rms_px()
        )
    }));
    warnings
}
