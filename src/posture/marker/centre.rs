//! A marker's centre to a fraction of a pixel, with its standard error.
//!
//! In: a frame, where its chroma lies ([`Siting`]), how the marker looks ([`Look`]) and where it is within a few
//! pixels. Out: a [`Fit`], or why there is none. The rough place is the centroid of what is nearer to the marker's
//! colour than to its surround's; from there a blurred disc is fitted to luma and chroma together ([`disc`]), each
//! plane weighted by what it leaves unexplained. Radius and blur are free but held near what other frames showed; light
//! may change, for all levels are free. A centre is refused where what is left unexplained is more than noise, as when
//! something covers a part of the marker; it is held near the rough place of a marker that stands out by its colour, as
//! shade on the marker and the finger's own edge beside it draw luma's disc aside. A marker that is no disc has the
//! centre of its outline ([`super::blot`]).
//!
//! The covariance is that of independent noise, times the square of [`Look::inflation`]: what a codec changes is not
//! independent from sample to sample, for it moves whole blocks ([`super::inflation`]); and that of a streak, where a
//! marker moves during the exposure by more than the model of an edge that is blurred explains; and by how far the
//! outline's centre lies beside, where the marker was learnt.
//!
//! [`disc`]: super::disc

use nalgebra::{Matrix2, Matrix4, Vector4};

use super::blot::Outline;
use super::disc::{DiscShape, Ground, Say, View, Window, sums};
use super::fit::Fit;
use super::method::Method;
use super::rough::rough;
use super::sight::{Centre, Loss};
use crate::posture::marker::looks::look::Look;
use crate::posture::marker::looks::siting::Siting;
use crate::video::Frame;

/// A step that is small enough.
const SMALL_STEP_PX: f64 = 0.05;
/// A round's longest step, in radii.
const LONGEST_STEP: f64 = 0.35;
/// How sure the learned radius (as a share) and blur (pixels, and as a share) are.
const RADIUS_SD: f64 = 0.03;
const BLUR_SD_PX: f64 = 0.1;
/// A plane's noise is taken as at least this: what a codec gets wrong of a place is not in the residuals, and is alike
/// in all planes (measured: with 0.3, 3 and 10, J2 of a scene at crf 30 is wrong by 0.20, 0.19 and 0.18 degrees RMS; at
/// crf 16 by 0.036, 0.035, 0.035).
const LEAST_NOISE: f64 = 6.0;
/// Residuals further than so many times the noise count less.
const DOUBT: f64 = 4.0;
/// The share of the marker's contrast, squared, that may stay unexplained within it, and how many times what is usual.
const MISFIT: f64 = 0.03;
const MISFIT_USUAL: f64 = 3.0;
/// What is unexplained beyond this, and so many times the least, is no noise but a streak, which a long exposure makes
/// of a marker that moves: the fit takes hold of it somewhere. Measured on nine phantoms (`--trajectory free --bend-hz
/// 0.5, 1, 1.5 --blur 0.4, 0.8, 0.95`): where a marker moves by more than 20 px a frame, errors are 1.1 times the
/// standard error with these, and up to 5 times without.
const STREAK: f64 = 0.0075;
const STREAK_LEAST: f64 = 1.5;
/// The variance that it makes, in squared radii.
const STREAK_VARIANCE: f64 = 1.4;
/// The fit of a marker of which chroma shows more than luma is free within so many pixels and radii of the rough place
/// (measured: 99 of 100 centres of phantoms without long streaks are, clean, hard, small and coarsely encoded). Beyond,
/// both may be wrong, the fit more so. Measured on discs put onto photographs of real hands, yellow, with a shaded side
/// or in dim light: fits that are further off are wrong by 1.3 to 3.7 px RMS, the rough places by 0.5 to 1.0; of marks
/// of which luma shows more, black, white and brown ones, fits by 0.3 to 0.5 and the rough places by 1.0 to 1.7.
const FREE_PX: f64 = 0.3;
const FREE_RADII: f64 = 0.05;
/// ... where chroma's planes by themselves say so as well: by so much of how far the two are apart, and so many pixels
/// (measured: there 0.8 to 3 times; 0 where the ground behind the marker has two colours, of which the rough place
/// knows nothing; 0.5 px is what chroma that is assumed in the wrong place makes).
const SAID: f64 = 0.5;
const LEAST_SAID_PX: f64 = 0.6;
/// The standard error of a coordinate, as a share of how far the two are apart beyond that (measured on the same: 0.3
/// to 0.5).
const HELD_SD: f64 = 0.5;
/// By how much a radius may differ from the learned one, as a share, and in pixels.
const RADIUS_CHANGE: f64 = 0.08;
const RADIUS_CHANGE_PX: f64 = 0.4;
/// How alike a marker's contrast has to be to the learned one: cosine, and the share of its size.
const LEAST_COSINE: f64 = 0.9;
const LEAST_CONTRAST: f64 = 0.5;

