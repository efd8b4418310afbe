//! Work on whole pictures: reduced by area, lines drawn on them.

use opencv::core::{Point, Scalar, Size, Vec3b, Vector};
use opencv::imgproc;

use super::{VisionError, pixels, pixels_mut, size};

/// A picture of red, green, blue samples at another size: shrunk by the mean over each pixel's area, enlarged linearly.
///
/// `rgb` has 3 x width x height samples of `from`; the answer as many of `to`.
///
/// # Errors
/// [`VisionError`].
pub(crate) fn resized(rgb: &[u8], from: [usize; 2], to: [usize; 2]) -> Result<Vec<u8>, VisionError> {
    let mut out = vec![0; 3 * to[0] * to[1]];
    let source = pixels::<Vec3b>(from[1], from[0], rgb)?;
    let how = if to[0] < from[0] { imgproc::INTER_AREA } else { imgproc::INTER_LINEAR };
    let wanted = Size::new(size(to[0])?, size(to[1])?);
    let mut target = pixels_mut::<Vec3b>(to[1], to[0], &mut out)?;
    imgproc::resize(&source, &mut target, wanted, 0.0, 0.0, how).map_err(VisionError::of("resize"))?;
    drop(target);
    Ok(out)
}

/// Draws a closed line, smooth, `thickness` pixels wide, on red, green, blue samples; corners to an eighth of a pixel.
///
/// # Errors
/// [`VisionError`].
pub(crate) fn closed_line(
    rgb: &mut [u8],
    [width, height]: [usize; 2],
    corners: &[[f64; 2]],
    colour: [u8; 3],
    thickness: u8,
) -> Result<(), VisionError> {
    const BITS: i32 = 3;
    let scale = f64::from(1 << BITS);
    let corner = |p: &[f64; 2]| Point::new((p[0] * scale).round() as i32, (p[1] * scale).round() as i32);
    let line: Vector<Point> = corners.iter().map(corner).collect();
    let [r, g, b] = colour.map(f64::from);
    let mut picture = pixels_mut::<Vec3b>(height, width, rgb)?;
    let (colour, thickness) = (Scalar::new(r, g, b, 0.0), i32::from(thickness));
    imgproc::polylines(&mut picture, &line, true, colour, thickness, imgproc::LINE_AA, BITS)
        .map_err(VisionError::of("polylines"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reduced_picture_is_the_mean_over_areas() {
        let rgb: Vec<u8> = (0..6 * 4).flat_map(|k| [k as u8 * 4, 255 - k as u8 * 3, 7]).collect();
        let small = resized(&rgb, [6, 4], [3, 2]).expect("a picture");
        for (at, pixel) in small.as_chunks::<3>().0.iter().enumerate() {
            let (x, y) = (at % 3, at / 3);
            let mean = |c: usize| {
                let sum: u32 = [0, 1, 6, 7].iter().map(|d| u32::from(rgb[3 * (12 * y + 2 * x + d) + c])).sum();
                f64::from(sum) / 4.0
            };
            assert!((0..3).all(|c| (f64::from(pixel[c]) - mean(c)).abs() <= 0.5), "{at}: {pixel:?}");
        }
        assert_eq!(resized(&rgb, [6, 4], [6, 4]).expect("a picture"), rgb);
        assert!(resized(&rgb, [6, 5], [3, 2]).is_err());
    }

    #[test]
    fn a_line_is_closed_and_smooth() {
        let mut rgb = vec![0; 3 * 20 * 20];
        closed_line(&mut rgb, [20, 20], &[[4.0, 4.0], [15.0, 4.0], [15.0, 15.0], [4.0, 15.0]], [200, 100, 0], 1)
            .expect("a line");
        let at = |x: usize, y: usize| &rgb[3 * (20 * y + x)..][..3];
        assert!([at(10, 4), at(4, 10)].iter().all(|p| p[0] > 150 && p[1] > 70 && p[2] == 0));
        assert_eq!(at(10, 10), [0; 3]);
        assert!(closed_line(&mut rgb, [20, 21], &[[4.0, 4.0], [15.0, 4.0]], [1; 3], 1).is_err());
    }
}
