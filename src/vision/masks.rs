//! Work on masks: bytes, row by row, 0 outside.

use opencv::core::{self, BORDER_CONSTANT, Mat, Point, Scalar, Vector};
use opencv::imgproc;

use super::{VisionError, pixels, pixels_mut, size};

/// A mask of 0 and 1 of the polygon with these corners, its border among it.
///
/// # Errors
/// [`VisionError`].
pub(crate) fn filled(corners: &[[i32; 2]], [width, height]: [usize; 2]) -> Result<Vec<u8>, VisionError> {
    let mut mask = vec![0; width * height];
    let corners: Vector<Point> = corners.iter().map(|c| Point::new(c[0], c[1])).collect();
    let mut to = pixels_mut::<u8>(height, width, &mut mask)?;
    imgproc::fill_poly(&mut to, &corners, Scalar::all(1.0), imgproc::LINE_8, 0, Point::default())
        .map_err(VisionError::of("fillPoly"))?;
    drop(to);
    Ok(mask)
}

/// Steps along rows and columns from each pixel to the nearest one of `mask`.
///
/// # Errors
/// [`VisionError`].
pub(crate) fn steps_to(mask: &[u8], [width, height]: [usize; 2]) -> Result<Vec<f32>, VisionError> {
    let outside: Vec<u8> = mask.iter().map(|&value| u8::from(value == 0)).collect();
    let mut steps = vec![0.0_f32; mask.len()];
    let from = pixels::<u8>(height, width, &outside)?;
    let mut to =
        Mat::new_rows_cols_with_data_mut(size(height)?, size(width)?, &mut steps).map_err(VisionError::of("Mat"))?;
    imgproc::distance_transform(&from, &mut to, imgproc::DIST_L1, imgproc::DIST_MASK_3, core::CV_32F)
        .map_err(VisionError::of("distanceTransform"))?;
    drop(to);
    Ok(steps)
}

/// Less what a cross of five pixels does not fit into.
///
/// # Errors
/// [`VisionError`].
pub(crate) fn opened(mask: &[u8], [width, height]: [usize; 2]) -> Result<Vec<u8>, VisionError> {
    let mut out = vec![0; mask.len()];
    let from = pixels::<u8>(height, width, mask)?;
    let mut to = pixels_mut::<u8>(height, width, &mut out)?;
    let cross = imgproc::get_structuring_element(imgproc::MORPH_CROSS, core::Size::new(3, 3), Point::new(-1, -1))
        .map_err(VisionError::of("getStructuringElement"))?;
    let beyond = imgproc::morphology_default_border_value().map_err(VisionError::of("morphologyEx"))?;
    let middle = Point::new(-1, -1);
    imgproc::morphology_ex(&from, &mut to, imgproc::MORPH_OPEN, &cross, middle, 1, BORDER_CONSTANT, beyond)
        .map_err(VisionError::of("morphologyEx"))?;
    drop(to);
    Ok(out)
}

/// Otsu's level of these bytes (doi:10.1109/TSMC.1979.4310076): what is above belongs to the lighter kind.
///
/// # Errors
/// [`VisionError`].
pub(crate) fn otsu_level(bytes: &[u8]) -> Result<u8, VisionError> {
    let from = pixels::<u8>(1, bytes.len(), bytes)?;
    let level = imgproc::threshold(&from, &mut Mat::default(), 0.0, 255.0, imgproc::THRESH_OTSU)
        .map_err(VisionError::of("threshold"))?;
    Ok(level as u8)
}

/// The borders of the mask's regions and of their holes: pixels of the region, in order, `[x, y]`.
///
/// # Errors
/// [`VisionError`].
pub(crate) fn borders(mask: &[u8], [width, height]: [usize; 2]) -> Result<Vec<Vec<[i32; 2]>>, VisionError> {
    let from = pixels::<u8>(height, width, mask)?;
    let mut found = Vector::<Vector<Point>>::new();
    imgproc::find_contours(&from, &mut found, imgproc::RETR_LIST, imgproc::CHAIN_APPROX_NONE, Point::default())
        .map_err(VisionError::of("findContours"))?;
    Ok(found.iter().map(|border| border.iter().map(|p| [p.x, p.y]).collect()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mask(rows: &[&str]) -> (Vec<u8>, [usize; 2]) {
        (rows.iter().flat_map(|row| row.bytes().map(|b| u8::from(b == b'#'))).collect(), [rows[0].len(), rows.len()])
    }

    #[test]
    fn a_polygon_holds_its_border() {
        let (expected, size) = mask(&[".....", ".###.", ".###.", ".###.", "....."]);
        assert_eq!(filled(&[[1, 1], [3, 1], [3, 3], [1, 3]], size), Ok(expected));
        assert!(filled(&[], size).is_err());
    }

    #[test]
    fn steps_go_along_rows_and_columns() {
        let (one, size) = mask(&["#....", ".....", ".....", "...#."]);
        let steps = steps_to(&one, size).expect("steps");
        assert_eq!([0, 4, 6, 9, 18].map(|at| steps[at]), [0.0, 4.0, 2.0, 3.0, 0.0]);
        // 5 + 1 to the left one above, 1 + 1 to the other.
        assert_eq!(steps[12], 2.0);
    }

    #[test]
    fn opening_leaves_what_a_cross_fits_into() {
        let (before, size) = mask(&["#.....", "..##..", ".####.", "..##..", ".....#"]);
        let (after, _) = mask(&["......", "..##..", ".####.", "..##..", "......"]);
        assert_eq!(opened(&before, size), Ok(after));
        assert!(opened(&before, [6, 6]).is_err());
    }

    #[test]
    fn the_level_parts_two_kinds() {
        let bytes: Vec<u8> = (0..200).map(|k| if k % 3 == 0 { 40 + k as u8 % 5 } else { 190 + k as u8 % 7 }).collect();
        assert!((44..190).contains(&otsu_level(&bytes).expect("a level")));
    }

    #[test]
    fn borders_are_of_regions_and_holes() {
        let (ring, size) = mask(&[".....", ".###.", ".#.#.", ".###.", "....."]);
        let found = borders(&ring, size).expect("borders");
        assert_eq!(found.len(), 2);
        assert!(found.iter().flatten().all(|p| ring[p[1] as usize * 5 + p[0] as usize] == 1));
        assert_eq!(found.iter().map(Vec::len).max(), Some(8));
        assert!(borders(&[0; 25], size).expect("none").is_empty());
    }
}
