//! Work on whole pictures: reduced by area, lines drawn on them.

use opencv::core::{Mat, Point, Rect, Scalar, Size, ToInputArray, ToOutputArray, Vec3b, Vector};
use opencv::imgproc;

use super::{VisionError, pixels, pixels_mut, size};

/// A picture of red, green, blue samples at another size: shrunk by the mean over each pixel's area, enlarged linearly.
///
/// `rgb` has 3 x width x height samples of `from`; the answer as many of `to`.
pub(crate) fn resized(rgb: &[u8], from: [usize; 2], to: [usize; 2]) -> Result<Vec<u8>, VisionError> {
    part_resized(rgb, from, [[0; 2], from], to)
}

/// As [`resized`], of a part: its corner and size.
pub(crate) fn part_resized(
    rgb: &[u8],
    from: [usize; 2],
    [corner, part]: [[usize; 2]; 2],
    to: [usize; 2],
) -> Result<Vec<u8>, VisionError> {
    let mut out = vec![0; 3 * to[0] * to[1]];
    let whole = pixels::<Vec3b>(from[1], from[0], rgb)?;
    let rect = Rect::new(size(corner[0])?, size(corner[1])?, size(part[0])?, size(part[1])?);
    let source = Mat::roi(&whole, rect).map_err(VisionError::of("Mat"))?;
    let how = if to[0] < part[0] { imgproc::INTER_AREA } else { imgproc::INTER_LINEAR };
    let mut target = pixels_mut::<Vec3b>(to[1], to[0], &mut out)?;
    shrunk(&source, halvings(part, to), how, &mut target, Size::new(size(to[0])?, size(to[1])?))?;
    drop(target);
    Ok(out)
}

/// A picture of so many pixels that is shrunk by so much is halved first: OpenCV's means over areas are fast for halves
/// alone. 12 megapixels to 768 x 1024 take 16 ms in place of 47, 2000 x 2000 to 157 x 157 take 3 in place of 13 (one
/// thread, best of 7). Samples of a photograph enlarged to 12 megapixels differ by 2 of 255 at most, those of the test
/// below, waves of 6 pixels and 30 levels, by 7. Half of an odd side is rounded: there the far end is shown off by up
/// to a pixel of what is halved.
const HALVED_FROM_PX: usize = 1 << 20;
const HALVED_BY: f64 = 3.5;

/// How often a picture is halved before it is brought `to` its size.
fn halvings(from: [usize; 2], to: [usize; 2]) -> usize {
    let is_much = |halvings: &usize| (0..2).all(|i| (from[i] >> halvings) as f64 >= HALVED_BY * to[i] as f64);
    if from[0] * from[1] < HALVED_FROM_PX { 0 } else { (0..).take_while(is_much).count() }
}

fn shrunk(
    from: &impl ToInputArray,
    halvings: usize,
    how: i32,
    to: &mut impl ToOutputArray,
    wanted: Size,
) -> Result<(), VisionError> {
    if halvings == 0 {
        return imgproc::resize(from, to, wanted, 0.0, 0.0, how).map_err(VisionError::of("resize"));
    }
    let mut half = Mat::default();
    imgproc::resize(from, &mut half, Size::default(), 0.5, 0.5, how).map_err(VisionError::of("resize"))?;
    shrunk(&half, halvings - 1, how, to, wanted)
}

/// Draws a closed line, smooth, `thickness` pixels wide, on red, green, blue samples; corners to an eighth of a pixel.
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

    /// Waves of 6 to 57 pixels, and noise.
    #[test]
    fn a_large_picture_is_the_mean_over_areas_too() {
        let from = [1200, 1600];
        let mut noise = 1_u32;
        let mut sample = |x: f64, y: f64, c: usize| {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let wave = 40.0 * (x / 9.0).sin() + 30.0 * (0.5 * x + y).sin() + 30.0 * (y / (5.0 + c as f64)).cos();
            (128.0 + wave + f64::from(noise >> 24) / 16.0) as u8
        };
        let at = |i: usize| ((i % from[0]) as f64, (i / from[0]) as f64);
        let rgb: Vec<u8> = (0..3 * from[0] * from[1]).map(|k| sample(at(k / 3).0, at(k / 3).1, k % 3)).collect();
        for (part, to, halved, most) in [
            ([[0, 0], from], [300, 400], 1, 1),
            ([[100, 304], [1096, 1048]], [150, 143], 2, 7),
            ([[0, 0], [800, 1200]], [80, 120], 0, 0),
        ] {
            assert_eq!(halvings(part[1], to), halved, "{part:?}");
            let ours = part_resized(&rgb, from, part, to).expect("a picture");
            let mut at_once = vec![0; ours.len()];
            let whole = pixels::<Vec3b>(from[1], from[0], &rgb).expect("a picture");
            let [[x, y], [width, height]] = part.map(|side| side.map(|n| n as i32));
            let cut = Mat::roi(&whole, Rect::new(x, y, width, height)).expect("a part");
            let mut target = pixels_mut::<Vec3b>(to[1], to[0], &mut at_once).expect("a picture");
            shrunk(&cut, 0, imgproc::INTER_AREA, &mut target, Size::new(to[0] as i32, to[1] as i32)).expect("shrunk");
            drop(target);
            let apart = ours.iter().zip(&at_once).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(apart <= Some(most), "{part:?}: {apart:?}");
        }
        assert!(part_resized(&rgb, from, [[200, 0], [1001, 100]], [10, 1]).is_err());
        // An edge at two thirds of odd sides stays there.
        let from = [1151, 1531];
        let rgb: Vec<u8> = (0..from[0] * from[1]).flat_map(|k| [if k % from[0] < 767 { 20 } else { 220 }; 3]).collect();
        let small = resized(&rgb, from, [150, 200]).expect("a picture");
        assert_eq!(halvings(from, [150, 200]), 2);
        let bright: f64 = small[..3 * 150].iter().step_by(3).map(|&v| (f64::from(v) - 20.0) / 200.0).sum();
        assert!((bright - 150.0 * (1.0 - 767.0 / 1151.0)).abs() <= 0.3, "{bright}");
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
