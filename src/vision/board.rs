//! The inner corners of a chessboard, to a fraction of a pixel.
//!
//! In: a grey picture and how many inner corners the board has across and down. Out: the corners, row after row, or
//! none where the picture does not show all of one such board. Which corner is the first, and whether the rows run one
//! way or the other, is not determined: a chessboard looks the same in a mirror.
//!
//! The board is found by OpenCV's `findChessboardCorners` or, where it finds none, by `findChessboardCornersSB` (Duda
//! and Frese 2018, "Accurate detection and localization of checkerboard corners for calibration", BMVC) on a smaller
//! picture; `cornerSubPix` (Förstner and Gülch 1987) then places the corners. Measured on phantoms of 1280 x 720 px
//! and noise of 2 of 255: 0.027 px RMS in 0.003 s, `findChessboardCornersSB` alone 0.045 to 0.066 px in 0.8 s; at noise
//! of 8: 0.065 to 0.078 and 0.051 to 0.080 px.

use opencv::calib3d::{
    self, CALIB_CB_ADAPTIVE_THRESH, CALIB_CB_EXHAUSTIVE, CALIB_CB_FAST_CHECK, CALIB_CB_LARGER, CALIB_CB_NORMALIZE_IMAGE,
};
use opencv::core::{Mat, Point, Point2f, Scalar, Size, TermCriteria, TermCriteria_Type, ToInputArray, Vector};
use opencv::imgproc::{self, INTER_AREA, LINE_8};
use opencv::prelude::*;

use super::{Grey, VisionError, ready};
use crate::median::median_of;

/// Corners of a board, row after row, pixels.
pub(crate) type Corners = Vec<[f32; 2]>;

/// Half the side of the window in which a corner is placed, of the least distance between corners (measured: at 0.5 the
/// next corner is in it, and errors are 0.3 to 0.9 px), and its ends, pixels.
const WINDOW_SHARE: f32 = 0.35;
const WINDOW_PX: [f32; 2] = [2.0, 15.0];
/// Longer sides are made shorter for the slow search, pixels.
const SLOW_SEARCH_PX: usize = 1000;
/// .. and for a glance, which finds boards of any size in a sixteenth of a second. Of 80 phantoms of 9x6 it saw 79
/// whole, blurred, noisy and dark ones among them, and 12 of 16 whose light fell off to a tenth: what it sees may be a
/// part. A second one at three quarters saw another part or all of it then, in 128 of 128.
const GLANCE_PX: usize = 640;
const SECOND_GLANCE: f64 = 0.75;
/// The least of a board that a glance sees, inner corners.
const GLANCE: i32 = 3;

/// What a picture shows of a board.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Sought {
    Whole(Corners),
    /// One of another size, or a part of one: this many inner corners across and down.
    OfSize([usize; 2]),
    Nowhere,
}

/// Looks for a board of `columns` x `rows` inner corners; first, where it is given, at whether it is one of `other`:
/// where one of another size is there, it takes seconds to find that none of this is.
pub(crate) fn find_board(
    picture: Grey<'_>,
    columns: usize,
    rows: usize,
    other: Option<[usize; 2]>,
) -> Result<Sought, VisionError> {
    let mat = picture.mat()?;
    let of_size = |seen: Option<[usize; 2]>| seen.map_or(Sought::Nowhere, Sought::OfSize);
    if other.is_some() && glance(&mat, 1.0)? == other {
        return Ok(of_size(other));
    }
    let size = Size::new(columns as i32, rows as i32);
    let mut corners = match fast(&mat, size)? {
        Some(corners) => corners,
        None => {
            let seen = glance(&mat, 1.0)?.filter(|seen| *seen != [columns.max(rows), columns.min(rows)]);
            if seen.is_some() && glance(&mat, SECOND_GLANCE)? == seen {
                return Ok(of_size(seen));
            }
            match by_sectors(&mat, size, SLOW_SEARCH_PX)? {
                Some(corners) => corners,
                None => return Ok(of_size(seen)),
            }
        }
    };
    if corners.len() != columns * rows {
        let why = format!("{} corners of {columns} x {rows}", corners.len());
        return Err(VisionError::lacking("findChessboardCorners", why));
    }
    refine(&mat, &mut corners, columns)?;
    let placed: Corners = corners.iter().map(|corner| [corner.x, corner.y]).collect();
    Ok(if is_chessboard(picture, &placed, columns) { Sought::Whole(placed) } else { Sought::Nowhere })
}

