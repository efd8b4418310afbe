//! Lenses from corners with known errors: how far off, and whether the standard errors say so.

use nalgebra::{DMatrix, DVector, Vector3};

use super::board::BoardSize;
use super::fit::{Fit, OF_LENS, fit};
use super::judge::{View, warnings};
use crate::phantom::board::{BoardOptions, Scene};
use crate::trial::normals;
use crate::vision::{Corners, Intrinsics, undistorted};

const BOARD: BoardSize = BoardSize { columns: 9, rows: 6 };
const SIZE: (usize, usize) = (1280, 720);
/// The errors of corners, a coordinate's standard deviation.
const NOISE_PX: f64 = 0.1;
const TRUTH: [f64; OF_LENS] = [1210.0, 1195.0, 645.0, 352.0, -0.2, 0.05, 0.001, -0.0005, 0.01];

fn options(seed: u64, views: usize) -> BoardOptions {
    let [fx, fy, cx, cy, distortion @ ..] = TRUTH;
    BoardOptions {
        seed,
        views,
        fx: Some(fx),
        fy: Some(fy),
        centre: Some([cx, cy]),
        distortion: distortion.to_vec(),
        ..BoardOptions::default()
    }
}

/// The corners of a scene's views, with errors.
fn corners(options: &BoardOptions, noise_px: f64) -> Vec<Corners> {
    let scene = Scene::new(options.clone()).unwrap();
    let mut normal = normals(options.seed + 1000);
    let mut off = |at: f64| (at + noise_px * normal()) as f32;
    scene.views().iter().map(|view| scene.corners_px(view).into_iter().map(|at| at.map(&mut off)).collect()).collect()
}

fn fitted(views: &[Corners], coefficients: usize) -> Fit {
    fit(&BOARD.points_mm(20.0), views, SIZE, coefficients).unwrap().expect("a lens")
}

fn parameters(lens: &Intrinsics) -> [f64; OF_LENS] {
    let ([fx, fy], [cx, cy], [k1, k2, p1, p2, k3]) = (lens.focal_px, lens.centre_px, lens.distortion);
    [fx, fy, cx, cy, k1, k2, p1, p2, k3]
}

/// How far off a lens undistorts points over the picture, root mean squares, pixels.
struct Gap {
    /// As OpenCV's `undistortPoints` with P = K: each lens to pixels of its own focal lengths and axis.
    own: f64,
    /// What is left of it by the perspective that fits best: lines that are still bent. The rest any plane of known
    /// points takes up, as `--plane` does.
    bent: f64,
}

fn undistorted_gap(fit: &Fit, truth: &[f64; OF_LENS]) -> Gap {
    let at = |k: usize, count: usize, side: usize| (k as f64 + 0.5) / count as f64 * side as f64 - 0.5;
    let grid: Vec<[f64; 2]> = (0..32 * 18).map(|k| [at(k % 32, 32, SIZE.0), at(k / 32, 18, SIZE.1)]).collect();
    let [fx, fy, cx, cy, distortion @ ..] = *truth;
    let truth = Intrinsics { focal_px: [fx, fy], centre_px: [cx, cy], distortion };
    let [found, straight] = [&fit.lens, &truth].map(|lens| undistorted(&grid, lens).unwrap());
    let rms = |off: &DVector<f64>| off.norm() / (grid.len() as f64).sqrt();
    let off = DVector::from_fn(2 * grid.len(), |row, _| found[row / 2][row % 2] - straight[row / 2][row % 2]);
    // The eight ways in which a perspective near none moves (x, y): linear, a shift, and (x, y) times x and times y.
    let ways = DMatrix::from_fn(2 * grid.len(), 8, |row, way| {
        let ([x, y], axis) = (straight[row / 2].map(|at| at / SIZE.0 as f64), row % 2);
        let moved = [[x, 0.0], [y, 0.0], [1.0, 0.0], [0.0, x], [0.0, y], [0.0, 1.0], [x * x, x * y], [y * x, y * y]];
        moved[way][axis]
    });
    let taken_up = &ways * ways.clone().svd(true, true).solve(&off, 1e-12).unwrap();
    Gap { own: rms(&off), bent: rms(&(off - taken_up)) }
}

