//! A view of boards, pixel by pixel.

use std::sync::OnceLock;

use rand_distr::{Distribution, Normal};
use rayon::prelude::*;

use super::{BoardOptions, View};
use crate::phantom::nail::numbers;
use crate::phantom::scene::faults::Faults;
use crate::phantom::scene::lens::Mapping;

const KIND_NOISE: u32 = 32;
/// Of full scale: black squares, paper, table.
const BLACK: f64 = 0.10;
const PAPER: f64 = 0.85;
const TABLE: f64 = 0.45;
/// How far the Gaussian is followed, standard deviations.
const REACH_SD: f64 = 4.0;
/// Lines on which a pixel is integrated, standard deviations apart; along each the integral is exact.
const LINES_SD: f64 = 0.35;
/// The variance of a pixel's own area, which is part of the Gaussian here, square pixels.
const PIXEL_PX2: f64 = 1.0 / 12.0;

/// A grey picture, row after row.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// 0 to 255.
    pub data: Vec<u8>,
}

/// A camera and its views of a board.
#[derive(Debug)]
pub struct Scene {
    pub(super) options: BoardOptions,
    pub(super) mapping: Mapping,
    pub(super) views: Vec<View>,
    /// The board in the finger's plane.
    pub(super) plane: Option<View>,
    /// Each pixel's ray on the plane z = 1; there is none until a picture is drawn.
    rays: OnceLock<Vec<[f64; 2]>>,
    /// Standard deviation of the Gaussian and a pixel's area together.
    spread_px: f64,
}

impl Scene {
    /// Settles where the boards are.
    ///
    /// # Errors
    /// [`Faults`]: all that is wrong with the options.
    pub fn new(options: BoardOptions) -> Result<Self, Faults> {
        options.check()?;
        let mapping = options.mapping();
        let none =
            |what: &str| Faults(vec![format!("{what}: the board fits nowhere in the picture; choose less tilt")]);
        let views = (0..options.views).map(|index| View::random(&options, &mapping, index));
        let views = views.collect::<Option<Vec<View>>>().ok_or_else(|| none("--tilt"))?;
        let plane = match options.plane {
            None => None,
            Some(plane) => Some(View::in_plane(&options, &mapping, plane).ok_or_else(|| none("--plane"))?),
        };
        let spread_px = (options.focus.powi(2) + PIXEL_PX2).sqrt();
        Ok(Self { options, mapping, views, plane, rays: OnceLock::new(), spread_px })
    }

    fn rays(&self) -> &[[f64; 2]] {
        self.rays.get_or_init(|| {
            let (width, height) = (self.options.size.0 as usize, self.options.size.1 as usize);
            let at = |k: usize| [(k % width) as f64, (k / width) as f64];
            // The check of the options has seen that the corners can be undone.
            let ray = |k: usize| self.mapping.ray(at(k)).unwrap_or([f64::NAN; 2]);
            (0..width * height).into_par_iter().map(ray).collect()
        })
    }

    /// The views, in order.
    #[must_use]
    pub fn views(&self) -> &[View] {
        &self.views
    }

    /// The inner corners of a view as the lens shows them, row after row, pixels.
    #[must_use]
    pub fn corners_px(&self, view: &View) -> Vec<[f64; 2]> {
        view.corners_px(&self.options, &self.mapping)
    }

    /// Draws boards that lie at `views`, the last on top; `index` distinguishes the noise of pictures.
    #[must_use]
    pub fn picture(&self, views: &[View], index: u32) -> Picture {
        let (width, height) = self.options.size;
        let boards: Vec<Grid> = views.iter().map(|view| Grid::new(view, &self.options)).collect();
        let mut values = vec![0.0_f64; self.rays().len()];
        let row = |(y, row): (usize, &mut [f64])| {
            let mut breaks = Vec::new();
            row.iter_mut().enumerate().for_each(|(x, value)| *value = self.value(&boards, x, y, &mut breaks));
        };
        values.par_chunks_mut(width as usize).enumerate().for_each(row);
        let mut rng = numbers(self.options.seed, KIND_NOISE, index);
        // A deviation of 0 to 128 is one.
        let noise = Normal::new(0.0, self.options.noise).ok();
        let byte = |value: &f64| {
            let noise = noise.map_or(0.0, |noise| noise.sample(&mut rng));
            (255.0 * value + noise).round().clamp(0.0, 255.0) as u8
        };
        Picture { width, height, data: values.iter().map(byte).collect() }
    }