/// Room for samples, to be used again, and how to use it.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    row: Vec<f32>,
    /// How centres are found.
    pub(crate) method: Method,
}

impl Scratch {
    /// For centres that are found so.
    pub(crate) fn new(method: Method) -> Self {
        Self { method, ..Self::default() }
    }
}

/// The centre of the marker of this `look` within a few pixels of `near_px`.
pub(crate) fn centre(
    frame: &Frame<'_>,
    siting: Siting,
    look: &Look,
    near_px: [f64; 2],
    scratch: &mut Scratch,
) -> Result<Fit, Loss> {
    if let Some(blot) = &look.blot {
        return blot.outline(frame, siting, near_px).map(|outline| of_blot(look, outline));
    }
    let at_px = rough(frame, siting, look, near_px)?;
    if scratch.method.rounds == 0 {
        return unrefined(frame, look, at_px);
    }
    let fit = fit(frame, siting, look, at_px, scratch)?;
    judge(&fit, look)?;
    Ok(held(fit, look, at_px))
}

/// A fit that is held near the rough place.
fn held(mut fit: Fit, look: &Look, rough_px: [f64; 2]) -> Fit {
    let contrast: [f64; 3] = std::array::from_fn(|p| (look.marker[p] - look.background[p]).powi(2));
    let off_px = [0, 1].map(|axis| fit.centre.at_px[axis] - rough_px[axis]);
    let [apart_px, free_px] = [off_px[0].hypot(off_px[1]), FREE_PX + FREE_RADII * fit.centre.radius_px];
    let said_px = fit.chroma_shift_px.map_or(0.0, |([x, y], _)| -(x * off_px[0] + y * off_px[1]) / apart_px);
    let is_said = said_px >= LEAST_SAID_PX.max(SAID * apart_px);
    if apart_px <= free_px || contrast[1] + contrast[2] < contrast[0] || !is_said {
        return fit;
    }
    let kept = (free_px / apart_px).powi(2);
    fit.centre.at_px = [0, 1].map(|axis| rough_px[axis] + kept * off_px[axis]);
    fit.doubt(HELD_SD * (apart_px * apart_px - free_px * free_px).sqrt());
    fit.is_held = true;
    fit
}

/// The centroid as it is, with the standard error that independent noise would give it.
fn unrefined(frame: &Frame<'_>, look: &Look, at_px: [f64; 2]) -> Result<Fit, Loss> {
    let shape = DiscShape { at_px, radius_px: look.radius_px, blur_px: look.blur_px };
    if !in_the_picture(frame, &shape) {
        return Err(Loss::AtTheBorder);
    }
    let (mut contrast, mut noise) = (0.0, 0.0);
    for p in 0..3 {
        contrast += (look.marker[p] - look.background[p]).powi(2);
        noise += look.noise[p].powi(2);
    }
    // Samples of noise n / c, over a disc of area A, weighed by their distance from the centre: A / (4 pi) (n / c)^2 /
    // A.
    let variance = noise / (contrast * 4.0 * std::f64::consts::PI);
    let white_px2 = [variance, 0.0, variance];
    let covariance_px2 = white_px2.map(|v| v * look.inflation.powi(2));
    let centre = Centre { at_px, covariance_px2, lasting_px2: [0.0; 3], radius_px: look.radius_px };
    Ok(look.unfitted(centre, white_px2))
}

/// A blot's centre, the error of its outline beside that of noise.
fn of_blot(look: &Look, outline: Outline) -> Fit {
    let Outline { at_px, white_px2, lasting_px2, marker, background, noise, .. } = outline;
    let factor = look.inflation.powi(2);
    let covariance_px2 = std::array::from_fn(|k| factor * white_px2[k] + lasting_px2[k]);
    let centre = Centre { at_px, covariance_px2, lasting_px2, radius_px: outline.radius_px() };
    Fit { marker, background, noise, outline: Some(outline), ..look.unfitted(centre, white_px2) }
}

