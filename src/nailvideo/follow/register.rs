//! The motion of the nail from the template to a frame, with its standard errors.
//!
//! Gauss-Newton steps in the template's own coordinates (inverse compositional: S. Baker and I. Matthews, Int. J.
//! Comput. Vis. 56 (2004) 221, doi:10.1023/B:VISI.0000011205.11775.fd), affine, with a gain and an offset of the
//! values, each pixel weighted by Tukey's biweight. Own code, as nothing of OpenCV's holds the nail where it blanches:
//! with exactly known motion of real recordings (RMS, px) its `findTransformECC` errs by 8.3 to 14.6, points followed
//! by Lucas and Kanade by 0.4 to 4.4, phase correlation by 7 to 35; this by 0.2 to 0.4, and without the weights by 1.0.
//! With `findTransformECC` on the locally normalized luma a rod over the nail costs 0.6.

use nalgebra::{SMatrix, SVector};
use pulp::{Arch, NullaryFnOnce};

use super::cover::{Covered, Rim};
use super::sight::Sight;
use super::template::{BLOCKS, MOTION, Pixels, TUKEY_SDS, Template, block_of, sd_of};
use crate::median::median_of;
use crate::nailvideo::affine::Affine;
use crate::nailvideo::grid::LANES;

/// The motion's parameters, gain and offset.
const UNKNOWNS: usize = MOTION + 2;
/// Steps at most, and the step after which none follows, pixels at the nail's edge, blocks of a coarser template
/// (measured; with 30 steps, or with first ones that keep the nail's shape, 6 and more frames of 30,766 showed another
/// person's nail, or the nail where it is not).
const MOST_STEPS: usize = 12;
const LAST_STEP_PX: f64 = 0.02;
/// A step of more than this share of the one before is the last as well: what moves the nail then are its own weights,
/// as one by one they drop pixels of a nail that blanches (measured on the phantom's person 42: the motion is 0.05 to
/// 0.15 px off when steps begin to creep, and 0.6 px off where they end, 10 to 20 steps later).
const CREEPING: f64 = 0.8;
/// The last step of a fit that is believed, pixels (measured on person 42: with 0.1 places are up to 0.57 px off, with
/// 0.15 and 0.2 up to 0.23).
pub(super) const MOST_LAST_STEP_PX: f64 = 0.15;
/// Below it a median absolute deviation is rounding: a level of 8 bits, of a luma of 250. Where nothing moves, encoders
/// repeat most of a picture to the bit.
const LEAST_SD: f64 = 0.004;
/// In the first steps the weights reach farther: what a start that is off makes of edges is no outlier yet (without it
/// starts 4 px off stayed there).
const WIDER: [f64; 2] = [4.0, 2.0];

/// A fit of the template to a frame.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    /// From the template's pixels to the frame's.
    pub(super) motion: Affine,
    /// Of the parameters in the template's coordinates.
    pub(super) covariance: SMatrix<f64, MOTION, MOTION>,
    /// Correlation of the evenly spread pixels that have a weight.
    pub(super) ncc: f64,
    /// Share of the evenly spread pixels that have a weight, those outside of the picture counted as having none.
    pub(super) inliers: f64,
    /// Share of the pixels that lie outside of the picture.
    pub(super) outside: f64,
    /// Correlation within blocks of the box, their median: of the texture, which outlines that are alike do not share.
    pub(super) texture: f64,
    /// How the frame's normalized luma grows with the template's, and what it is above it.
    pub(super) gain: f64,
    pub(super) offset: f64,
    /// The residuals' SD.
    pub(super) sd: f64,
    /// The last step, pixels at the nail's edge.
    pub(super) last_step_px: f64,
    /// Of what lies over the nail, where that was looked for.
    pub(super) rim: Option<Rim>,
}

impl Fit {
    /// Whether the steps became so small that no more were needed; else it may still be on its way (measured on nails
    /// of 26 real photographs with noise of 3 levels that move 6 px a frame: fits with last steps of 0.05 to 0.15 px
    /// were up to 12 px off, at the correlation and with the texture of good ones).
    pub(super) fn is_at_rest(&self) -> bool {
        self.last_step_px < LAST_STEP_PX
    }