    /// The share of full scale at a pixel; `breaks` is room for those of a line.
    fn value(&self, boards: &[Grid], x: usize, y: usize, breaks: &mut Vec<f64>) -> f64 {
        let (width, height) = (self.options.size.0 as usize, self.options.size.1 as usize);
        let here = self.rays()[y * width + x];
        let (across, down) = (self.slope(x, width, y * width, 1), self.slope(y, height, x, width));
        let reach = REACH_SD * self.spread_px;
        let ray = |[dx, dy]: [f64; 2]| [0, 1].map(|k| here[k] + dx * across[k] + dy * down[k]);
        let rim = [[-reach, -reach], [-reach, reach], [reach, -reach], [reach, reach]].map(ray);
        let uniform = |board: &Grid| {
            let cell = board.place(rim[0]);
            rim[1..].iter().all(|&ray| board.place(ray) == cell)
        };
        let Some(mixed) = boards.iter().rfind(|board| !uniform(board)) else {
            return tone(boards.iter().map(|board| board.place(here)));
        };
        // Along a line between both families of edges, neither of them is met at a flat angle.
        let along = mixed.between_edges(here, across, down);
        let beside = [-along[1], along[0]];
        let lines = (REACH_SD / LINES_SD) as i32;
        let line = |k: i32| {
            let off = f64::from(k) * LINES_SD * self.spread_px;
            let ends = [-reach, reach].map(|s| ray([0, 1].map(|axis| off * beside[axis] + s * along[axis])));
            let weight = (-0.5 * (f64::from(k) * LINES_SD).powi(2)).exp();
            [weight * along_line(boards, ends, breaks), weight]
        };
        let [sum, weight] = (-lines..=lines).map(line).fold([0.0; 2], |sum, line| [sum[0] + line[0], sum[1] + line[1]]);
        sum / weight
    }

    /// How the rays change from pixel to pixel.
    fn slope(&self, at: usize, count: usize, start: usize, stride: usize) -> [f64; 2] {
        let (before, after) = (at.saturating_sub(1), (at + 1).min(count - 1));
        let [a, b] = [before, after].map(|k| self.rays()[start + k * stride]);
        [0, 1].map(|k| (b[k] - a[k]) / (after - before) as f64)
    }
}

/// The mean tone on a line between the rays `ends`, by a Gaussian whose [`REACH_SD`] they are.
fn along_line(boards: &[Grid], ends: [[f64; 2]; 2], breaks: &mut Vec<f64>) -> f64 {
    breaks.clear();
    breaks.push(1.0);
    boards.iter().for_each(|board| board.crossings(ends, breaks));
    breaks.sort_unstable_by(f64::total_cmp);
    let share = |at: f64| normal(REACH_SD * (2.0 * at - 1.0));
    let least = share(0.0);
    let (mut from, mut below, mut sum) = (0.0, least, 0.0);
    for &to in breaks.iter() {
        let (middle, up_to) = (0.5 * (from + to), share(to));
        let ray = [0, 1].map(|k| ends[0][k] + middle * (ends[1][k] - ends[0][k]));
        sum += (up_to - below) * tone(boards.iter().map(|board| board.place(ray)));
        (from, below) = (to, up_to);
    }
    sum / (below - least)
}

/// A board's squares as rays meet them.
struct Grid {
    /// Column, row and a divisor of both, in squares from the first inner corner, of a ray on the plane z = 1.
    from_ray: [[f64; 3]; 3],
    columns: i64,
    rows: i64,
}

impl Grid {
    fn new(view: &View, options: &BoardOptions) -> Self {
        let back = view.rotation.inverse();
        let origin = back * view.translation_mm;
        let row = |k: usize| [0, 1, 2].map(|j| back[(k, j)]);
        let (right, down, away) = (row(0), row(1), row(2));
        let over = |axis: [f64; 3], at: f64| [0, 1, 2].map(|k| (origin.z * axis[k] - at * away[k]) / options.square_mm);
        Self {
            from_ray: [over(right, origin.x), over(down, origin.y), away],
            columns: options.board.columns as i64,
            rows: options.board.rows as i64,
        }
    }

    /// Column, row and their divisor.
    fn parts(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        self.from_ray.map(|row| row[0] * x + row[1] * y + row[2])
    }

    fn place(&self, ray: [f64; 2]) -> Place {
        let [column, row, divisor] = self.parts(ray);
        let (column, row) = ((column / divisor).floor() as i64, (row / divisor).floor() as i64);
        // Squares about the inner corners, and a margin of paper about these.
        if !(-2..=self.columns).contains(&column) || !(-2..=self.rows).contains(&row) {
            Place::Outside
        } else if (-1..self.columns).contains(&column) && (-1..self.rows).contains(&row) {
            Place::Square(column, row)
        } else {
            Place::Margin
        }
    }

    /// Where a line between two rays goes over from square to square, as shares of it, at the end of `into`.
    fn crossings(&self, ends: [[f64; 2]; 2], into: &mut Vec<f64>) {
        let [from, to] = ends.map(|ray| self.parts(ray));
        for (axis, count) in [(0, self.columns), (1, self.rows)] {
            let [a, b] = [from, to].map(|parts| parts[axis] / parts[2]);
            let first = (a.min(b).ceil() as i64).max(-2);
            let last = (a.max(b).floor() as i64).min(count + 1);
            // At the share s, column (or row) and divisor go straight from one end to the other.
            let share = |line: i64| {
                let rest = |parts: [f64; 3]| parts[axis] - line as f64 * parts[2];
                rest(from) / (rest(from) - rest(to))
            };
            into.extend((first..=last).map(share).filter(|share| (0.0..=1.0).contains(share)));
        }
    }

