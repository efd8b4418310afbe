//! Connected parts of a picture of yes and no, and how deep its samples lie.
//!
//! In: one byte per sample, 0 for no, and the picture's width and height.

use opencv::core::{CV_8U, CV_32S, Mat};
use opencv::imgproc::{self, CCL_SAUF, DIST_L1, DIST_MASK_3};
use opencv::prelude::*;

use super::{VisionError, answered, view, view_mut};

/// Which samples are neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Neighbours {
    /// Those that share a side.
    Four,
    /// Those that share a side or a corner.
    Eight,
}

/// A connected part: its first and last column and row, how many samples it has, and their mean place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Part {
    pub(crate) left: usize,
    pub(crate) top: usize,
    pub(crate) right: usize,
    pub(crate) bottom: usize,
    pub(crate) area: usize,
    pub(crate) centroid: [f64; 2],
}

/// The parts of a picture, in the order of their first samples, row after row.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Parts {
    pub(crate) all: Vec<Part>,
    /// For each sample 0, or 1 + its part's place in `all`.
    pub(crate) labels: Vec<i32>,
}

/// The connected parts of what is set.
pub(crate) fn parts(set: &[u8], size: [usize; 2], neighbours: Neighbours) -> Parts {
    answered(try_parts(set, size, neighbours))
}

/// How many steps along rows and columns lead from each sample that is set to the nearest that is not: 1 beside it, at
/// most 255; 0 where nothing is set.
pub(crate) fn steps_out(set: &[u8], size: [usize; 2]) -> Vec<u8> {
    answered(try_steps_out(set, size))
}

fn try_parts(set: &[u8], [width, height]: [usize; 2], neighbours: Neighbours) -> Result<Parts, VisionError> {
    const CALL: &str = "connectedComponentsWithStats";
    if set.is_empty() {
        return Ok(Parts::default());
    }
    let source = view(height, width, set)?;
    let mut labels = vec![0_i32; width * height];
    let mut target = view_mut(height, width, &mut labels)?;
    let (mut stats, mut centroids) = (Mat::default(), Mat::default());
    let ways = if neighbours == Neighbours::Four { 4 } else { 8 };
    // Of OpenCV's algorithms the one that numbers parts row by row.
    imgproc::connected_components_with_stats_with_algorithm(
        &source,
        &mut target,
        &mut stats,
        &mut centroids,
        ways,
        CV_32S,
        CCL_SAUF,
    )
    .map_err(VisionError::of(CALL))?;
    drop(target);
    let stats = stats.data_typed::<i32>().map_err(VisionError::of(CALL))?.as_chunks::<5>().0;
    let centroids = centroids.data_typed::<f64>().map_err(VisionError::of(CALL))?.as_chunks::<2>().0;
    // The first part is what is not set.
    let part = |(stats, &centroid): (&[i32; 5], &[f64; 2])| {
        let [left, top, width, height, area] = stats.map(|value| value as usize);
        Part { left, top, right: left + width - 1, bottom: top + height - 1, area, centroid }
    };
    Ok(Parts { all: stats.iter().zip(centroids).skip(1).map(part).collect(), labels })
}

fn try_steps_out(set: &[u8], [width, height]: [usize; 2]) -> Result<Vec<u8>, VisionError> {
    let mut steps = vec![0; width * height];
    let source = view(height, width, set)?;
    let mut target = view_mut(height, width, &mut steps)?;
    imgproc::distance_transform(&source, &mut target, DIST_L1, DIST_MASK_3, CV_8U)
        .map_err(VisionError::of("distanceTransform"))?;
    drop(target);
    Ok(steps)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The samples that `near` names, `reach` along one axis.
    fn around(k: usize, [width, height]: [usize; 2], ways: Neighbours) -> impl Iterator<Item = usize> {
        let (x, y) = ((k % width) as i64, (k / width) as i64);
        let steps = (-1..=1).flat_map(|dy: i64| (-1..=1).map(move |dx: i64| (dx, dy)));
        steps
            .filter(move |(dx, dy)| ways == Neighbours::Eight || dx.abs() + dy.abs() == 1)
            .map(move |(dx, dy)| (x + dx, y + dy))
            .filter(move |&(x, y)| x >= 0 && y >= 0 && x < width as i64 && y < height as i64)
            .map(move |(x, y)| y as usize * width + x as usize)
    }

    /// The same by a flood.
    fn flooded(set: &[u8], size: [usize; 2], ways: Neighbours) -> Parts {
        let mut parts = Parts { all: Vec::new(), labels: vec![0; set.len()] };
        let mut stack = Vec::new();
        for start in 0..set.len() {
            if set[start] == 0 || parts.labels[start] != 0 {
                continue;
            }
            let label = parts.all.len() as i32 + 1;
            parts.labels[start] = label;
            stack.push(start);
            let (mut low, mut high, mut area, mut sum) = ([usize::MAX; 2], [0; 2], 0, [0; 2]);
            while let Some(k) = stack.pop() {
                let at = [k % size[0], k / size[0]];
                area += 1;
                for axis in 0..2 {
                    sum[axis] += at[axis];
                    (low[axis], high[axis]) = (low[axis].min(at[axis]), high[axis].max(at[axis]));
                }
                for other in around(k, size, ways) {
                    if set[other] != 0 && parts.labels[other] == 0 {
                        parts.labels[other] = label;
                        stack.push(other);
                    }
                }
            }
            let centroid = sum.map(|sum| sum as f64 / area as f64);
            parts.all.push(Part { left: low[0], top: low[1], right: high[0], bottom: high[1], area, centroid });
        }
        parts
    }

    /// The same by taking layers off.
    fn peeled(set: &[u8], size: [usize; 2]) -> Vec<u8> {
        let mut steps = vec![0; set.len()];
        for step in 1..=255 {
            let is_out = |k: usize| set[k] == 0 || (steps[k] > 0 && steps[k] < step);
            let layer: Vec<usize> = (0..set.len())
                .filter(|&k| !is_out(k))
                .filter(|&k| step == 255 || around(k, size, Neighbours::Four).any(is_out))
                .collect();
            layer.into_iter().for_each(|k| steps[k] = step);
        }
        steps
    }

    proptest! {
        #[test]
        fn parts_and_steps_are_those_of_a_flood(
            width in 1_usize..40,
            height in 1_usize..30,
            share in 0.05..0.95,
            seeds in prop::collection::vec(0.0..1.0, 1200),
        ) {
            let size = [width, height];
            let set: Vec<u8> = seeds[..width * height].iter().map(|&seed| u8::from(seed < share)).collect();
            for ways in [Neighbours::Four, Neighbours::Eight] {
                prop_assert_eq!(parts(&set, size, ways), flooded(&set, size, ways));
            }
            prop_assert_eq!(steps_out(&set, size), peeled(&set, size));
        }
    }

    #[test]
    fn nothing_and_all_have_an_answer() {
        assert_eq!(parts(&[], [0, 0], Neighbours::Four), Parts::default());
        assert!(parts(&[0; 6], [3, 2], Neighbours::Eight).all.is_empty());
        assert_eq!(steps_out(&[1; 6], [3, 2]), [255; 6]);
        assert_eq!(steps_out(&[0; 6], [3, 2]), [0; 6]);
    }
}