/// The fit from a place that is right within a pixel or so, not judged.
pub(super) fn fit(
    frame: &Frame<'_>,
    siting: Siting,
    look: &Look,
    at_px: [f64; 2],
    scratch: &mut Scratch,
) -> Result<Fit, Loss> {
    let method = scratch.method;
    let (views, planes) = views(frame, siting);
    let views = &views[..planes];
    let mut shape = DiscShape { at_px, radius_px: look.radius_px, blur_px: look.blur_px };
    let mut grounds: [Ground; 3] = std::array::from_fn(|p| [look.background[p], 0.0, 0.0, look.marker[p]]);
    let mut noise = look.noise;
    let prior = prior(look);
    let mut last: Option<([Option<Say>; 3], Matrix4<f64>)> = None;
    let mut inner = [[0.0; 2]; 3];
    for round in 0..method.rounds.max(1) {
        if !in_the_picture(frame, &shape) {
            return Err(Loss::AtTheBorder);
        }
        let reach_px = shape.radius_px + surround_px(look);
        let mut total = prior;
        let mut pull = Vector4::new(
            0.0,
            0.0,
            prior[(2, 2)] * (look.radius_px - shape.radius_px),
            prior[(3, 3)] * (look.blur_px - shape.blur_px),
        );
        let mut says = [None; 3];
        let mut gathered = [const { None }; 3];
        for (p, view) in views.iter().enumerate().filter(|(p, _)| method.planes.uses(*p, planes)) {
            let doubt = if round < 1 { 0.0 } else { (DOUBT * noise[p]).powi(-2) };
            // The first round need not see all: about ten rows of the disc.
            let rows = shape.radius_px / (5.0 * view.pitch[1]);
            let every = if round < 1 { (rows as usize).max(1) } else { 1 };
            let window = Window { reach_px, doubt, every };
            let one = sums(view, &shape, &grounds[p], window, &mut scratch.row);
            // The ground's levels have to be determined by enough samples.
            says[p] = if one.count >= 8.0 { one.say() } else { None };
            inner[p] = one.inner;
            gathered[p] = Some(one);
        }
        if round == 0 {
            // The levels are not those of the learned frame yet: what they leave is no noise.
            for p in 0..planes {
                let (Some(say), Some(one)) = (&says[p], &gathered[p]) else { continue };
                let zero = Vector4::zeros();
                noise[p] = (one.squares_after(&say.ground_step(&zero), &zero) / (one.count - 5.0)).sqrt();
            }
        }
        for p in 0..planes {
            let Some(say) = &says[p] else { continue };
            let weight = noise[p].max(LEAST_NOISE).powi(-2);
            total += say.normal * weight;
            pull += say.pull * weight;
        }
        let mut step = total.cholesky().ok_or(Loss::NotFound)?.solve(&pull);
        let length = step[0].hypot(step[1]);
        let longest = LONGEST_STEP * shape.radius_px;
        if !(length.is_finite() && step[2].is_finite() && step[3].is_finite()) {
            return Err(Loss::NotFound);
        }
        if length > longest {
            step *= longest / length;
        }
        step[2] = step[2].clamp(-0.2 * shape.radius_px, 0.2 * shape.radius_px);
        step[3] = step[3].clamp(-0.4 * shape.blur_px, 0.4 * shape.blur_px);
        for p in 0..planes {
            let (Some(say), Some(one)) = (&says[p], &gathered[p]) else { continue };
            let levels = say.ground_step(&step);
            noise[p] = (one.squares_after(&levels, &step) / (one.count - 5.0)).sqrt();
            (0..4).for_each(|k| grounds[p][k] += levels[k]);
            grounds[p][0] += (grounds[p][1] * step[0] + grounds[p][2] * step[1]) / shape.radius_px;
        }
        shape.at_px[0] += step[0];
        shape.at_px[1] += step[1];
        shape.radius_px += step[2];
        shape.blur_px = (shape.blur_px + step[3]).clamp(0.2, 0.6 * shape.radius_px.max(1.0));
        last = Some((says, total));
        if round >= 1 && length <= SMALL_STEP_PX {
            break;
        }
    }
    let far = 0.5 * look.radius_px + 1.0;
    let (says, total) = last.ok_or(Loss::NotFound)?;
    if !in_the_picture(frame, &shape) {
        return Err(Loss::AtTheBorder);
    }
    if (shape.at_px[0] - at_px[0]).hypot(shape.at_px[1] - at_px[1]) > far {
        return Err(Loss::NotFound);
    }
    let covariance = total.cholesky().ok_or(Loss::NotFound)?.inverse();
    let white_px2 = [covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]];
    let marker: [f64; 3] = std::array::from_fn(|p| if p < planes { grounds[p][3] } else { 0.0 });
    let background: [f64; 3] = std::array::from_fn(|p| if p < planes { grounds[p][0] } else { 0.0 });
    let contrast: f64 = marker.iter().zip(&background).map(|(a, b)| (a - b).powi(2)).sum();
    let unexplained: f64 = inner[..planes].iter().map(|[squares, count]| squares / count.max(1.0)).sum();
    let factor = look.inflation.powi(2);
    let misfit = unexplained / contrast;
    let streak = STREAK_VARIANCE * (misfit - STREAK_LEAST * look.least_misfit - STREAK).max(0.0);
    let lasting_px2 = [1.0, 0.0, 1.0].map(|axis| axis * (streak * shape.radius_px.powi(2) + look.apart_px2));
    let centre = Centre {
        at_px: shape.at_px,
        covariance_px2: std::array::from_fn(|k| white_px2[k] * factor + lasting_px2[k]),
        lasting_px2,
        radius_px: shape.radius_px,
    };
    let finite = white_px2.iter().chain(&shape.at_px).chain(&marker).chain(&background).all(|v| v.is_finite());
    if !(finite && contrast > 0.0) {
        return Err(Loss::NotFound);
    }
    Ok(Fit {
        centre,
        white_px2,
        marker,
        background,
        blur_px: shape.blur_px,
        misfit,
        noise,
        chroma_shift_px: chroma_shift(&says, &noise),
        outline: None,
        is_held: false,
    })
}