#[test]
fn without_errors_the_lens_is_exact() {
    let fit = fitted(&corners(&options(1, 8), 0.0), 5);
    let errors: Vec<f64> =
        parameters(&fit.lens).iter().zip(TRUTH).map(|(found, truth)| (found - truth).abs()).collect();
    // Corners are rounded to 32 bits, 6e-5 px; measured 0.01 px and 2e-4.
    assert!(
        errors[..4].iter().all(|error| *error <= 0.02) && errors[4..].iter().all(|error| *error <= 2e-3),
        "{errors:?}"
    );
    assert!(fit.rms_px <= 1e-4, "{}", fit.rms_px);
}

const SEEDS: u64 = 50;

/// What many fits of twelve views come to.
struct Many {
    /// Fits in which one standard error, and 1.96, hold the truth, of each parameter.
    within: [[u32; OF_LENS]; 2],
    /// Errors in ascending order: of the focal lengths, as a share, and of undistorted points ([`Gap`]), pixels.
    focal: Vec<f64>,
    gaps_px: Vec<f64>,
    bent_px: Vec<f64>,
    /// Root mean square of the gaps, over what their standard errors say.
    ratio: f64,
}

fn many(coefficients: usize, noise_px: f64) -> Many {
    let mut truth = TRUTH;
    if coefficients == 4 {
        truth[8] = 0.0;
    }
    let mut many = Many { within: [[0; OF_LENS]; 2], focal: vec![], gaps_px: vec![], bent_px: vec![], ratio: 0.0 };
    let mut claimed = 0.0;
    for seed in 0..SEEDS {
        let options = BoardOptions { distortion: truth[4..].to_vec(), ..options(seed, 12) };
        let fit = fitted(&corners(&options, noise_px), coefficients);
        let (found, sd) = (parameters(&fit.lens), fit.sd());
        for k in 0..OF_LENS {
            let off = (found[k] - truth[k]).abs();
            many.within[0][k] += u32::from(off <= sd[k]);
            many.within[1][k] += u32::from(off <= 1.96 * sd[k]);
        }
        many.focal.push(((found[0] / truth[0] - 1.0).abs()).max((found[1] / truth[1] - 1.0).abs()));
        let gap = undistorted_gap(&fit, &truth);
        many.gaps_px.push(gap.own);
        many.bent_px.push(gap.bent);
        claimed += fit.undistorted_sd_px(SIZE).unwrap().powi(2);
    }
    many.ratio = (many.gaps_px.iter().map(|gap| gap * gap).sum::<f64>() / claimed).sqrt();
    many.focal.sort_unstable_by(f64::total_cmp);
    many.gaps_px.sort_unstable_by(f64::total_cmp);
    many.bent_px.sort_unstable_by(f64::total_cmp);
    let (f, g, b) = (&many.focal, &many.gaps_px, &many.bent_px);
    eprintln!(
        "{coefficients} coefficients, {noise_px} px: focal {:.5}, {:.5}, {:.5}; undistorted {:.3}, {:.3}, {:.3} px, \
         bent {:.3}, {:.3}, {:.3} px (median, 90 %, worst), {:.2} of its standard error; within {:?}",
        f[25], f[44], f[49], g[25], g[44], g[49], b[25], b[44], b[49], many.ratio, many.within
    );
    many
}

/// Twelve views, corners to 0.1 px: focal lengths to 0.2 % in 90 % of fits (measured 0.14), standard errors that hold
/// the truth; and how well points are undistorted (90 % of fits) and lines straightened (median: measured 0.102, 0.054
/// and 0.016 px), with corners to 0.1 and to 0.03 px.
#[test]
fn twelve_views_give_the_lens_and_its_standard_errors() {
    for (coefficients, noise_px, largest_bent_px) in [(5, NOISE_PX, 0.11), (4, NOISE_PX, 0.06), (4, 0.03, 0.02)] {
        let many = many(coefficients, noise_px);
        let [one, two] = many.within;
        assert!(many.focal[44] <= 0.002, "focal length: {:?}", many.focal);
        assert!(many.gaps_px[44] <= 0.6, "undistorted: {:?}", many.gaps_px);
        assert!(many.bent_px[25] <= largest_bent_px, "bent: {:?}", many.bent_px);
        assert!(two.iter().all(|held| *held >= 45), "{two:?}");
        let free = if coefficients == 4 { 8 } else { 9 };
        let share = f64::from(one[..free].iter().sum::<u32>()) / (free as f64 * SEEDS as f64);
        assert!((0.58..=0.78).contains(&share), "one standard error holds the truth in {share}");
        assert!((0.7..=1.4).contains(&many.ratio), "{}", many.ratio);
    }
}

