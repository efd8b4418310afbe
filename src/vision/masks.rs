//! Work on masks: bytes, row by row, 0 outside.

use opencv::core::{BORDER_CONSTANT, Mat, Point, Scalar, Size, Vector};
use opencv::imgproc;

use super::{VisionError, answered, pixels, pixels_mut};

/// A mask of 0 and 1 of the polygon with these corners, its border among it.
pub(crate) fn filled(corners: &[[i32; 2]], size: [usize; 2]) -> Vec<u8> {
    answered(try_filled(corners, size))
}

fn try_filled(corners: &[[i32; 2]], [width, height]: [usize; 2]) -> Result<Vec<u8>, VisionError> {
    let mut mask = vec![0; width * height];
    let corners: Vector<Point> = corners.iter().map(|c| Point::new(c[0], c[1])).collect();
    let mut to = pixels_mut::<u8>(height, width, &mut mask)?;
    imgproc::fill_poly(&mut to, &corners, Scalar::all(1.0), imgproc::LINE_8, 0, Point::default())
        .map_err(VisionError::of("fillPoly"))?;
    drop(to);
    Ok(mask)
}

/// Less what a rhombus that reaches `steps` pixels from its middle does not fit into; beyond the mask it does.
pub(crate) fn opened(mask: &[u8], size: [usize; 2], steps: usize) -> Vec<u8> {
    answered(try_opened(mask, size, steps))
}

fn try_opened(mask: &[u8], [width, height]: [usize; 2], steps: usize) -> Result<Vec<u8>, VisionError> {
    let mut out = vec![0; mask.len()];
    let from = pixels::<u8>(height, width, mask)?;
    let mut to = pixels_mut::<u8>(height, width, &mut out)?;
    let cross = imgproc::get_structuring_element(imgproc::MORPH_CROSS, Size::new(3, 3), Point::new(-1, -1))
        .map_err(VisionError::of("getStructuringElement"))?;
    let beyond = imgproc::morphology_default_border_value().map_err(VisionError::of("morphologyEx"))?;
    let middle = Point::new(-1, -1);
    imgproc::morphology_ex(&from, &mut to, imgproc::MORPH_OPEN, &cross, middle, steps as i32, BORDER_CONSTANT, beyond)
        .map_err(VisionError::of("morphologyEx"))?;
    drop(to);
    Ok(out)
}

/// Otsu's level of these bytes (doi:10.1109/TSMC.1979.4310076): what is above belongs to the lighter kind.
pub(crate) fn otsu_level(bytes: &[u8]) -> u8 {
    answered(try_otsu_level(bytes))
}

fn try_otsu_level(bytes: &[u8]) -> Result<u8, VisionError> {
    let from = pixels::<u8>(1, bytes.len(), bytes)?;
    let level = imgproc::threshold(&from, &mut Mat::default(), 0.0, 255.0, imgproc::THRESH_OTSU)
        .map_err(VisionError::of("threshold"))?;
    Ok(level as u8)
}

/// The borders of the mask's regions and of their holes: pixels of the region, in order, `[x, y]`.
pub(crate) fn borders(mask: &[u8], size: [usize; 2]) -> Vec<Vec<[i32; 2]>> {
    answered(try_borders(mask, size))
}

fn try_borders(mask: &[u8], [width, height]: [usize; 2]) -> Result<Vec<Vec<[i32; 2]>>, VisionError> {
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
        assert_eq!(filled(&[[1, 1], [3, 1], [3, 3], [1, 3]], size), expected);
        assert!(try_filled(&[], size).is_err());
    }

    #[test]
    fn opening_leaves_what_a_cross_fits_into() {
        let (before, size) = mask(&["#.....", "..##..", ".####.", "..##..", ".....#"]);
        let (after, _) = mask(&["......", "..##..", ".####.", "..##..", "......"]);
        assert_eq!(opened(&before, size, 1), after);
        assert!(try_opened(&before, [6, 6], 1).is_err());
    }

    #[test]
    fn the_level_parts_two_kinds() {
        let bytes: Vec<u8> = (0..200).map(|k| if k % 3 == 0 { 40 + k as u8 % 5 } else { 190 + k as u8 % 7 }).collect();
        assert!((44..190).contains(&otsu_level(&bytes)));
    }

    #[test]
    fn borders_are_of_regions_and_holes() {
        let (ring, size) = mask(&[".....", ".###.", ".#.#.", ".###.", "....."]);
        let found = borders(&ring, size);
        assert_eq!(found.len(), 2);
        assert!(found.iter().flatten().all(|p| ring[p[1] as usize * 5 + p[0] as usize] == 1));
        assert_eq!(found.iter().map(Vec::len).max(), Some(8));
        assert!(borders(&[0; 25], size).is_empty());
    }
}
