//! From a template to the outline: the best closed path through a band around the template's rim.
//!
//! Rays leave the template's rim along its normals. At each place on each ray a small network estimates from the
//! channels' profile how much it looks like a nail's border there; dynamic programming finds the smooth closed path of
//! the greatest sum. Lengths are in mean half axes of the template.

use std::sync::LazyLock;

use nalgebra::{Matrix6, Vector6};

use super::net::Net;
use super::patch::Frame;
use super::picture::Levels;
use super::shape::OutlineShape;
use crate::vision::Cell;

/// Rays around the rim.
pub const RAYS: usize = 64;
/// Places on a ray on either side of the rim.
pub const SIDE: usize = 22;
/// From one place to the next.
pub const STEP: f64 = 0.016;
/// Where the profile is read around a place, in places.
const TAPS: [isize; 9] = [-16, -10, -6, -3, 0, 3, 6, 10, 16];
/// Samples of a ray on either side of the rim.
const LONG: usize = SIDE + 16;
/// Inputs of the network: profiles of three channels, the ray's direction, greyness.
pub(super) const INPUTS: usize = 3 * TAPS.len() + 6;
/// Ordinary contrasts.
const CONTRAST: [f32; 3] = [0.10, 0.05, 0.05];
/// Most places that the path may move from ray to ray.
const STIFF: usize = 4;
/// Price of moving one place, squared places.
const PRICE: f32 = 0.25;

static BORDER: LazyLock<Net> =
    LazyLock::new(|| Net::parse(include_str!("weights/border.txt")).expect("weights are checked by a test"));

/// The rays' channels around a rim.
pub struct Band {
    /// Rim point and unit normal in the frame, for each ray.
    pub rays: Vec<([f64; 2], [f64; 2])>,
    /// Frame units a mean half axis.
    pub half: f64,
    /// `[ray * (2 LONG + 1) + place]`
    profiles: Vec<Cell>,
    colour: bool,
}

/// A refined outline.
#[derive(Debug, Clone)]
pub(super) struct Path {
    /// Offset of each ray from the rim, mean half axes.
    pub(super) offset: Vec<f64>,
    /// The network's answer on each ray.
    pub(super) trust: Vec<f32>,
    /// Corners in the frame.
    pub(super) points: Vec<[f64; 2]>,
}

impl Band {
    /// The band around a template.
    pub fn around(levels: &Levels, frame: &Frame, shape: &OutlineShape) -> Self {
        let half = 0.25 * (shape.length + shape.width);
        let at = |k: f64| {
            let [u, v] = shape.rim(k / RAYS as f64 * std::f64::consts::TAU);
            shape.point(u, v)
        };
        let rays = (0..RAYS)
            .map(|k| {
                let (before, here, after) = (at(k as f64 - 0.5), at(k as f64), at(k as f64 + 0.5));
                let (tx, ty) = (after[0] - before[0], after[1] - before[1]);
                let n = tx.hypot(ty);
                (here, [ty / n, -tx / n])
            })
            .collect();
        Self::of(levels, frame, rays, half)
    }

    /// The band around any rim.
    pub(super) fn of(levels: &Levels, frame: &Frame, rays: Vec<([f64; 2], [f64; 2])>, half: f64) -> Self {
        let count = 2 * LONG + 1;
        let picture = levels.resolving(STEP * half * frame.unit_px);
        let mut raw: Vec<Cell> = Vec::with_capacity(RAYS * count);
        for (p, n) in &rays {
            for m in 0..count {
                let d = (m as f64 - LONG as f64) * STEP * half;
                raw.push(picture.sample(frame.to_source([p[0] + d * n[0], p[1] + d * n[1]])));
            }
        }
        // Neighbouring rays are averaged: the border runs on, noise does not.
        let mut profiles = Vec::with_capacity(RAYS * count);
        for k in 0..RAYS {
            let rows = [RAYS - 1, 0, 1].map(|d| &raw[(k + d) % RAYS * count..][..count]);
            let across = |m: usize, c: usize| 0.25 * (rows[0][m][c] + rows[2][m][c]) + 0.5 * rows[1][m][c];
            for m in 0..count {
                let (a, b) = (m.saturating_sub(1), (m + 1).min(count - 1));
                profiles.push([0, 1, 2].map(|c| 0.25 * (across(a, c) + across(b, c)) + 0.5 * across(m, c)));
            }
        }
        Self { rays, half, profiles, colour: picture.colour }
    }

    /// The network's inputs at place `m` (0 to 2 SIDE) of ray `k`.
    pub fn inputs(&self, k: usize, m: usize) -> [f32; INPUTS] {
        let mut out = [0.0f32; INPUTS];
        let count = 2 * LONG + 1;
        let centre = (k * count + m + LONG - SIDE) as isize;
        let taps = TAPS.map(|t| self.profiles[(centre + t) as usize]);
        for c in 0..if self.colour { 3 } else { 1 } {
            let mean = taps.iter().map(|v| v[c]).sum::<f32>() / TAPS.len() as f32;
            for (to, v) in out[c * TAPS.len()..].iter_mut().zip(&taps) {
                let x = (v[c] - mean) / CONTRAST[c];
                *to = x / (1.0 + 0.3 * x.abs());
            }
        }
        let (sin, cos) = (k as f32 / RAYS as f32 * std::f32::consts::TAU).sin_cos();
        let d = (m as f32 - SIDE as f32) / SIDE as f32;
        let last = [sin, cos.abs(), sin * sin, d, d * d, if self.colour { 0.0 } else { 1.0 }];
        out[3 * TAPS.len()..].copy_from_slice(&last);
        out
    }