/// The least contrast of squares about a corner, as a share of the board's median (assumed): a corner that was made up
/// beyond the picture's border or another thing before the board has none.
const LEAST_CONTRAST: f64 = 0.25;

/// Whether black and white squares take turns about every corner.
fn is_chessboard(picture: Grey<'_>, corners: &Corners, columns: usize) -> bool {
    let contrast = |k: usize| -> Option<f64> {
        let (row, column) = (k / columns, k % columns);
        // Steps to the next corner, or from the one before.
        let step = |is_last: bool, by: usize| {
            let [from, to] = if is_last { [k - by, k] } else { [k, k + by] };
            [0, 1].map(|axis| 0.5 * (corners[to][axis] - corners[from][axis]))
        };
        let (right, down) = (step(column + 1 == columns, 1), step(k + columns >= corners.len(), columns));
        let tone = |across: f32, along: f32| -> Option<f64> {
            let at = |axis: usize| (corners[k][axis] + across * right[axis] + along * down[axis]).round();
            let (x, y) = (at(0), at(1));
            let inside = x >= 0.0 && y >= 0.0 && x < picture.width as f32 && y < picture.height as f32;
            inside.then(|| f64::from(picture.data[y as usize * picture.width + x as usize]))
        };
        let alike = tone(1.0, 1.0)? + tone(-1.0, -1.0)?;
        let sign = if (row + column).is_multiple_of(2) { 1.0 } else { -1.0 };
        Some(sign * (alike - tone(1.0, -1.0)? - tone(-1.0, 1.0)?))
    };
    let Some(all) = (0..corners.len()).map(contrast).collect::<Option<Vec<f64>>>() else { return false };
    let median = median_of(all.iter().copied()).unwrap_or(0.0);
    median != 0.0 && all.iter().all(|contrast| contrast / median >= LEAST_CONTRAST)
}

/// Whether the picture shows such a board beside the one that has these corners.
pub(crate) fn shows_another(
    picture: Grey<'_>,
    corners: &Corners,
    columns: usize,
    rows: usize,
) -> Result<bool, VisionError> {
    const CALL: &str = "fillConvexPoly";
    ready()?;
    let mut data = picture.data.to_vec();
    let mut mat = Mat::new_rows_cols_with_data_mut(picture.height as i32, picture.width as i32, &mut data)
        .map_err(VisionError::of("Mat"))?;
    let border: Vector<Point> =
        border(corners, columns).into_iter().map(|[x, y]| Point::new(x as i32, y as i32)).collect();
    imgproc::fill_convex_poly(&mut mat, &border, Scalar::all(128.0), LINE_8, 0).map_err(VisionError::of(CALL))?;
    Ok(fast(&mat, Size::new(columns as i32, rows as i32))?.is_some())
}

/// The board's border, a square and a half beyond its corners.
fn border(corners: &Corners, columns: usize) -> [[f32; 2]; 4] {
    const BEYOND: f32 = 1.5;
    let last = corners.len() - columns;
    let beyond = |at: usize, beside: usize, below: usize| {
        let step = |axis: usize| 2.0 * corners[at][axis] - corners[beside][axis] - corners[below][axis];
        [0, 1].map(|axis| corners[at][axis] + BEYOND * step(axis))
    };
    [
        beyond(0, 1, columns),
        beyond(columns - 1, columns - 2, 2 * columns - 1),
        beyond(corners.len() - 1, corners.len() - 2, last - 1),
        beyond(last, last + 1, last - columns),
    ]
}

