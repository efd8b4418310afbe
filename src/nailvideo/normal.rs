//! The nail in its own frame: normalized pictures in the maps' coordinates, and their mean and SD over some time.
//!
//! Distal at the top, the nail's box 125 % of the side (section 4.2.2): pixel column j lies at (j + 0.5 - s/2)/(s/2) *
//! 1.25 half widths from the middle, of s columns.

use image::{GrayImage, RgbImage};
use ndarray::Array2;
use rayon::prelude::*;
use wide::f32x4;

use super::affine::Affine;
use super::follow::{Covered, cell_at};
use super::options::Window;
use super::sample::{Colours, MARGIN};

/// Side of normalized frames and maps, pixels.
pub(in crate::nailvideo) const SIDE: usize = 400;

/// Half widths and half lengths of a pixel of a picture of some side.
fn place(side: usize, column: usize, row: usize) -> [f64; 2] {
    let at = |k: usize| ((2 * k + 1) as f64 / side as f64 - 1.0) * MARGIN;
    [at(column), -at(row)]
}

/// Red, green and blue of each pixel, row by row; NaN off the picture.
fn pixels<'a>(
    colours: &'a Colours,
    frame_from_nail: &'a Affine,
    side: usize,
) -> impl Iterator<Item = [f64; 3]> + use<'a> {
    (0..side * side).map(move |k| colours.at(frame_from_nail.of(place(side, k % side, k / side))))
}

/// In colour, for people.
pub(in crate::nailvideo) fn picture(colours: &Colours, frame_from_nail: &Affine, side: usize) -> RgbImage {
    let byte = |part: f64| if part.is_finite() { (255.0 * part).round().clamp(0.0, 255.0) as u8 } else { 0 };
    let bytes = pixels(colours, frame_from_nail, side).flat_map(|rgb| rgb.map(byte)).collect();
    RgbImage::from_raw(side as u32, side as u32, bytes).unwrap_or_default()
}

/// Green as encoded, 0 off the picture. Rows side by side and four pixels at a time: one by one, in red and blue as
/// well, this took ten times as long as decoding the frame (`cargo bench -p lunula-cli --bench nailvideo`).
pub(in crate::nailvideo) fn green(colours: &Colours, frame_from_nail: &Affine) -> GrayImage {
    let mut bytes = vec![0; SIDE * SIDE];
    let ends = [0, SIDE - 1];
    let corners = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[c, r]| frame_from_nail.of(place(SIDE, ends[c], ends[r])));
    if let Some(colours) = colours.green(corners) {
        bytes.par_chunks_mut(SIDE).enumerate().for_each(|(row, bytes)| {
            let [first, second] = [0, 1].map(|column| frame_from_nail.of(place(SIDE, column, row)));
            let along = |axis: usize, columns: f32x4| {
                f32x4::splat(first[axis] as f32) + columns * f32x4::splat((second[axis] - first[axis]) as f32)
            };
            for (k, four) in bytes.as_chunks_mut::<4>().0.iter_mut().enumerate() {
                let columns = f32x4::new([0.0, 1.0, 2.0, 3.0]) + f32x4::splat(4.0 * k as f32);
                let green = colours.four(along(0, columns), along(1, columns));
                // Half a level more: rounded when cut.
                let levels = green * f32x4::splat(255.0) + f32x4::splat(0.5);
                *four = levels.max(f32x4::ZERO).min(f32x4::splat(255.0)).to_array().map(|level| level as u8);
            }
        });
    } else {
        let byte = |[_, g, _]: [f64; 3]| if g.is_finite() { (255.0 * g).round().clamp(0.0, 255.0) as u8 } else { 0 };
        bytes.iter_mut().zip(pixels(colours, frame_from_nail, SIDE)).for_each(|(to, rgb)| *to = byte(rgb));
    }
    GrayImage::from_raw(SIDE as u32, SIDE as u32, bytes).unwrap_or_default()
}

const _: () = assert!(SIDE.is_multiple_of(4), "rows of whole fours");

/// Sums over the frames of a window.
#[derive(Debug, Clone)]
pub(in crate::nailvideo) struct WindowSums {
    pub(in crate::nailvideo) window: Window,
    /// Frames that were followed.
    pub(in crate::nailvideo) frames: u64,
    /// Of each pixel: count, mean, sum of squares about it (Welford 1962, doi:10.1080/00401706.1962.10490022).
    sums: Vec<[f64; 3]>,
}

impl WindowSums {
    pub(in crate::nailvideo) fn new(window: Window) -> Self {
        Self { window, frames: 0, sums: vec![[0.0; 3]; SIDE * SIDE] }
    }

    /// Adds a frame's green where the window holds its time, without what is covered.
    pub(in crate::nailvideo) fn add(
        &mut self,
        time_s: f64,
        colours: &Colours,
        frame_from_nail: &Affine,
        covered: Option<&Covered>,
    ) {
        if time_s < self.window.from_s || time_s > self.window.to_s {
            return;
        }
        self.frames += 1;
        let is_covered = |k: usize| covered.is_some_and(|covered| covered[cell_at(place(SIDE, k % SIDE, k / SIDE))]);
        let pixels = pixels(colours, frame_from_nail, SIDE).enumerate();
        for ([count, mean, squares], (k, [_, green, _])) in self.sums.iter_mut().zip(pixels) {
            if green.is_finite() && !is_covered(k) {
                *count += 1.0;
                let before = green - *mean;
                *mean += before / *count;
                *squares += before * (green - *mean);
            }
        }
    }

    /// Mean and SD (n - 1), fraction of full scale; NaN where not known.
    pub(in crate::nailvideo) fn maps(&self) -> [Array2<f32>; 2] {
        let map = |of: &dyn Fn(&[f64; 3]) -> f64| {
            Array2::from_shape_fn((SIDE, SIDE), |(row, column)| of(&self.sums[row * SIDE + column]) as f32)
        };
        let mean = |s: &[f64; 3]| if s[0] > 0.0 { s[1] } else { f64::NAN };
        let sd = |s: &[f64; 3]| if s[0] > 1.0 { (s[2] / (s[0] - 1.0)).sqrt() } else { f64::NAN };
        [map(&mean), map(&sd)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nailvideo::sample::Planes;
    use crate::nailvideo::scenes::{Scene, Shot};
    use crate::video::{Matrix, Turn};

    const PLANES: Planes = Planes { turn: Turn::None, matrix: Matrix::BT709, site: (0.5, 0.5) };

    #[test]
    fn four_at_a_time_are_as_one_by_one() {
        let scene = Scene::new(150.0, 3);
        let picture = scene.picture(&Shot::REST, 0);
        let frame = picture.frame(0, 0.0);
        let colours = Colours::new(&frame, PLANES, &scene.frame_from_nail).expect("on the picture");
        let fast = green(&colours, &scene.frame_from_nail);
        let each = pixels(&colours, &scene.frame_from_nail, SIDE).map(|[_, g, _]| 255.0 * g);
        let largest = fast.as_raw().iter().zip(each).map(|(&one, g)| (f64::from(one) - g).abs()).fold(0.0, f64::max);
        assert!(largest <= 0.501, "{largest}");
    }
}
