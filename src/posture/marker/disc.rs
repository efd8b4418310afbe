//! One step of fitting a blurred disc to a window of one plane, by least squares.
//!
//! Model of a sample at (x, y), a disc of radius R at (cx, cy), r the distance from there, u = (x - cx) / R, v = (y -
//! cy) / R:
//! (1 - m) (b0 + b1 u + b2 v) + m a, with m = Phi((R - r) / s), Phi the normal distribution function. The surround has
//! a gradient of its own and the disc has none, as a sticker does not take part in the shading of what lies beneath;
//! one gradient for both biases a centre on a finger by up to 0.09 px at 1280x720 and 0.15 px at 480x270. Unknown: the
//! [`Ground`] (b0, b1, b2, a) of a plane, the [`DiscShape`] (cx, cy, R, s) of all. A step is Gauss-Newton's; the
//! ground is eliminated, so steps of planes add up.

use nalgebra::{Matrix4, SMatrix, SVector, Vector4};
use wide::f32x4;

use crate::video::Plane;

/// Samples of a plane at a time.
const LANES: usize = 4;
/// Blurs from the edge beyond which a sample is all disc or all surround.
const FLAT: f32 = 3.6;
/// Sums of products of two of the eight unknowns, lower triangle by rows.
const PAIRS: usize = 36;

/// Where the disc is, in luma samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct DiscShape {
    pub(super) at_px: [f64; 2],
    pub(super) radius_px: f64,
    /// Standard deviation of the Gaussian that luma's edge is seen through.
    pub(super) blur_px: f64,
}

/// The levels of one plane: surround in the middle, its rise over one radius right and down, disc.
pub(super) type Ground = [f64; 4];

/// One plane of a frame and where its samples lie.
#[derive(Debug, Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) plane: Plane<'a>,
    /// Luma samples from one of its samples to the next, across and down.
    pub(super) pitch: [f64; 2],
    /// Where its first sample lies, in luma samples.
    pub(super) origin: [f64; 2],
    /// Variance by which its edges are blurred more than luma's, in luma samples squared.
    pub(super) more_blur_px2: f64,
}

/// What of a plane is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    /// Its radius.
    pub(super) reach_px: f64,
    /// One over the square of the residual that counts half; zero where all count alike.
    pub(super) doubt: f64,
    /// One of so many rows.
    pub(super) every: usize,
}

/// The sums of one plane's window.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    normal: SMatrix<f64, 8, 8>,
    pull: SVector<f64, 8>,
    squares: f64,
    /// Samples, by their weights.
    pub(super) count: f64,
    /// Sum of squares, not weighted, within 1.2 radii, and the number of samples there.
    pub(super) inner: [f64; 2],
}

/// What a plane says of the shape once its ground is eliminated.
#[derive(Debug, Clone, Copy)]
pub(super) struct Say {
    pub(super) normal: Matrix4<f64>,
    pub(super) pull: Vector4<f64>,
    ground_from_pull: Vector4<f64>,
    ground_from_shape: Matrix4<f64>,
}

impl Say {
    /// The ground's step that goes with the shape's.
    pub(super) fn ground_step(&self, shape_step: &Vector4<f64>) -> Vector4<f64> {
        self.ground_from_pull - self.ground_from_shape * shape_step
    }
}

impl Sums {
    /// Eliminates the ground; none where it is not determined.
    pub(super) fn say(&self) -> Option<Say> {
        let ground: Matrix4<f64> = self.normal.fixed_view::<4, 4>(0, 0).into();
        let cross: Matrix4<f64> = self.normal.fixed_view::<4, 4>(0, 4).into();
        let shape: Matrix4<f64> = self.normal.fixed_view::<4, 4>(4, 4).into();
        let inverse = ground.cholesky()?.inverse();
        let ground_from_shape = inverse * cross;
        let ground_from_pull = inverse * self.pull.fixed_rows::<4>(0);
        let normal = shape - cross.transpose() * ground_from_shape;
        let pull = self.pull.fixed_rows::<4>(4) - cross.transpose() * ground_from_pull;
        Some(Say { normal, pull, ground_from_pull, ground_from_shape })
    }

