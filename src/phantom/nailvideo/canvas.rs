//! The scene evaluated once, so that frames can be drawn of it: its colour without zones, and what each zone adds.
//!
//! In: a [`NailScene`] and the region of frame 0's plane that frames show. Out: the colour anywhere in it at a moment
//! ([`Painted`]), by Catmull and Rom's cubic over samples half a pixel apart. Colours are encoded fractions of full
//! scale.

use rayon::prelude::*;

use crate::phantom::nail::{ColourWeights, NailScene, PATTERNS};

/// Samples a pixel along each axis.
const PER_PX: f64 = 2.0;
/// The most samples of a canvas: 0.6 GB.
pub(super) const MOST_SAMPLES: f64 = 5e7;

/// Samples evenly over a rectangle.
#[derive(Debug, Clone, Copy)]
struct Grid {
    /// The first sample, pixels.
    origin_px: [f64; 2],
    columns: usize,
    rows: usize,
}

/// What is the same in all frames.
#[derive(Debug)]
pub(super) struct Canvas {
    grid: Grid,
    pale: Vec<[f32; 3]>,
    /// Of the nail's bed: where it begins in `grid`, and its own.
    bed_at: [usize; 2],
    bed: Grid,
    marks: Vec<Mark>,
}

/// A sample of the bed.
#[derive(Debug, Clone, Copy, Default)]
struct Mark {
    /// What whitening adds to red, green, blue.
    gain: [f32; 3],
    zones: [f32; PATTERNS],
    distal: f32,
}

/// A canvas at a moment.
pub(super) struct Painted<'a> {
    canvas: &'a Canvas,
    bed: Vec<[f32; 3]>,
}

impl Grid {
    fn place(&self, column: usize, row: usize) -> [f64; 2] {
        [self.origin_px[0] + column as f64 / PER_PX, self.origin_px[1] + row as f64 / PER_PX]
    }
}

/// How many samples a region takes: `[left, top, right, bottom]`, pixels.
pub(super) fn samples(region_px: [f64; 4]) -> f64 {
    let [left, top, right, bottom] = region_px;
    (PER_PX * (right - left) + 8.0) * (PER_PX * (bottom - top) + 8.0)
}

impl Canvas {
    /// Evaluates a scene over a region: `[left, top, right, bottom]`, pixels.
    pub(super) fn new(scene: &NailScene, region_px: [f64; 4]) -> Self {
        let [left, top, right, bottom] = region_px;
        let side = |from: f64, to: f64| (PER_PX * (to - from)).ceil() as usize + 8;
        let origin_px = [left, top].map(|from| from.floor() - 2.0);
        let grid = Grid { origin_px, columns: side(left, right), rows: side(top, bottom) };
        let (pale, white) = (scene.field().whitened(0.0), scene.field().whitened(1.0));
        let mut colours = vec![[0.0f32; 3]; grid.columns * grid.rows];
        colours.par_chunks_mut(grid.columns).enumerate().for_each(|(row, colours)| {
            for (column, colour) in colours.iter_mut().enumerate() {
                let [x, y] = grid.place(column, row);
                *colour = pale.colour(x, y).map(|value| value as f32);
            }
        });

        // The bed's box, with a border that has no zones: as wide as the cubic.
        let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]].map(|[u, v]| scene.picture_from_nail(u, v));
        let edge_px = 3.0 + 8.0 * scene.camera.blur_px;
        let range = |axis: usize, count: usize| {
            let at = corners.map(|corner| corner[axis]);
            let [low, high] = [at.into_iter().fold(f64::MAX, f64::min), at.into_iter().fold(f64::MIN, f64::max)];
            let index = |px: f64| (PER_PX * (px - grid.origin_px[axis])).clamp(0.0, count as f64) as usize;
            [index(low - edge_px), index(high + edge_px)]
        };
        let ([left, right], [top, bottom]) = (range(0, grid.columns), range(1, grid.rows));
        let bed = Grid { origin_px: grid.place(left, top), columns: right - left, rows: bottom - top };
        let mut marks = vec![Mark::default(); bed.columns * bed.rows];
        marks.par_chunks_mut(bed.columns.max(1)).enumerate().for_each(|(row, marks)| {
            for (column, mark) in marks.iter_mut().enumerate() {
                let [x, y] = bed.place(column, row);
                let (pale, white) = (pale.colour(x, y), white.colour(x, y));
                mark.gain = std::array::from_fn(|c| (white[c] - pale[c]) as f32);
                if mark.gain != [0.0; 3] {
                    let (zones, distal) = scene.field().patterns(x, y);
                    mark.zones = zones.map(|zone| zone as f32);
                    mark.distal = distal as f32;
                }
            }
        });
        Self { grid, pale: colours, bed_at: [left, top], bed, marks }
    }

    /// The canvas with a moment's zones.
    pub(super) fn painted(&self, weights: &ColourWeights) -> Painted<'_> {
        let proximal = weights.proximal.map(|weight| weight as f32);
        let further: [f32; PATTERNS] = std::array::from_fn(|k| (weights.distal[k] - weights.proximal[k]) as f32);
        let colour = |k: usize| {
            let mark = &self.marks[k];
            let [column, row] = [k % self.bed.columns, k / self.bed.columns];
            let pale = self.pale[(self.bed_at[1] + row) * self.grid.columns + self.bed_at[0] + column];
            let (mut near, mut far) = (0.0f32, 0.0f32);
            for ((zone, proximal), further) in mark.zones.iter().zip(&proximal).zip(&further) {
                near += zone * proximal;
                far += zone * further;
            }
            let whitening = near + mark.distal * far;
            std::array::from_fn(|c| pale[c] + mark.gain[c] * whitening)
        };
        Painted { canvas: self, bed: (0..self.marks.len()).map(colour).collect() }
    }
}

