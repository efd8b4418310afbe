//! What OpenCV makes of work that stays our own, to compare.

use opencv::core::{Mat, Rect, Size};
use opencv::imgproc::{self, INTER_AREA};

use super::{VisionError, answered, view, view_mut};

/// A part of whole samples (column, row, width, height), averaged to some columns and rows.
pub(crate) fn reduced_part(values: &[f32], [width, height]: [usize; 2], part: [i32; 4], to: [usize; 2]) -> Vec<f32> {
    let mut out = vec![0.0; to[0] * to[1]];
    let mut work = || -> Result<(), VisionError> {
        let source = view(height, width, values)?;
        let part = Mat::roi(&source, Rect::new(part[0], part[1], part[2], part[3])).map_err(VisionError::of("Mat"))?;
        let mut target = view_mut(to[1], to[0], &mut out)?;
        let to = Size::new(to[0] as i32, to[1] as i32);
        imgproc::resize(&part, &mut target, to, 0.0, 0.0, INTER_AREA).map_err(VisionError::of("resize"))
    };
    answered(work());
    out
}