fn fast(mat: &impl ToInputArray, size: Size) -> Result<Option<Vector<Point2f>>, VisionError> {
    let mut corners = Vector::new();
    // Without the check a picture that shows no board takes ten seconds.
    let flags = CALIB_CB_ADAPTIVE_THRESH | CALIB_CB_NORMALIZE_IMAGE | CALIB_CB_FAST_CHECK;
    let found = calib3d::find_chessboard_corners(mat, size, &mut corners, flags);
    Ok(found.map_err(VisionError::of("findChessboardCorners"))?.then_some(corners))
}

/// The picture with sides of at most `longest_px`, and how many times smaller it is.
fn smaller(mat: &(impl MatTraitConst + ToInputArray), longest_px: usize) -> Result<(Mat, f64), VisionError> {
    let longer = mat.rows().max(mat.cols()) as usize;
    let times = (longer as f64 / longest_px as f64).max(1.0);
    let mut small = Mat::default();
    let share = 1.0 / times;
    imgproc::resize(mat, &mut small, Size::default(), share, share, INTER_AREA).map_err(VisionError::of("resize"))?;
    Ok((small, times))
}

/// How many inner corners the board has that is there, the more first, whatever its size; seen at this share of
/// [`GLANCE_PX`], or of the picture where that is smaller.
fn glance(mat: &(impl MatTraitConst + ToInputArray), share: f64) -> Result<Option<[usize; 2]>, VisionError> {
    let longest = GLANCE_PX.min(mat.rows().max(mat.cols()) as usize);
    let (small, _) = smaller(mat, (share * longest as f64).ceil() as usize)?;
    let (mut corners, mut meta) = (Vector::<Point2f>::new(), Mat::default());
    let (least, flags) = (Size::new(GLANCE, GLANCE), CALIB_CB_NORMALIZE_IMAGE | CALIB_CB_LARGER);
    let found = calib3d::find_chessboard_corners_sb_with_meta(&small, least, &mut corners, flags, &mut meta);
    let [rows, columns] = [meta.rows() as usize, meta.cols() as usize];
    let seen = [rows.max(columns), rows.min(columns)];
    Ok(found.map_err(VisionError::of("findChessboardCornersSBWithMeta"))?.then_some(seen))
}

/// By `findChessboardCornersSB`, on a picture whose sides are at most `longest_px`.
fn by_sectors(
    mat: &(impl MatTraitConst + ToInputArray),
    size: Size,
    longest_px: usize,
) -> Result<Option<Vector<Point2f>>, VisionError> {
    let (small, times) = smaller(mat, longest_px)?;
    let flags = CALIB_CB_NORMALIZE_IMAGE | CALIB_CB_EXHAUSTIVE;
    let mut corners: Vector<Point2f> = Vector::new();
    let found = calib3d::find_chessboard_corners_sb(&small, size, &mut corners, flags);
    if !found.map_err(VisionError::of("findChessboardCornersSB"))? {
        return Ok(None);
    }
    // Pixels' middles, not their corners, have whole coordinates.
    let back = |at: f32| ((f64::from(at) + 0.5) * times - 0.5) as f32;
    Ok(Some(corners.iter().map(|corner| Point2f::new(back(corner.x), back(corner.y))).collect()))
}

fn refine(mat: &impl ToInputArray, corners: &mut Vector<Point2f>, columns: usize) -> Result<(), VisionError> {
    const CALL: &str = "cornerSubPix";
    let all = corners.to_vec();
    let gap = |a: &Point2f, b: &Point2f| (a.x - b.x).hypot(a.y - b.y);
    let beside = all.chunks(columns).flat_map(|row| row.windows(2).map(|pair| gap(&pair[0], &pair[1])));
    let below = all.iter().zip(all.iter().skip(columns)).map(|(a, b)| gap(a, b));
    let least = beside.chain(below).fold(f32::INFINITY, f32::min);
    let half = (WINDOW_SHARE * least).clamp(WINDOW_PX[0], WINDOW_PX[1]) as i32;
    let end = TermCriteria_Type::COUNT as i32 | TermCriteria_Type::EPS as i32;
    let end = TermCriteria::new(end, 60, 1e-4).map_err(VisionError::of(CALL))?;
    imgproc::corner_sub_pix(mat, corners, Size::new(half, half), Size::new(-1, -1), end).map_err(VisionError::of(CALL))
}

