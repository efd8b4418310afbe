//! A picture smoothed a little.

use opencv::core::{BORDER_REPLICATE, CV_32F, Point};
use opencv::imgproc;

use super::{VisionError, answered, view, view_mut};

/// Values smoothed by (1 2 1)/4 across and down, as if the picture's border went on; of some width and height.
pub(crate) fn smoothed(values: &[f32], size: [usize; 2]) -> Vec<f32> {
    answered(try_smoothed(values, size))
}

fn try_smoothed(values: &[f32], [width, height]: [usize; 2]) -> Result<Vec<f32>, VisionError> {
    let mut smooth = vec![0.0; values.len()];
    if values.is_empty() {
        return Ok(smooth);
    }
    let filter = [0.25_f32, 0.5, 0.25];
    let (source, filter) = (view(height, width, values)?, view(1, filter.len(), &filter)?);
    let mut target = view_mut(height, width, &mut smooth)?;
    let middle = Point::new(-1, -1);
    imgproc::sep_filter_2d(&source, &mut target, CV_32F, &filter, &filter, middle, 0.0, BORDER_REPLICATE)
        .map_err(VisionError::of("sepFilter2D"))?;
    drop(target);
    Ok(smooth)
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    /// The same, sample by sample.
    fn summed(values: &[f32], [width, height]: [usize; 2]) -> Vec<f32> {
        let at = |x: i64, y: i64| {
            let (x, y) = (x.clamp(0, width as i64 - 1), y.clamp(0, height as i64 - 1));
            values[y as usize * width + x as usize]
        };
        let row = |x: i64, y: i64| 0.25 * (at(x - 1, y) + at(x + 1, y)) + 0.5 * at(x, y);
        let one = |x: i64, y: i64| 0.25 * (row(x, y - 1) + row(x, y + 1)) + 0.5 * row(x, y);
        (0..values.len()).map(|k| one((k % width) as i64, (k / width) as i64)).collect()
    }

    /// Prints how long OpenCV takes, and sums sample by sample.
    #[test]
    fn smooth_values_are_the_sums() {
        for size in [[640, 360], [2, 3], [1, 1]] {
            let values: Vec<f32> = (0..size[0] * size[1]).map(|k| (k * 37 % 251) as f32 - 128.0).collect();
            let start = Instant::now();
            let found = smoothed(&values, size);
            let (theirs, start) = (start.elapsed(), Instant::now());
            assert_eq!(found, summed(&values, size));
            println!("{size:?} samples smoothed: OpenCV {theirs:?}, sums {:?}", start.elapsed());
        }
        assert!(smoothed(&[], [0, 4]).is_empty());
    }
}