#[test]
fn the_planes_standard_error_holds_the_truth() {
    let mut held = 0;
    for seed in 0..SEEDS {
        let options = options(seed, 12);
        let fit = fitted(&corners(&options, NOISE_PX), 5);
        let truth = *Scene::new(options).unwrap().views().last().unwrap();
        let truth = -(truth.rotation * Vector3::z());
        let view = fit.views.last().unwrap();
        let off = view.normal() - truth;
        let worst = view.normal_covariance().symmetric_eigenvalues().max().sqrt();
        // Chi-square of two degrees of freedom, at most the worst direction's: 95 % within 2.45.
        held += u32::from(off.norm() <= 2.45 * worst);
    }
    eprintln!("plane held in {held} of {SEEDS}");
    assert!(held >= 45, "{held} of {SEEDS}");
}

/// The slow twin: what OpenCV says of itself, but for its divisor.
#[test]
fn standard_errors_are_opencvs_with_twice_the_points() {
    let views = corners(&options(3, 12), NOISE_PX);
    let fit = fitted(&views, 5);
    let opencv = crate::vision::opencvs_sd(&BOARD.points_mm(20.0), &views, SIZE).unwrap();
    let (points, free) = (12.0 * 54.0, 12.0 * 6.0 + 9.0);
    let divisor: f64 = (2.0 * points - free) / (points - free);
    for (k, (own, theirs)) in fit.sd().iter().zip(opencv).enumerate() {
        let ratio = theirs / own;
        eprintln!("{k}: {ratio}, expected {}", divisor.sqrt());
        assert!((ratio / divisor.sqrt() - 1.0).abs() <= 1e-3, "{k}: {ratio}");
    }
}

/// A board that is a little longer one way passes for a camera of oblong pixels, which there hardly are.
#[test]
fn a_board_that_is_longer_one_way_is_warned_of_by_the_pixels() {
    let said = |longer: f64, seed: u64| {
        let views = corners(&BoardOptions { fy: Some(TRUTH[0]), ..options(seed, 12) }, NOISE_PX);
        let points: Vec<[f64; 3]> = BOARD.points_mm(20.0).iter().map(|[x, y, z]| [x / longer, *y, *z]).collect();
        let fit = fit(&points, &views, SIZE, 5).unwrap().expect("a lens");
        let views: Vec<View> = views.into_iter().map(|corners| View { name: "v".to_owned(), corners }).collect();
        warnings(&fit, &views, 1.0, BOARD).into_iter().filter(|said| said.contains("square pixels")).collect::<Vec<_>>()
    };
    for seed in 0..10 {
        assert_eq!(said(1.0, seed), [""; 0], "{seed}");
        let [wider, taller] = [1.01, 0.99].map(|longer| said(longer, seed).concat());
        assert!(wider.contains("larger than fy") && wider.contains("shorter from row to row"), "{seed}: {wider}");
        assert!(taller.contains("smaller than fy") && taller.contains("longer from row to row"), "{seed}: {taller}");
    }
}

/// Standard errors are those of noise; a board that is longer one way than it is said to be leaves what is none.
#[test]
fn what_is_no_noise_goes_together_in_neighbours() {
    let points = BOARD.points_mm(20.0);
    let longer: Vec<[f64; 3]> = points.iter().map(|[x, y, z]| [1.02 * x, *y, *z]).collect();
    let (mut noise, mut least) = (0.0_f64, f64::INFINITY);
    for seed in 0..10 {
        let views = corners(&options(seed, 12), NOISE_PX);
        let together =
            |points: &[[f64; 3]]| fit(points, &views, SIZE, 5).unwrap().expect("a lens").neighbours(BOARD.columns);
        noise = noise.max(together(&points).abs());
        least = least.min(together(&longer));
    }
    eprintln!("noise at most {noise:.2}, longer by 2 % at least {least:.2}");
    assert!(noise < 0.12 && least > 0.25, "{noise} {least}");
}