#[cfg(test)]
mod tests {
    use rayon::prelude::*;

    use super::*;
    use crate::phantom::board::{BoardOptions, Picture, Scene};

    fn grey(picture: &Picture) -> Grey<'_> {
        Grey { width: picture.width as usize, height: picture.height as usize, data: &picture.data }
    }

    /// RMS distance of a view's corners from the true ones, pixels, in whatever order they are.
    fn error_px(found: &Corners, truth: &[[f64; 2]]) -> f64 {
        let gap = |at: &[f64; 2]| {
            let gaps = found.iter().map(|f| (f64::from(f[0]) - at[0]).hypot(f64::from(f[1]) - at[1]));
            gaps.fold(f64::INFINITY, f64::min)
        };
        (truth.iter().map(|at| gap(at).powi(2)).sum::<f64>() / truth.len() as f64).sqrt()
    }

    /// Measured 0.026 to 0.029 px.
    const LARGEST_PX: f64 = 0.04;

    #[test]
    fn corners_are_placed_to_a_fraction_of_a_pixel() {
        let scene = Scene::new(BoardOptions { size: (640, 480), views: 3, ..BoardOptions::default() }).unwrap();
        scene.views().par_iter().enumerate().for_each(|(k, view)| {
            let picture = scene.picture(&[*view], k as u32);
            let found = find_board(grey(&picture), 9, 6, None).unwrap();
            let Sought::Whole(found) = found else { panic!("{found:?}") };
            let error_px = error_px(&found, &scene.corners_px(view));
            assert!(error_px <= LARGEST_PX, "{error_px} px");
            assert!(!shows_another(grey(&picture), &found, 9, 6).unwrap());
            assert_eq!(glance(&grey(&picture).mat().unwrap(), 1.0).unwrap(), Some([9, 6]));
        });
    }

    #[test]
    fn a_board_of_another_size_is_said_to_be_one() {
        let scene = Scene::new(BoardOptions { size: (640, 480), views: 1, ..BoardOptions::default() }).unwrap();
        let picture = scene.picture(scene.views(), 0);
        for [columns, rows] in [[10, 7], [8, 6], [6, 10]] {
            let said = find_board(grey(&picture), columns, rows, None).unwrap();
            assert_eq!(said, Sought::OfSize([9, 6]), "{columns} x {rows}");
            assert_eq!(find_board(grey(&picture), columns, rows, Some([9, 6])).unwrap(), said);
        }
        assert!(matches!(find_board(grey(&picture), 6, 9, None).unwrap(), Sought::Whole(_)));
        let blank = Grey { width: 640, height: 480, data: &vec![90; 640 * 480] };
        assert_eq!(find_board(blank, 9, 6, None).unwrap(), Sought::Nowhere);
    }

    #[test]
    fn the_slow_search_finds_the_same_corners() {
        let scene = Scene::new(BoardOptions { size: (1280, 720), views: 1, ..BoardOptions::default() }).unwrap();
        let picture = scene.picture(scene.views(), 0);
        let seen = grey(&picture);
        let mat = seen.mat().unwrap();
        let mut corners = by_sectors(&mat, Size::new(9, 6), SLOW_SEARCH_PX).unwrap().expect("a board");
        refine(&mat, &mut corners, 9).unwrap();
        let found: Corners = corners.iter().map(|corner| [corner.x, corner.y]).collect();
        let error_px = error_px(&found, &scene.corners_px(&scene.views()[0]));
        assert!(error_px <= LARGEST_PX, "{error_px} px");
    }
}