    /// Whether it is rather the nail's place than another: one at rest, so the one that correlates more.
    pub(super) fn is_better(&self, other: &Self) -> bool {
        let [this, that] = [self, other].map(|fit| (fit.is_at_rest(), fit.ncc));
        this > that
    }
}

/// Memory for residuals, used again for each frame.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    residuals: Vec<f32>,
    values: Vec<f32>,
    sorted: Vec<f32>,
}

/// Fits the template's motion to a frame, from `start` on; `None` where it leads nowhere.
pub(super) fn register(template: &Template, sight: &Sight, start: Affine, scratch: &mut Scratch) -> Option<Fit> {
    fit(template, sight, start, LAST_STEP_PX * template.step, None, scratch)
}

/// The same, and whether something lies over the nail; by what is bare alone where that is asked for.
pub(super) fn register_fine(
    template: &Template,
    sight: &Sight,
    start: Affine,
    by_bare: bool,
    scratch: &mut Scratch,
) -> Option<Fit> {
    let rim = |fit: &Fit, scratch: &Scratch| {
        Rim::of(template, sight, (&fit.motion, fit.gain, fit.offset), &scratch.residuals)
    };
    let whole = fit(template, sight, start, LAST_STEP_PX, None, scratch)?;
    let seen = rim(&whole, scratch);
    let Some(first) = seen.filter(|_| by_bare) else { return Some(Fit { rim: seen, ..whole }) };
    let bare = fit(template, sight, whole.motion, LAST_STEP_PX, Some(&first.covered()), scratch)?;
    Some(Fit { rim: rim(&bare, scratch).or(Some(first)), ..bare })
}

fn fit(
    template: &Template,
    sight: &Sight,
    start: Affine,
    rest_px: f64,
    covered: Option<&Covered>,
    scratch: &mut Scratch,
) -> Option<Fit> {
    let (mut motion, mut gain, mut offset) = (start, 1.0_f64, 0.0_f64);
    let (mut k, mut before_px) = (0, f64::INFINITY);
    // Until the step after a look is so small that there is no need for another.
    let (sd, covariance, last_step_px) = loop {
        let wider = WIDER.get(k).copied();
        let pixels = template.sparse.as_ref().filter(|_| wider.is_some()).unwrap_or(&template.pixels);
        let sd = look(pixels, template, sight, &motion, [gain, offset], covered, scratch)? * wider.unwrap_or(1.0);
        let (normal, right) = equations(pixels, &scratch.residuals, sd);
        let normal = normal.cholesky()?;
        let step = normal.solve(&right);
        // The step moves the template; the frame's motion is that of the frame without it.
        let by: [f64; MOTION] = std::array::from_fn(|k| -step[k] / gain.max(0.2));
        motion = motion.after(&template.motion(&by).inverse()?);
        (gain, offset) = (gain - step[MOTION], offset - step[MOTION + 1]);
        let step_px = farthest(&by);
        if !step_px.is_finite() || !(0.05..20.0).contains(&gain) {
            return None;
        }
        k += 1;
        if wider.is_some() {
            continue;
        }
        let creeps = step_px > CREEPING * before_px && step_px <= MOST_LAST_STEP_PX;
        if step_px < rest_px || creeps || k >= MOST_STEPS {
            let inverse = normal.inverse();
            break (sd, inverse * pulls(pixels, &scratch.residuals, sd)? * inverse / (gain * gain), step_px);
        }
        before_px = step_px;
    };
    let covariance = covariance.fixed_view::<MOTION, MOTION>(0, 0).into_owned();
    let (ncc, inliers, outside) = agreement(template, scratch, sd);
    let texture = texture(template, scratch);
    Some(Fit { motion, covariance, ncc, inliers, outside, texture, gain, offset, sd, last_step_px, rim: None })
}

/// The largest displacement that the parameters make within the box about the nail.
fn farthest(by: &[f64; MOTION]) -> f64 {
    let one = |k: usize| by[k].abs() + by[k + 1].abs() + by[k + 2].abs();
    one(0).hypot(one(3))
}

