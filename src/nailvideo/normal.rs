//! The nail in its own frame: normalized pictures in the maps' coordinates, and their mean and SD over some time.
//!
//! Distal at the top, the nail's box 125 % of the side (section 4.2.2): pixel column j lies at (j + 0.5 - s/2)/(s/2) *
//! 1.25 half widths from the middle, of s columns.

use image::{GrayImage, RgbImage};
use ndarray::Array2;
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::affine::Affine;
use super::follow::{Covered, cell_at};
use super::grid::RUN;
use super::options::Window;
use super::sample::{Channel, Colours, MARGIN};

/// Side of normalized frames and maps, pixels.
pub(in crate::nailvideo) const SIDE: usize = 400;

/// Half widths and half lengths of a pixel of a picture of some side.
fn place(side: usize, column: usize, row: usize) -> [f64; 2] {
    let at = |k: usize| ((2 * k + 1) as f64 / side as f64 - 1.0) * MARGIN;
    [at(column), -at(row)]
}

/// A channel's values (red, green or blue as encoded, fraction of full scale; NaN off the picture), row by row, as many
/// at once as vectors hold: one by one, in all channels, this took ten times as long as decoding the frame
/// (`cargo bench -p lunula-cli --bench nailvideo`).
fn values(colours: &Colours, frame_from_nail: &Affine, channel: usize, side: usize) -> Vec<f32> {
    let mut all = vec![0.0; side * side];
    let at = |column: usize, row: usize| frame_from_nail.of(place(side, column, row));
    let last = side - 1;
    let fast = colours.channel(channel, [at(0, 0), at(last, 0), at(0, last), at(last, last)]);
    all.par_chunks_mut(side).enumerate().for_each(|(row, values)| match &fast {
        Some(channel) => Arch::new().dispatch(Row { channel, first: at(0, row), second: at(1, row), values }),
        None => values.iter_mut().enumerate().for_each(|(column, value)| {
            *value = colours.at(at(column, row))[channel] as f32;
        }),
    });
    all
}

/// A row of points, of which the first two are given.
struct Row<'a> {
    channel: &'a Channel<'a>,
    first: [f64; 2],
    second: [f64; 2],
    values: &'a mut [f32],
}

impl NullaryFnOnce for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let first = self.first.map(|at| at as f32);
        let by: [f32; 2] = std::array::from_fn(|axis| (self.second[axis] - self.first[axis]) as f32);
        let last = self.values.len() - 1;
        for (chunk, values) in self.values.chunks_mut(RUN).enumerate() {
            let (mut x, mut y) = ([0.0; RUN], [0.0; RUN]);
            for k in 0..RUN {
                let column = (RUN * chunk + k).min(last) as f32;
                (x[k], y[k]) = (first[0] + column * by[0], first[1] + column * by[1]);
            }
            let seen = self.channel.many(&x, &y);
            values.copy_from_slice(&seen[..values.len()]);
        }
    }
}

/// A channel's levels; 0 off the picture.
fn levels(colours: &Colours, frame_from_nail: &Affine, channel: usize, side: usize) -> Vec<u8> {
    // Half a level more: rounded when cut. What is no number becomes 0.
    values(colours, frame_from_nail, channel, side).into_iter().map(|value| (value * 255.0 + 0.5) as u8).collect()
}

/// In colour, for people.
pub(in crate::nailvideo) fn picture(colours: &Colours, frame_from_nail: &Affine, side: usize) -> RgbImage {
    let [red, green, blue] = [0, 1, 2].map(|channel| levels(colours, frame_from_nail, channel, side));
    RgbImage::from_fn(side as u32, side as u32, |x, y| {
        let at = y as usize * side + x as usize;
        image::Rgb([red[at], green[at], blue[at]])
    })
}

/// Green as encoded, 0 off the picture.
pub(in crate::nailvideo) fn green(colours: &Colours, frame_from_nail: &Affine) -> GrayImage {
    let levels = levels(colours, frame_from_nail, 1, SIDE);
    GrayImage::from_raw(SIDE as u32, SIDE as u32, levels).unwrap_or_default()
}

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
        let values = values(colours, frame_from_nail, 1, SIDE).into_iter().map(f64::from);
        for ([count, mean, squares], (k, green)) in self.sums.iter_mut().zip(values.enumerate()) {
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
    use crate::video::{Curve, Matrix, Turn};

    const PLANES: Planes = Planes { turn: Turn::None, matrix: Matrix::BT709, curve: Curve::Bt709, site: (0.5, 0.5) };

    #[test]
    fn many_at_a_time_are_as_one_by_one() {
        let scene = Scene::new(150.0, 3);
        let shown = scene.picture(&Shot::REST, 0);
        let frame = shown.frame(0, 0.0);
        let colours = Colours::new(&frame, PLANES, &scene.frame_from_nail).expect("on the picture");
        let fast = picture(&colours, &scene.frame_from_nail, SIDE);
        let largest = fast.enumerate_pixels().flat_map(|(x, y, rgb)| {
            let each = colours.at(scene.frame_from_nail.of(place(SIDE, x as usize, y as usize)));
            [0, 1, 2].map(|c| (f64::from(rgb[c]) - 255.0 * each[c]).abs())
        });
        let largest = largest.fold(0.0, f64::max);
        assert!(largest <= 0.501, "{largest}");
        let greens = green(&colours, &scene.frame_from_nail);
        assert!(greens.pixels().zip(fast.pixels()).all(|(one, rgb)| one[0] == rgb[1]));
    }

    #[test]
    fn what_is_off_the_picture_is_black_and_in_no_sum() {
        let scene = Scene::new(150.0, 3);
        let shown = scene.picture(&Shot::REST, 0);
        let frame = shown.frame(0, 0.0);
        // A quarter of the nail's width to the left of the picture's left border.
        let half_width = scene.frame_from_nail.0[0];
        let mut moved = scene.frame_from_nail;
        moved.0[2] = 0.5 * half_width;
        let colours = Colours::new(&frame, PLANES, &moved).expect("half of it is on the picture");
        let (green, mut sums) = (green(&colours, &moved), WindowSums::new(Window { from_s: 0.0, to_s: 1.0 }));
        sums.add(0.5, &colours, &moved, None);
        let [mean, _] = sums.maps();
        for (x, y, level) in green.enumerate_pixels() {
            let [at, _] = moved.of(place(SIDE, x as usize, y as usize));
            let known = mean[[y as usize, x as usize]];
            if at < -1.5 {
                assert!(level[0] == 0 && known.is_nan(), "{x} {y}: {} {known}", level[0]);
            } else if at > 1.0 {
                assert!((255.0 * known - f32::from(level[0])).abs() <= 0.501, "{x} {y}: {} {known}", level[0]);
            }
        }
    }
}