    /// The sum of squares that is left after these steps.
    pub(super) fn squares_after(&self, ground: &Vector4<f64>, shape: &Vector4<f64>) -> f64 {
        let mut step = SVector::<f64, 8>::zeros();
        step.fixed_rows_mut::<4>(0).copy_from(ground);
        step.fixed_rows_mut::<4>(4).copy_from(shape);
        (self.squares - 2.0 * step.dot(&self.pull) + step.dot(&(self.normal * step))).max(0.0)
    }
}

pub(super) fn sums(view: &View<'_>, shape: &DiscShape, ground: &Ground, window: Window, row: &mut Vec<f32>) -> Sums {
    let Window { reach_px, doubt, every } = window;
    let plane = &view.plane;
    let range = |axis: usize, size: usize| {
        let from = ((shape.at_px[axis] - reach_px - view.origin[axis]) / view.pitch[axis]).ceil().max(0.0) as usize;
        let to = ((shape.at_px[axis] + reach_px - view.origin[axis]) / view.pitch[axis]).floor() + 1.0;
        (from, (to.max(0.0) as usize).min(size))
    };
    let ((left, right), (top, bottom)) = (range(0, plane.width), range(1, plane.height));
    let mut lanes = Lanes::default();
    if left >= right || top >= bottom {
        return lanes.finish();
    }
    let width = right - left;
    row.resize(width.next_multiple_of(LANES), 0.0);
    let blur = (shape.blur_px * shape.blur_px + view.more_blur_px2).sqrt();
    let constants = Constants::new(shape, ground, blur, doubt);
    let step_x = view.pitch[0] as f32;
    let ramp = f32x4::from([0.0, step_x, 2.0 * step_x, 3.0 * step_x]);
    for y in (top..bottom).step_by(every) {
        let dy = y as f64 * view.pitch[1] + view.origin[1] - shape.at_px[1];
        let half = (reach_px * reach_px - dy * dy).max(0.0).sqrt();
        let middle = (shape.at_px[0] - view.origin[0]) / view.pitch[0];
        let from = ((middle - half / view.pitch[0]).ceil().max(0.0) as usize).clamp(left, right);
        let to = ((middle + half / view.pitch[0]).floor().max(-1.0) + 1.0) as usize;
        let to = to.clamp(from, right);
        if from == to {
            continue;
        }
        let samples = &mut row[..(to - from).next_multiple_of(LANES)];
        plane.copy_row(y, from, &mut samples[..to - from]);
        let mut dx = (from as f64 * view.pitch[0] + view.origin[0] - shape.at_px[0]) as f32;
        let dy = f32x4::splat(dy as f32);
        let mut rest = to - from;
        for chunk in samples.chunks_exact(LANES) {
            let samples = f32x4::from([chunk[0], chunk[1], chunk[2], chunk[3]]);
            let there = if rest >= LANES { f32x4::ONE } else { f32x4::from(PARTS[rest]) };
            lanes.add(&constants, samples, f32x4::splat(dx) + ramp, dy, there);
            dx += LANES as f32 * step_x;
            rest = rest.saturating_sub(LANES);
        }
    }
    lanes.finish()
}

const PARTS: [[f32; 4]; 4] = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0], [1.0, 1.0, 1.0, 0.0]];

struct Constants {
    ground: [f32x4; 4],
    radius: f32x4,
    per_radius: f32x4,
    per_blur: f32x4,
    /// Of blur: the plane's own change by luma's.
    blur_rate: f32x4,
    inner: f32x4,
    doubt: f32x4,
}

impl Constants {
    fn new(shape: &DiscShape, ground: &Ground, blur: f64, doubt: f64) -> Self {
        let splat = |value: f64| f32x4::splat(value as f32);
        Self {
            ground: ground.map(splat),
            radius: splat(shape.radius_px),
            per_radius: splat(1.0 / shape.radius_px),
            per_blur: splat(1.0 / blur),
            blur_rate: splat(shape.blur_px / blur),
            inner: splat(1.2 * shape.radius_px),
            doubt: splat(doubt),
        }
    }
}

struct Lanes {
    pairs: [f32x4; PAIRS],
    pull: [f32x4; 8],
    squares: f32x4,
    count: f32x4,
    inner: [f32x4; 2],
}

