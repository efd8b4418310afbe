//! The largest or smallest value about each sample: grey morphology with squares.

use opencv::core::{self, BORDER_CONSTANT, BORDER_ISOLATED, BORDER_REPLICATE, CV_8U, Mat, Point, Rect, Scalar};
use opencv::imgproc;

use super::{VisionError, answered, size, view, view_mut};

/// What to look for about each sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Extreme {
    /// How far, to each side.
    pub(crate) reach: usize,
    /// The largest value, or the smallest.
    pub(crate) largest: bool,
    /// At the border a window is moved inwards, not cut off; both sides of the picture are longer than it.
    pub(crate) whole: bool,
}

/// That value for each sample of a picture of some width and height.
pub(crate) fn extreme(values: &[f32], size: [usize; 2], what: Extreme) -> Vec<f32> {
    answered(try_extreme(values, size, what))
}

fn try_extreme(values: &[f32], [width, height]: [usize; 2], what: Extreme) -> Result<Vec<f32>, VisionError> {
    const CALL: &str = "morphologyEx";
    let mut found = vec![0.0; values.len()];
    let reach = size(what.reach)?;
    let square = Mat::new_rows_cols_with_default(2 * reach + 1, 2 * reach + 1, CV_8U, Scalar::all(1.0))
        .map_err(VisionError::of("Mat"))?;
    let source = view(height, width, values)?;
    let mut target = view_mut(height, width, &mut found)?;
    let how = if what.largest { imgproc::MORPH_DILATE } else { imgproc::MORPH_ERODE };
    let middle = Point::new(-1, -1);
    // Beyond the border there is nothing.
    let beyond = imgproc::morphology_default_border_value().map_err(VisionError::of(CALL))?;
    if what.whole {
        let mut cut = Mat::default();
        imgproc::morphology_ex(&source, &mut cut, how, &square, middle, 1, BORDER_CONSTANT, beyond)
            .map_err(VisionError::of(CALL))?;
        let inner = Rect::new(reach, reach, size(width)? - 2 * reach, size(height)? - 2 * reach);
        let inner = Mat::roi(&cut, inner).map_err(VisionError::of("Mat"))?;
        let border = BORDER_REPLICATE | BORDER_ISOLATED;
        core::copy_make_border(&inner, &mut target, reach, reach, reach, reach, border, beyond)
            .map_err(VisionError::of("copyMakeBorder"))?;
    } else {
        imgproc::morphology_ex(&source, &mut target, how, &square, middle, 1, BORDER_CONSTANT, beyond)
            .map_err(VisionError::of(CALL))?;
    }
    drop(target);
    Ok(found)
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    /// The same window by window.
    fn looked_up(values: &[f32], size: [usize; 2], what: Extreme) -> Vec<f32> {
        let range = |at: usize, count: usize| {
            let last = count - 1;
            let at = if what.whole { at.clamp(what.reach, last - what.reach) } else { at };
            at.saturating_sub(what.reach)..=(at + what.reach).min(last)
        };
        let one = |k: usize| {
            let (across, down) = (range(k % size[0], size[0]), range(k / size[0], size[1]));
            let window = down.flat_map(|y| across.clone().map(move |x| values[y * size[0] + x]));
            window.reduce(if what.largest { f32::max } else { f32::min }).unwrap()
        };
        (0..values.len()).map(one).collect()
    }

    /// Prints how long OpenCV takes, and a look at each window.
    #[test]
    fn extremes_are_those_of_each_window() {
        let size = [96, 70];
        let values: Vec<f32> = (0..96 * 70).map(|k| (k * 37 % 251) as f32 + 0.25).collect();
        for (largest, whole) in [(true, true), (true, false), (false, true), (false, false)] {
            let what = Extreme { reach: 10, largest, whole };
            let start = Instant::now();
            let found = extreme(&values, size, what);
            let (theirs, start) = (start.elapsed(), Instant::now());
            assert_eq!(found, looked_up(&values, size, what), "{what:?}");
            println!("96 x 70 samples, reach 10: OpenCV {theirs:?}, each window {:?}", start.elapsed());
        }
    }
}