/// Luma's and chroma's planes, and how many there are.
fn views<'a>(frame: &Frame<'a>, siting: Siting) -> ([View<'a>; 3], usize) {
    let luma = View { plane: frame.luma, pitch: [1.0; 2], origin: [0.0; 2], more_blur_px2: 0.0 };
    let Some([cb, cr]) = frame.chroma else { return ([luma; 3], 1) };
    let (across, down) = frame.subsampling();
    let pitch = [across as f64, down as f64];
    // Where a chroma sample covers two luma samples it is a mean over about as much.
    let more_blur_px2 = 0.08 * (pitch[0] * pitch[0] + pitch[1] * pitch[1] - 2.0);
    let chroma = |plane| View { plane, pitch, origin: [siting.dx_px, siting.dy_px], more_blur_px2 };
    ([luma, chroma(cb), chroma(cr)], 3)
}

/// How far around the disc the fit looks.
fn surround_px(look: &Look) -> f64 {
    (1.0 + 0.3 * look.radius_px).clamp(2.5, 8.0)
}

fn prior(look: &Look) -> Matrix4<f64> {
    let radius_sd = (RADIUS_SD * look.radius_px).max(0.05);
    let blur_sd = BLUR_SD_PX.max(0.2 * look.blur_px);
    Matrix4::from_diagonal(&Vector4::new(1e-9, 1e-9, radius_sd.powi(-2), blur_sd.powi(-2)))
}

fn in_the_picture(frame: &Frame<'_>, shape: &DiscShape) -> bool {
    let reach = shape.radius_px + 0.5;
    let side = |at: f64, size: usize| at - reach >= -0.5 && at + reach <= size as f64 - 0.5;
    side(shape.at_px[0], frame.luma.width) && side(shape.at_px[1], frame.luma.height)
}

fn chroma_shift(says: &[Option<Say>; 3], noise: &[f64; 3]) -> Option<([f64; 2], f64)> {
    let of = |planes: &[usize]| {
        let (mut normal, mut pull) = (Matrix2::zeros(), nalgebra::Vector2::zeros());
        for &p in planes {
            let say = says[p]?;
            let weight = noise[p].max(LEAST_NOISE).powi(-2);
            normal += say.normal.fixed_view::<2, 2>(0, 0) * weight;
            pull += say.pull.fixed_rows::<2>(0) * weight;
        }
        let inverse = normal.try_inverse()?;
        Some((inverse * pull, 0.5 * inverse.trace()))
    };
    let ((luma, luma_var), (chroma, chroma_var)) = (of(&[0])?, of(&[1, 2])?);
    let shift = chroma - luma;
    Some(([shift[0], shift[1]], (luma_var + chroma_var).sqrt()))
}

/// Whether this can be the marker, seen whole.
fn judge(fit: &Fit, look: &Look) -> Result<(), Loss> {
    let (mut dot, mut here, mut learned) = (0.0, 0.0, 0.0);
    for p in 0..3 {
        let (a, b) = (fit.marker[p] - fit.background[p], look.marker[p] - look.background[p]);
        dot += a * b;
        here += a * a;
        learned += b * b;
    }
    if !(dot >= LEAST_COSINE * (here * learned).sqrt() && dot >= LEAST_CONTRAST * learned) {
        return Err(Loss::Hidden);
    }
    let change = (fit.centre.radius_px - look.radius_px).abs();
    let allowed = (RADIUS_CHANGE * look.radius_px).max(RADIUS_CHANGE_PX);
    let whole = change <= allowed && fit.misfit <= MISFIT + MISFIT_USUAL * look.misfit;
    if whole { Ok(()) } else { Err(Loss::Hidden) }
}

#[cfg(test)]
mod tests;
