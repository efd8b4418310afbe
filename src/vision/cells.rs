//! Work on small pictures of three channels of f32: [`Cell`]s, row by row.

use opencv::boxed_ref::{BoxedRef, BoxedRefMut};
use opencv::core::{BORDER_REPLICATE, Mat, Point, Rect, Size};
use opencv::imgproc;
use opencv::prelude::*;

use super::{VisionError, size, view};

/// Three channels of one pixel.
pub(crate) type Cell = [f32; 3];

/// Both ways by a symmetric kernel of five, beyond the border the border's.
///
/// # Errors
/// [`VisionError`].
pub(crate) fn smoothed(
    cells: &[Cell],
    [columns, rows]: [usize; 2],
    kernel: [f32; 5],
) -> Result<Vec<Cell>, VisionError> {
    let mut out = vec![Cell::default(); cells.len()];
    into(cells, [columns, rows], &mut out, [columns, rows], |from, to| {
        let kernel = view(1, kernel.len(), &kernel)?;
        imgproc::sep_filter_2d(from, to, -1, &kernel, &kernel, Point::new(-1, -1), 0.0, BORDER_REPLICATE)
            .map_err(VisionError::of("sepFilter2D"))
    })?;
    Ok(out)
}

/// At half the size: means of four; a last odd column or row is left out.
///
/// # Errors
/// [`VisionError`].
pub(crate) fn halved(cells: &[Cell], [columns, rows]: [usize; 2]) -> Result<Vec<Cell>, VisionError> {
    let half = [columns / 2, rows / 2];
    let mut out = vec![Cell::default(); half[0] * half[1]];
    let wanted = Size::new(size(half[0])?, size(half[1])?);
    let even = Rect::new(0, 0, 2 * wanted.width, 2 * wanted.height);
    into(cells, [columns, rows], &mut out, half, |from, to| {
        let from = Mat::roi(from, even).map_err(VisionError::of("Mat"))?;
        imgproc::resize(&from, to, wanted, 0.0, 0.0, imgproc::INTER_AREA).map_err(VisionError::of("resize"))
    })?;
    Ok(out)
}

/// Calls OpenCV with `from` and `to` as pictures of these columns and rows.
fn into(
    from: &[Cell],
    [columns, rows]: [usize; 2],
    to: &mut [Cell],
    [out_columns, out_rows]: [usize; 2],
    call: impl FnOnce(&BoxedRef<'_, Mat>, &mut BoxedRefMut<'_, Mat>) -> Result<(), VisionError>,
) -> Result<(), VisionError> {
    let flat = view(rows, 3 * columns, from.as_flattened())?;
    let from = flat.reshape(3, size(rows)?).map_err(VisionError::of("reshape"))?;
    let mut flat = Mat::new_rows_cols_with_data_mut(size(out_rows)?, size(3 * out_columns)?, to.as_flattened_mut())
        .map_err(VisionError::of("Mat"))?;
    let mut to = flat.reshape_mut(3, size(out_rows)?).map_err(VisionError::of("reshape"))?;
    call(&from, &mut to)
}