    /// The best closed path through every `stride`-th place within `side` places of the rim.
    pub(super) fn path(&self, side: usize, stride: usize) -> Path {
        let places = 2 * (side / stride) + 1;
        let first = SIDE - side / stride * stride;
        let gain: Vec<f32> =
            (0..RAYS * places).map(|i| BORDER.answer(&self.inputs(i / places, first + i % places * stride))).collect();
        let chosen = closed(&gain, places, PRICE * (stride * stride) as f32);
        // Between places: the top of the parabola through the neighbours.
        let offset: Vec<f64> = (0..RAYS)
            .map(|k| {
                let m = chosen[k];
                let fine = if m > 0 && m + 1 < places {
                    let (a, b, c) = (gain[k * places + m - 1], gain[k * places + m], gain[k * places + m + 1]);
                    let bend = a - 2.0 * b + c;
                    if bend < -1e-4 { (0.5 * (a - c) / bend).clamp(-0.5, 0.5) } else { 0.0 }
                } else {
                    0.0
                };
                ((first as f64 - SIDE as f64) + (m as f64 + f64::from(fine)) * stride as f64) * STEP
            })
            .collect();
        let offset = calm(&offset);
        let trust = (0..RAYS).map(|k| gain[k * places + chosen[k]]).collect();
        let points = self
            .rays
            .iter()
            .zip(&offset)
            .map(|((p, n), d)| [p[0] + d * self.half * n[0], p[1] + d * self.half * n[1]])
            .collect();
        Path { offset, trust, points }
    }
}

/// Moves, turns and resizes `shape` towards a path found around it, each ray as far as it is trusted.
pub(super) fn fitted(shape: &OutlineShape, band: &Band, path: &Path) -> OutlineShape {
    let mut normal = Matrix6::<f64>::zeros();
    let mut right = Vector6::<f64>::zeros();
    let (sin, cos) = shape.turn.sin_cos();
    for ((point, n), (offset, trust)) in band.rays.iter().zip(path.offset.iter().zip(&path.trust)) {
        // In the template's own directions: a across, b along.
        let (dx, dy) = (point[0] - shape.x, point[1] - shape.y);
        let (a, b) = (dx * cos - dy * sin, dx * sin + dy * cos);
        let (na, nb) = (n[0] * cos - n[1] * sin, n[0] * sin + n[1] * cos);
        let v = b / (shape.length / 2.0);
        let row = Vector6::new(na, nb, na * a, nb * b, na * b - nb * a, -na * a * v);
        let weight = 0.02 + 1.0 / (1.0 + (-f64::from(*trust)).exp());
        normal += weight * row * row.transpose();
        right += weight * offset * band.half * row;
    }
    // Held a little, so that a short arc does not carry the rest away.
    let hold = 0.02 * normal.trace() / 6.0;
    for i in 0..6 {
        normal[(i, i)] += if i == 5 { 4.0 * hold } else { hold * if i < 2 { 0.2 } else { 0.5 } };
    }
    let Some(step) = normal.cholesky().map(|c| c.solve(&right)) else { return *shape };
    OutlineShape {
        x: shape.x + step[0] * cos + step[1] * sin,
        y: shape.y - step[0] * sin + step[1] * cos,
        width: shape.width * (1.0 + step[2].clamp(-0.3, 0.3)),
        length: shape.length * (1.0 + step[3].clamp(-0.3, 0.3)),
        turn: shape.turn + step[4].clamp(-0.3, 0.3),
        taper: (shape.taper + step[5]).clamp(-0.1, 0.2),
    }
}

/// Dynamic programming around the ring: a lap and a half, of which the middle is kept.
fn closed(gain: &[f32], places: usize, price: f32) -> Vec<usize> {
    let laps = 2 * RAYS;
    let mut best: Vec<f32> = gain[..places].to_vec();
    let mut from: Vec<Vec<usize>> = Vec::with_capacity(laps);
    for step in 1..laps {
        let row = &gain[step % RAYS * places..(step % RAYS + 1) * places];
        let mut next = vec![f32::NEG_INFINITY; places];
        let mut back = vec![0usize; places];
        for m in 0..places {
            let near = m.saturating_sub(STIFF)..(m + STIFF + 1).min(places);
            for (b, before) in near.clone().zip(&best[near]) {
                let moved = m.abs_diff(b) as f32;
                let value = before - price * moved * moved + row[m];
                if value > next[m] {
                    next[m] = value;
                    back[m] = b;
                }
            }
        }
        best = next;
        from.push(back);
    }
    let mut at = (0..places).fold(0, |top, m| if best[m] > best[top] { m } else { top });
    let mut path = vec![0usize; laps];
    for step in (0..laps).rev() {
        path[step] = at;
        if step > 0 {
            at = from[step - 1][at];
        }
    }
    (0..RAYS).map(|k| if k < RAYS / 2 { path[k + RAYS] } else { path[k] }).collect()
}

/// Binomial smoothing along the ring, three rays either way.
fn calm(offset: &[f64]) -> Vec<f64> {
    const WEIGHTS: [f64; 7] = [1.0, 6.0, 15.0, 20.0, 15.0, 6.0, 1.0];
    (0..RAYS).map(|k| (0..7).map(|i| WEIGHTS[i] * offset[(k + RAYS + i - 3) % RAYS]).sum::<f64>() / 64.0).collect()
}