    /// The direction on the picture, of length 1, that is as far as can be from both families of edges.
    fn between_edges(&self, ray: [f64; 2], across: [f64; 2], down: [f64; 2]) -> [f64; 2] {
        let [column, row, divisor] = self.parts(ray);
        let slope = |axis: usize, value: f64, step: [f64; 2]| {
            let change = |k: usize| self.from_ray[k][0] * step[0] + self.from_ray[k][1] * step[1];
            change(axis) - value / divisor * change(2)
        };
        let normal_of = |axis: usize, value: f64| unit([slope(axis, value, across), slope(axis, value, down)]);
        let (one, other) = (normal_of(0, column), normal_of(1, row));
        let [sum, difference] = [1.0, -1.0].map(|sign| [one[0] + sign * other[0], one[1] + sign * other[1]]);
        let longer = if sum[0].hypot(sum[1]) >= difference[0].hypot(difference[1]) { sum } else { difference };
        unit(longer)
    }
}

fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let length = x.hypot(y).max(f64::MIN_POSITIVE);
    [x / length, y / length]
}

/// What of a board lies at a point of its plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Outside,
    Margin,
    Square(i64, i64),
}

/// The tone of what lies on top.
fn tone(places: impl DoubleEndedIterator<Item = Place>) -> f64 {
    match places.rev().find(|place| *place != Place::Outside) {
        Some(Place::Square(column, row)) if (column + row).rem_euclid(2) == 0 => BLACK,
        Some(_) => PAPER,
        None => TABLE,
    }
}

/// The normal distribution's integral up to `at`, to within 1e-7 (Abramowitz and Stegun 26.2.17).
fn normal(at: f64) -> f64 {
    const TERMS: [f64; 5] = [0.319_381_530, -0.356_563_782, 1.781_477_937, -1.821_255_978, 1.330_274_429];
    let k = 1.0 / (1.0 + 0.231_641_9 * at.abs());
    let tail = TERMS.iter().rev().fold(0.0, |sum, term| k * (sum + term));
    let beyond = tail * (-0.5 * at * at).exp() / std::f64::consts::TAU.sqrt();
    if at < 0.0 { beyond } else { 1.0 - beyond }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slow twin: a pixel's tone by samples that are a twelfth of a pixel apart.
    fn sampled(scene: &Scene, view: &View, x: f64, y: f64) -> f64 {
        const STEP: f64 = 1.0 / 12.0;
        let grid = Grid::new(view, &scene.options);
        let mut sums = [0.0; 2];
        for k in -60..=60 {
            for j in -60..=60 {
                let (dx, dy) = ((f64::from(k) + 0.37) * STEP, (f64::from(j) + 0.11) * STEP);
                let weight = (-0.5 * (dx * dx + dy * dy) / scene.spread_px.powi(2)).exp();
                let ray = scene.mapping.ray([x + dx, y + dy]).unwrap();
                sums = [sums[0] + weight * tone(std::iter::once(grid.place(ray))), sums[1] + weight];
            }
        }
        sums[0] / sums[1]
    }

    #[test]
    fn a_pixel_is_the_mean_of_what_it_sees() {
        let options = BoardOptions { size: (320, 240), noise: 0.0, views: 1, seed: 3, ..BoardOptions::default() };
        let scene = Scene::new(options).unwrap();
        let picture = scene.picture(scene.views(), 0);
        let corner = scene.corners_px(&scene.views()[0])[20];
        let mut worst: f64 = 0.0;
        for k in 0..81 {
            let (x, y) = (corner[0].round() + f64::from(k % 9 - 4), corner[1].round() + f64::from(k / 9 - 4));
            let drawn = f64::from(picture.data[y as usize * 320 + x as usize]);
            worst = worst.max((drawn - 255.0 * sampled(&scene, &scene.views()[0], x, y)).abs());
        }
        // Half a step of rounding, and the samples' own error; measured below.
        assert!(worst <= LARGEST_GAP, "{worst} of 255");
    }

    /// Measured 1.1, of which rounding is 0.5.
    const LARGEST_GAP: f64 = 2.0;

    #[test]
    fn the_same_options_draw_the_same_and_all_corners_are_in_the_picture() {
        let options = BoardOptions { size: (320, 240), views: 8, ..BoardOptions::default() };
        let (one, other) = (Scene::new(options.clone()).unwrap(), Scene::new(options).unwrap());
        assert_eq!(one.picture(&one.views()[..1], 0), other.picture(&other.views()[..1], 0));
        assert_ne!(one.picture(&one.views()[..1], 0), one.picture(&one.views()[..1], 1), "the noise");
        let corners = one.views().iter().flat_map(|view| one.corners_px(view));
        assert!(corners.into_iter().all(|[x, y]| x > 0.0 && y > 0.0 && x < 319.0 && y < 239.0));
    }
}