/// Residuals (template less frame) of some of its pixels into the scratch; their SD.
fn look(
    pixels: &Pixels,
    template: &Template,
    sight: &Sight,
    motion: &Affine,
    [gain, offset]: [f64; 2],
    covered: Option<&Covered>,
    scratch: &mut Scratch,
) -> Option<f64> {
    let Scratch { residuals, values, sorted } = scratch;
    sight.each(motion, &template.corners, pixels.places(), values);
    let (gain, offset) = (gain as f32, offset as f32);
    residuals.clear();
    residuals.extend(pixels.values().iter().zip(&*values).map(|(expected, value)| gain * expected + offset - value));
    if let Some(covered) = covered {
        // What is infinitely off has no weight, and what is no number no texture.
        for ((&cell, residual), value) in pixels.cells.iter().zip(&mut *residuals).zip(values) {
            if covered[usize::from(cell)] {
                (*residual, *value) = (f32::INFINITY, f32::NAN);
            }
        }
    }
    sorted.clear();
    sorted.extend(residuals.iter().map(|residual| residual.abs()));
    sorted.retain(|size| size.is_finite());
    Some(sd_of(sorted)?.max(LEAST_SD))
}

/// For [`weight_of`].
fn per_limit(sd: f64) -> f32 {
    (1.0 / (TUKEY_SDS * sd)) as f32
}

#[inline(always)]
fn weight_of(residual: f32, per_limit: f32) -> f32 {
    let part = residual * per_limit;
    let rest = (1.0 - part * part).max(0.0);
    // A NaN has become nothing: `max` takes the other.
    rest * rest
}

/// Weighted normal equations of a step.
fn equations(
    pixels: &Pixels,
    residuals: &[f32],
    sd: f64,
) -> (SMatrix<f64, UNKNOWNS, UNKNOWNS>, SVector<f64, UNKNOWNS>) {
    let sums = Arch::new().dispatch(Sums { pixels, residuals, per_limit: per_limit(sd) });
    let normal: SMatrix<f64, UNKNOWNS, UNKNOWNS> =
        SMatrix::from_fn(|row, column| sums[row.min(column)][row.max(column)]);
    let right = SVector::from_fn(|row, _| sums[row][UNKNOWNS]);
    // Nothing moves along what nothing determines.
    let least = 1e-9 * normal.trace() / UNKNOWNS as f64;
    (normal + SMatrix::identity() * least, right)
}

/// J'WJ's upper triangle and J'Wr, by the widest vectors that the machine has: single precision within a run of pixels.
struct Sums<'a> {
    pixels: &'a Pixels,
    residuals: &'a [f32],
    per_limit: f32,
}

/// Pixels of a run.
const RUN: usize = 128;

impl NullaryFnOnce for Sums<'_> {
    type Output = [[f64; UNKNOWNS + 1]; UNKNOWNS];

    #[inline(always)]
    fn call(self) -> Self::Output {
        let mut sums = [[[0.0; LANES]; UNKNOWNS + 1]; UNKNOWNS];
        // Of the last run what is beyond the end has no weight.
        let mut columns = [[1.0_f32; RUN]; UNKNOWNS + 1];
        for (k, residuals) in self.residuals.chunks(RUN).enumerate() {
            let run = k * RUN..k * RUN + residuals.len();
            for (column, row) in columns.iter_mut().zip(&self.pixels.rows) {
                column[..residuals.len()].copy_from_slice(&row[run.clone()]);
            }
            let mut weights = [0.0_f32; RUN];
            for ((weight, of), &residual) in weights.iter_mut().zip(&mut columns[UNKNOWNS]).zip(residuals) {
                *weight = weight_of(residual, self.per_limit);
                // What is infinite or no number has no weight.
                *of = if *weight > 0.0 { residual } else { 0.0 };
            }
            for (k, sums) in sums.iter_mut().enumerate() {
                let weighted: [f32; RUN] = std::array::from_fn(|at| weights[at] * columns[k][at]);
                for (sums, column) in sums.iter_mut().zip(&columns).skip(k) {
                    add_products(sums, &weighted, column);
                }
            }
        }
        sums.map(|row| row.map(|lanes| lanes.iter().sum()))
    }
}

/// Adds the products of two columns of a run.
#[inline(always)]
fn add_products(sums: &mut [f64; LANES], one: &[f32; RUN], other: &[f32; RUN]) {
    let mut of_run = [0.0; LANES];
    for (one, other) in one.as_chunks::<LANES>().0.iter().zip(other.as_chunks::<LANES>().0) {
        for k in 0..LANES {
            of_run[k] += one[k] * other[k];
        }
    }
    for k in 0..LANES {
        sums[k] += f64::from(of_run[k]);
    }
}