impl Default for Lanes {
    fn default() -> Self {
        let zero = f32x4::ZERO;
        Self { pairs: [zero; PAIRS], pull: [zero; 8], squares: zero, count: zero, inner: [zero; 2] }
    }
}

impl Lanes {
    #[inline(always)]
    fn add(&mut self, with: &Constants, samples: f32x4, dx: f32x4, dy: f32x4, there: f32x4) {
        let distance = (dx * dx + dy * dy).sqrt().max(f32x4::splat(1e-6));
        let inside = (with.radius - distance) * with.per_blur;
        let ends = inside.to_array();
        let (low, high) = ends.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), &z| (l.min(z), h.max(z)));
        let [b0, b1, b2, disc] = with.ground;
        let weigh = |residual: f32x4| there / (f32x4::ONE + with.doubt * residual * residual);
        if low > FLAT {
            let residual = samples - disc;
            let weight = weigh(residual);
            self.pairs[9] += weight;
            self.pull[3] += weight * residual;
            self.squares += weight * residual * residual;
            self.count += weight;
            self.inner[0] += there * residual * residual;
            self.inner[1] += there;
            return;
        }
        let (u, v) = (dx * with.per_radius, dy * with.per_radius);
        let around = b0 + b1 * u + b2 * v;
        if high < -FLAT {
            let residual = samples - around;
            let weight = weigh(residual);
            let (wu, wv, wr) = (weight * u, weight * v, weight * residual);
            self.pairs[0] += weight;
            self.pairs[1] += wu;
            self.pairs[2] += wu * u;
            self.pairs[3] += wv;
            self.pairs[4] += wv * u;
            self.pairs[5] += wv * v;
            self.pull[0] += wr;
            self.pull[1] += wr * u;
            self.pull[2] += wr * v;
            self.squares += wr * residual;
            self.count += weight;
            return;
        }
        let (share, density) = normal(inside);
        let rest = f32x4::ONE - share;
        let residual = samples - (rest * around + share * disc);
        let weight = weigh(residual);
        let rise = (disc - around) * density * with.per_blur;
        let per_distance = rise / distance;
        let columns = [
            rest,
            rest * u,
            rest * v,
            share,
            per_distance * dx,
            per_distance * dy,
            rise,
            -rise * inside * with.blur_rate,
        ];
        let mut at = 0;
        for (k, &column) in columns.iter().enumerate() {
            let weighted = weight * column;
            for &other in &columns[..=k] {
                self.pairs[at] += weighted * other;
                at += 1;
            }
            self.pull[k] += weighted * residual;
        }
        let squares = residual * residual;
        self.squares += weight * squares;
        self.count += weight;
        let inner = there & distance.simd_lt(with.inner);
        self.inner[0] += inner * squares;
        self.inner[1] += inner;
    }

    fn finish(&mut self) -> Sums {
        let sum = |lanes: f32x4| lanes.to_array().iter().map(|&v| f64::from(v)).sum::<f64>();
        let mut normal = SMatrix::<f64, 8, 8>::zeros();
        let mut at = 0;
        for row in 0..8 {
            for column in 0..=row {
                let value = sum(self.pairs[at]);
                normal[(row, column)] = value;
                normal[(column, row)] = value;
                at += 1;
            }
        }
        Sums {
            normal,
            pull: SVector::from_fn(|k, _| sum(self.pull[k])),
            squares: sum(self.squares),
            count: sum(self.count),
            inner: self.inner.map(sum),
        }
    }
}

/// The normal distribution function and its density (Abramowitz and Stegun, 7.1.26: error below 1e-7 of 1).
#[inline(always)]
fn normal(z: f32x4) -> (f32x4, f32x4) {
    let splat = f32x4::splat;
    let bell = (splat(-0.5) * z * z).exp();
    let x = z.abs() * splat(std::f32::consts::FRAC_1_SQRT_2);
    let t = f32x4::ONE / (f32x4::ONE + splat(0.327_591_1) * x);
    let series = splat(1.061_405_4) * t - splat(1.453_152);
    let series = ((series * t + splat(1.421_413_7)) * t - splat(0.284_496_74)) * t + splat(0.254_829_6);
    let tail = splat(0.5) * series * t * bell;
    let above = z.simd_lt(f32x4::ZERO).select(tail, f32x4::ONE - tail);
    (above, bell * splat(0.398_942_3))
}
