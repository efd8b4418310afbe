//! Work on small pictures of f32, row by row.

use opencv::boxed_ref::{BoxedRef, BoxedRefMut};
use opencv::core::{BORDER_REPLICATE, Mat, Point, Rect, Size};
use opencv::imgproc;
use opencv::prelude::*;

use super::{VisionError, answered, size, view, view_mut};

/// Three channels of one pixel.
pub(crate) type Cell = [f32; 3];

/// Both ways by a symmetric kernel, beyond the border the border's.
pub(crate) fn smoothed<const CHANNELS: usize, const TAPS: usize>(
    cells: &[[f32; CHANNELS]],
    size: [usize; 2],
    kernel: [f32; TAPS],
) -> Vec<[f32; CHANNELS]> {
    if cells.is_empty() {
        return Vec::new();
    }
    let filtered = |from: &BoxedRef<'_, Mat>, to: &mut BoxedRefMut<'_, Mat>| {
        let kernel = view(1, kernel.len(), &kernel)?;
        imgproc::sep_filter_2d(from, to, -1, &kernel, &kernel, Point::new(-1, -1), 0.0, BORDER_REPLICATE)
            .map_err(VisionError::of("sepFilter2D"))
    };
    answered(made(cells, size, size, filtered))
}

/// By a Gaussian of some SD in pixels, beyond the border the picture's mirror image.
pub(crate) fn blurred(values: &[f32], size: [usize; 2], sd_px: f64) -> Vec<f32> {
    let filtered = |from: &BoxedRef<'_, Mat>, to: &mut BoxedRefMut<'_, Mat>| {
        imgproc::gaussian_blur_def(from, to, Size::new(0, 0), sd_px).map_err(VisionError::of("GaussianBlur"))
    };
    answered(made(values.as_chunks::<1>().0, size, size, filtered)).into_flattened()
}

/// Means over blocks of `block` x `block`, and how many there are across and down; what is left over to the right and
/// below is left out.
pub(crate) fn reduced<const CHANNELS: usize>(
    cells: &[[f32; CHANNELS]],
    size: [usize; 2],
    block: usize,
) -> (Vec<[f32; CHANNELS]>, [usize; 2]) {
    let to = size.map(|n| n / block);
    let mean = |from: &BoxedRef<'_, Mat>, means: &mut BoxedRefMut<'_, Mat>| {
        let (columns, rows, block) = (means.cols(), means.rows(), super::size(block)?);
        let whole = Rect::new(0, 0, columns * block, rows * block);
        let from = Mat::roi(from, whole).map_err(VisionError::of("Mat"))?;
        let size = Size::new(columns, rows);
        imgproc::resize(&from, means, size, 0.0, 0.0, imgproc::INTER_AREA).map_err(VisionError::of("resize"))
    };
    (answered(made(cells, size, to, mean)), to)
}

/// How well `patch` fits at each place of a picture at which all of it lies within: correlation, -1 to 1, row by row of
/// (columns less the patch's, plus one). Nothing where the patch is the larger.
pub(crate) fn matched(picture: &[f32], size: [usize; 2], patch: &[f32], patch_size: [usize; 2]) -> Vec<f32> {
    answered(try_matched(picture, size, patch, patch_size))
}

fn try_matched(
    picture: &[f32],
    [columns, rows]: [usize; 2],
    patch: &[f32],
    [across, down]: [usize; 2],
) -> Result<Vec<f32>, VisionError> {
    if across > columns || down > rows || patch.is_empty() {
        return Ok(Vec::new());
    }
    let (wide, high) = (columns - across + 1, rows - down + 1);
    let mut fits = vec![0.0; wide * high];
    let (picture, patch) = (view(rows, columns, picture)?, view(down, across, patch)?);
    let mut to = view_mut(high, wide, &mut fits)?;
    imgproc::match_template(&picture, &patch, &mut to, imgproc::TM_CCOEFF_NORMED, &Mat::default())
        .map_err(VisionError::of("matchTemplate"))?;
    drop(to);
    Ok(fits)
}