/// What blocks of the box pull at the parameters, squares and products summed over the blocks: residuals within a block
/// go together, as an encoder moves and keeps whole blocks of its own, so that blocks are counted and not pixels
/// (K.-Y. Liang and S. L. Zeger, Biometrika 73 (1986) 13, doi:10.1093/biomet/73.1.13). `None` of too few blocks.
fn pulls(pixels: &Pixels, residuals: &[f32], sd: f64) -> Option<SMatrix<f64, UNKNOWNS, UNKNOWNS>> {
    let per_limit = per_limit(sd);
    let mut blocks = [[0.0_f32; UNKNOWNS]; BLOCKS * BLOCKS];
    let mut has_weight = [false; BLOCKS * BLOCKS];
    for (k, (&cell, &residual)) in pixels.cells.iter().zip(residuals).enumerate() {
        let weight = weight_of(residual, per_limit);
        if weight == 0.0 {
            continue;
        }
        let (pull, at) = (weight * residual, block_of(cell));
        // In a frame that is the template's own, to the bit, they pull at nothing.
        has_weight[at] = true;
        blocks[at].iter_mut().zip(&pixels.rows).for_each(|(sum, row)| *sum += pull * row[k]);
        blocks[at][UNKNOWNS - 1] += pull;
    }
    let (mut sums, mut count) = (SMatrix::zeros(), 0.0);
    for (pulls, _) in blocks.iter().zip(has_weight).filter(|(_, has_weight)| *has_weight) {
        let pull: SVector<f64, UNKNOWNS> = SVector::from_fn(|row, _| f64::from(pulls[row]));
        sums += pull * pull.transpose();
        count += 1.0;
    }
    // As many are left over as the parameters have not taken.
    let left = count - UNKNOWNS as f64;
    (left >= UNKNOWNS as f64).then(|| sums * (count / left))
}

/// Correlation and share of the evenly spread pixels that have a weight, and the share outside of the picture.
fn agreement(template: &Template, scratch: &Scratch, sd: f64) -> (f64, f64, f64) {
    let limit = TUKEY_SDS * sd;
    let (mut out, mut n) = (0.0, 0.0);
    let (mut x, mut y, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let seen = scratch.residuals.iter().zip(&scratch.values).zip(template.pixels.values());
    for ((&residual, &value), &expected) in seen.take(template.even) {
        if residual.is_nan() {
            out += 1.0;
        } else if f64::from(residual).abs() < limit {
            let (p, q) = (f64::from(expected), f64::from(value));
            (n, x, y) = (n + 1.0, x + p, y + q);
            (xx, xy, yy) = (xx + p * p, xy + p * q, yy + q * q);
        }
    }
    let (sxx, sxy, syy) = (xx - x * x / n, xy - x * y / n, yy - y * y / n);
    let ncc = sxy / (sxx * syy).sqrt();
    let all = template.even as f64;
    (if ncc.is_finite() { ncc } else { 0.0 }, n / all, out / all)
}

/// The median over blocks of the correlation within each.
fn texture(template: &Template, scratch: &Scratch) -> f64 {
    const FEWEST: f64 = 8.0;
    let mut sums = [[0.0_f64; 6]; BLOCKS * BLOCKS];
    let seen = scratch.values.iter().zip(template.pixels.values()).zip(&template.pixels.cells);
    for ((&value, &expected), &cell) in seen.take(template.even).filter(|((value, _), _)| value.is_finite()) {
        let (p, q) = (f64::from(expected), f64::from(value));
        let of = &mut sums[block_of(cell)];
        of.iter_mut().zip([1.0, p, q, p * p, p * q, q * q]).for_each(|(sum, part)| *sum += part);
    }
    let correlation = |&[n, x, y, xx, xy, yy]: &[f64; 6]| {
        let (sxx, sxy, syy) = (xx - x * x / n, xy - x * y / n, yy - y * y / n);
        (n >= FEWEST).then(|| sxy / (sxx * syy).sqrt()).filter(|c| c.is_finite())
    };
    median_of(sums.iter().filter_map(correlation)).unwrap_or(0.0)
}