impl Painted<'_> {
    /// Red, green and blue at a place of frame 0's plane; beyond the canvas that of its border.
    pub(super) fn colour(&self, [x, y]: [f64; 2]) -> [f32; 3] {
        let canvas = self.canvas;
        let along = |px: f64, origin_px: f64, count: usize| {
            let at = (PER_PX * (px - origin_px)).clamp(1.0, count as f64 - 3.0);
            let whole = at as usize;
            (whole - 1, cubic((at - whole as f64) as f32))
        };
        let (column, across) = along(x, canvas.grid.origin_px[0], canvas.grid.columns);
        let (row, down) = along(y, canvas.grid.origin_px[1], canvas.grid.rows);
        let [left, top] = canvas.bed_at;
        let within =
            column >= left && row >= top && column + 4 <= left + canvas.bed.columns && row + 4 <= top + canvas.bed.rows;
        let (samples, columns, first) = if within {
            (&self.bed, canvas.bed.columns, (row - top) * canvas.bed.columns + column - left)
        } else {
            (&canvas.pale, canvas.grid.columns, row * canvas.grid.columns + column)
        };
        let mut sum = [0.0f32; 3];
        for (k, down) in down.into_iter().enumerate() {
            let begin = first + k * columns;
            for (sample, across) in samples[begin..begin + 4].iter().zip(across) {
                let weight = down * across;
                (0..3).for_each(|c| sum[c] += weight * sample[c]);
            }
        }
        sum
    }
}

/// Catmull and Rom's weights of the four samples around a place `t` behind the second.
fn cubic(t: f32) -> [f32; 4] {
    [
        0.5 * t * ((2.0 - t) * t - 1.0),
        0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
        0.5 * t * ((4.0 - 3.0 * t) * t + 1.0),
        0.5 * t * t * (t - 1.0),
    ]
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::nail::Axis;
    use crate::phantom::nail::{Background, Camera, Light, Pose, numbers};
    use crate::phantom::sensor::person;

    #[test]
    fn a_canvas_is_the_scene_at_any_moment() {
        /// Measured within the nail and over the whole region, RMS in 255ths: 0.0010 and 0.0079.
        const NEAR: [f64; 2] = [0.002, 0.012];
        let background = Background { colour: [0.6, 0.5, 0.4], grain: 0.1, shadow: 0.3 };
        let axis = Axis::from_clockwise_rad(0.1);
        let camera = Camera { axis, background, ..Camera::upright([320, 240], [160.0, 120.0], 95.0) };
        let light = Light { brightness: 1.3, gradient: [0.0; 2], ..Light::chamber() };
        let scene = NailScene { subject: person(2), pose: Pose::Nominal, light, camera };
        let canvas = Canvas::new(&scene, [0.0, 0.0, 320.0, 240.0]);
        let mut weights = ColourWeights::resting(&scene.subject, [0.9, 0.4, -2.0], [0.0, 0.05, 0.0]);
        weights.distal[1] += 0.1;
        let (painted, field) = (canvas.painted(&weights), scene.field().at_moment(&weights));
        let mut rng = numbers(5, 0, 0);
        let [mut inside, mut all] = [[0.0, 0.0]; 2];
        for _ in 0..40_000 {
            let at = [rng.random_range(1.0..318.0), rng.random_range(1.0..238.0)];
            let (near, exact) = (painted.colour(at), field.colour(at[0], at[1]));
            let square = (0..3).map(|c| (255.0 * (f64::from(near[c]) - exact[c])).powi(2)).sum::<f64>() / 3.0;
            let [dx, dy] = [at[0] - 160.0, at[1] - 120.0];
            all = [all[0] + square, all[1] + 1.0];
            if dx.abs() < 35.0 && dy.abs() < 35.0 {
                inside = [inside[0] + square, inside[1] + 1.0];
            }
        }
        for ([sum, count], near) in [inside, all].into_iter().zip(NEAR) {
            assert!((sum / count).sqrt() <= near, "{}", (sum / count).sqrt());
        }
    }
}