/// What OpenCV's `call` makes of `cells`, at another size or the same.
fn made<const CHANNELS: usize>(
    cells: &[[f32; CHANNELS]],
    [columns, rows]: [usize; 2],
    [to_columns, to_rows]: [usize; 2],
    call: impl FnOnce(&BoxedRef<'_, Mat>, &mut BoxedRefMut<'_, Mat>) -> Result<(), VisionError>,
) -> Result<Vec<[f32; CHANNELS]>, VisionError> {
    let mut out = vec![[0.0; CHANNELS]; to_columns * to_rows];
    let channels = size(CHANNELS)?;
    let from = view(rows, CHANNELS * columns, cells.as_flattened())?;
    let from = from.reshape(channels, size(rows)?).map_err(VisionError::of("reshape"))?;
    let mut to = view_mut(to_rows, CHANNELS * to_columns, out.as_flattened_mut())?;
    call(&from, &mut to.reshape_mut(channels, size(to_rows)?).map_err(VisionError::of("reshape"))?)?;
    drop(to);
    Ok(out)
}

#[cfg(test)]
mod tests {
    use std::hint::black_box;
    use std::time::Instant;

    use rand::{RngExt, SeedableRng};

    use super::*;

    fn random(size: [usize; 2]) -> Vec<Cell> {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        (0..size[0] * size[1]).map(|_| std::array::from_fn(|_| random.random_range(-3.0..3.0))).collect()
    }

    /// The same a pixel at a time.
    fn plainly_smoothed(cells: &[Cell], [columns, rows]: [usize; 2], kernel: [f32; 5]) -> Vec<Cell> {
        let held = |at: usize, tap: usize, end: usize| (at + tap).saturating_sub(2).min(end - 1);
        let sum = |value: &dyn Fn(usize) -> Cell| -> Cell {
            std::array::from_fn(|c| kernel.iter().enumerate().map(|(tap, weight)| weight * value(tap)[c]).sum())
        };
        let places = || (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
        let across: Vec<Cell> = places().map(|(x, y)| sum(&|tap| cells[y * columns + held(x, tap, columns)])).collect();
        places().map(|(x, y)| sum(&|tap| across[held(y, tap, rows) * columns + x])).collect()
    }

    #[test]
    fn a_patch_fits_best_where_it_was_cut_out() {
        let (size, patch_size) = ([40, 30], [9, 7]);
        let picture: Vec<f32> = random(size).iter().map(|cell| cell[0]).collect();
        let patch: Vec<f32> = (0..63).map(|k| 3.0 * picture[(11 + k / 9) * 40 + 21 + k % 9] - 1.0).collect();
        let fits = matched(&picture, size, &patch, patch_size);
        let best = (0..fits.len()).max_by(|&a, &b| fits[a].total_cmp(&fits[b])).unwrap();
        assert_eq!((best % 32, best / 32), (21, 11));
        // A gain and an offset change nothing; measured 1e-6.
        assert!((fits[best] - 1.0).abs() <= 1e-4, "{}", fits[best]);
        assert!(matched(&patch, patch_size, &picture, size).is_empty());
    }

    fn plainly_halved(cells: &[Cell], [columns, rows]: [usize; 2]) -> Vec<Cell> {
        let places = (0..rows / 2).flat_map(|y| (0..columns / 2).map(move |x| 2 * y * columns + 2 * x));
        let mean = |at: usize| {
            std::array::from_fn(|c| [0, 1, columns, columns + 1].iter().map(|d| cells[at + d][c]).sum::<f32>() / 4.0)
        };
        places.map(mean).collect()
    }

    /// Prints what OpenCV and plain loops take.
    #[test]
    fn plain_loops_give_the_same() {
        let kernel = [0.0625, 0.25, 0.375, 0.25, 0.0625];
        let time = |work: &dyn Fn() -> Vec<Cell>| {
            let start = Instant::now();
            (0..50).for_each(|_| drop(black_box(work())));
            start.elapsed() / 50
        };
        for size in [[69, 69], [61, 47], [5, 2]] {
            let cells = random(size);
            type Work<'a> = &'a dyn Fn() -> Vec<Cell>;
            let pairs: [(&str, Work<'_>, Work<'_>); 2] = [
                ("smoothed", &|| plainly_smoothed(&cells, size, kernel), &|| smoothed(&cells, size, kernel)),
                ("halved", &|| plainly_halved(&cells, size), &|| reduced(&cells, size, 2).0),
            ];
            for (name, plain, opencv) in pairs {
                let both = plain().into_iter().flatten().zip(opencv().into_iter().flatten());
                let apart = both.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(apart <= 1e-6, "{name} {size:?}: {apart}");
                println!("{name} {size:?}: loops {:?}, OpenCV {:?}, apart {apart:.0e}", time(plain), time(opencv));
            }
        }
    }
}
