//! Where a marker is to about half a pixel: the centroid of what is nearer to its colour than to its surround's.

use super::sight::Loss;
use crate::median::median;
use crate::posture::marker::looks::look::Look;
use crate::posture::marker::looks::siting::Siting;
use crate::video::Frame;

/// Points of the ring that samples the surround's colour.
const RING: usize = 24;
/// A disc of this share of the marker's area at least is nearer to its colour.
const LEAST_AREA: f64 = 0.4;
const MOST_AREA: f64 = 2.0;

/// The rough centre of the marker of this `look` within a few pixels of `near_px`.
///
/// # Errors
/// Where there is too little of its colour, or too much.
pub(super) fn rough(frame: &Frame<'_>, siting: Siting, look: &Look, near_px: [f64; 2]) -> Result<[f64; 2], Loss> {
    if !near_px.iter().all(|v| v.is_finite()) {
        return Err(Loss::NotFound);
    }
    let mut at = near_px;
    let wide = 1.25 * look.radius_px + 4.0;
    let near = 1.3 * look.radius_px + 1.5;
    for reach in [wide, near, near] {
        let before = at;
        at = centroid(frame, siting, look, at, reach)?;
        if (at[0] - before[0]).hypot(at[1] - before[1]) < 0.1 * look.radius_px {
            break;
        }
    }
    Ok(at)
}

fn centroid(frame: &Frame<'_>, siting: Siting, look: &Look, at: [f64; 2], reach: f64) -> Result<[f64; 2], Loss> {
    let (across, down) = frame.subsampling();
    let pixel = |x: usize, y: usize| -> [f32; 3] {
        let chroma = |k: usize| frame.chroma.map_or(0.0, |planes| planes[k].sample(x / across, y / down));
        [frame.luma.sample(x, y), chroma(0), chroma(1)]
    };
    let (width, height) = (frame.luma.width, frame.luma.height);
    let surround = surround(look, at, reach, (width, height), &pixel);
    // Brighter light makes all differences larger.
    let gain = (surround[0] / look.background[0].max(1.0)).clamp(0.5, 2.0);
    let toward: [f64; 3] = std::array::from_fn(|p| gain * (look.marker[p] - look.background[p]));
    // Luma changes most with light and shade: it counts less where chroma helps.
    let chroma = toward[1].powi(2) + toward[2].powi(2);
    let luma_weight = if chroma > 400.0 { 0.1 } else { 1.0 };
    let weights = [luma_weight, 1.0, 1.0];
    let norm: f64 = (0..3).map(|p| weights[p] * toward[p].powi(2)).sum();
    if norm <= 4.0 || norm.is_nan() {
        return Err(Loss::NotFound);
    }
    let scale: [f64; 3] = std::array::from_fn(|p| weights[p] * toward[p] / norm);
    // A chroma sample at a time, fewer of a large marker.
    let coarser = ((look.radius_px / 12.0) as usize).max(1);
    let steps = [across * coarser, down * coarser];
    let offset = if frame.chroma.is_some() { [siting.dx_px, siting.dy_px] } else { [0.0; 2] };
    let first = |axis: usize| (((at[axis] - reach).max(0.0) as usize) / steps[axis]) * steps[axis];
    let last = |axis: usize, size: usize| ((at[axis] + reach).max(-1.0) + 1.0).min(size as f64) as usize;
    let (mut mass, mut sum) = (0.0, [0.0; 2]);
    for y in (first(1)..last(1, height)).step_by(steps[1]) {
        let py = y as f64 + offset[1];
        for x in (first(0)..last(0, width)).step_by(steps[0]) {
            let px = x as f64 + offset[0];
            if (px - at[0]).powi(2) + (py - at[1]).powi(2) > reach * reach {
                continue;
            }
            let here = pixel(x, y);
            let along: f64 = (0..3).map(|p| scale[p] * (f64::from(here[p]) - surround[p])).sum();
            let share = (2.0 * along - 0.5).clamp(0.0, 1.0);
            mass += share;
            sum[0] += share * px;
            sum[1] += share * py;
        }
    }
    let area = mass * (steps[0] * steps[1]) as f64 / (std::f64::consts::PI * look.radius_px.powi(2));
    if area < LEAST_AREA || area.is_nan() {
        return Err(Loss::NotFound);
    }
    if area > MOST_AREA {
        return Err(Loss::Hidden);
    }
    Ok([sum[0] / mass, sum[1] / mass])
}

/// The median colour on a ring around the marker.
fn surround(
    look: &Look,
    at: [f64; 2],
    reach: f64,
    (width, height): (usize, usize),
    pixel: &dyn Fn(usize, usize) -> [f32; 3],
) -> [f64; 3] {
    let mut values = [[0.0f32; RING]; 3];
    let mut count = 0;
    for k in 0..RING {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / RING as f64).sin_cos();
        let (x, y) = ((at[0] + reach * cos).round(), (at[1] + reach * sin).round());
        if x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64 {
            let here = pixel(x as usize, y as usize);
            (0..3).for_each(|p| values[p][count] = here[p]);
            count += 1;
        }
    }
    if count < RING / 3 {
        return look.background;
    }
    values.map(|mut plane| f64::from(median(&mut plane[..count]).unwrap_or(f32::NAN)))
}
