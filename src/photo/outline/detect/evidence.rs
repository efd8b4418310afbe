//! What speaks for a nail's outline at a place: steps and creases along the rim, arc by arc.

use std::sync::LazyLock;

use super::net::Net;
use super::patch::Patch;
use super::shape::{EXPONENT, OutlineShape};

/// Rim points: four arcs of 8.
const POINTS: usize = 32;
/// Features of a channel.
const EACH: usize = 27;
/// Number of inputs of the scorer.
pub const INPUTS: usize = 3 * EACH + 10;
/// Distances from the rim along the normal, in mean half axes, at which the channels are read.
const REACH: [f32; 6] = [-0.30, -0.15, 0.0, 0.15, 0.30, 0.60];
/// Ordinary contrasts of tone, ln(R/G), ln(G/B): what a feature of 1 means.
const CONTRAST: [f32; 3] = [0.15, 0.08, 0.08];

/// Rim in (u, v) without taper, and the direction of its normal for a shape as long as wide.
static RIM: LazyLock<[[f32; 4]; POINTS]> = LazyLock::new(|| {
    std::array::from_fn(|k| {
        let (s, c) = ((k as f64 + 0.5) / POINTS as f64 * std::f64::consts::TAU).sin_cos();
        let r = (c.abs().powf(EXPONENT) + s.abs().powf(EXPONENT)).powf(-1.0 / EXPONENT);
        let (u, v) = (r * c, r * s);
        let slope = |x: f64| x.abs().powf(EXPONENT - 1.0) * x.signum();
        [u, v, slope(u), slope(v)].map(|x| x as f32)
    })
});

static SCORER: LazyLock<Net> =
    LazyLock::new(|| Net::parse(include_str!("weights/scorer.txt")).expect("weights are checked by a test"));

/// How likely it is that `shape` outlines a nail: an estimate of its IoU with one (worth less upside down); `tip` where
/// the frame is a finger's: origin at its apex, unit its width.
pub fn score(patch: &Patch, shape: &OutlineShape, tip: bool) -> f32 {
    SCORER.answer(&inputs(patch, shape, tip))
}

/// The scorer's inputs.
pub fn inputs(patch: &Patch, shape: &OutlineShape, tip: bool) -> [f32; INPUTS] {
    let mut ring = [[[0.0f32; REACH.len()]; POINTS]; 3];
    let [x, y, length, width, taper] = [shape.x, shape.y, shape.length, shape.width, shape.taper].map(|v| v as f32);
    let half = 0.25 * (length + width);
    let (sin, cos) = (shape.turn.sin() as f32, shape.turn.cos() as f32);
    for (k, &[u, v, nu, nv]) in RIM.iter().enumerate() {
        let (a, b) = (0.5 * u * (1.0 - taper * v) * width, 0.5 * v * length);
        let (na, nb) = (nu / width, nv / length);
        let n = half / (na * na + nb * nb).sqrt();
        let (na, nb) = (na * n, nb * n);
        for (m, d) in REACH.iter().enumerate() {
            let (p, q) = (a + na * d, b + nb * d);
            let cell = patch.at(x + p * cos + q * sin, y - p * sin + q * cos);
            for (ring, value) in ring.iter_mut().zip(cell) {
                ring[k][m] = value;
            }
        }
    }
    let mut out = [0.0f32; INPUTS];
    for (c, ring) in ring.iter().enumerate().take(if patch.colour { 3 } else { 1 }) {
        channel(ring, CONTRAST[c], &mut out[c * EACH..(c + 1) * EACH]);
    }
    let aspect = (shape.length / shape.width).ln();
    let last = &mut out[3 * EACH..];
    last[0] = aspect as f32;
    last[1] = (aspect * aspect) as f32;
    last[2] = if patch.colour { 0.0 } else { 1.0 };
    if tip {
        let gap = -(shape.y + 0.5 * shape.length);
        let own = [1.0, shape.x.abs(), gap, shape.width.ln(), shape.length.ln(), shape.turn.abs(), shape.taper];
        for (to, from) in last[3..].iter_mut().zip(own) {
            *to = from as f32;
        }
    }
    out
}

/// Distal, left, proximal or right.
fn arc(point: usize) -> usize {
    match point {
        4..12 => 0,
        12..20 => 1,
        20..28 => 2,
        _ => 3,
    }
}

fn channel(ring: &[[f32; REACH.len()]; POINTS], contrast: f32, out: &mut [f32]) {
    let squash = |x: f32| (x / contrast).clamp(-2.5, 2.5);
    // Eight arcs of 4 from the right side on: 0 and 7 right, 1 and 2 distal, ...
    let mut fine = [[0.0f32; REACH.len()]; 8];
    let mut mean = [[0.0f32; REACH.len()]; 4];
    let (mut sum, mut square) = (0.0f32, 0.0f32);
    for (k, r) in ring.iter().enumerate() {
        for (to, from) in mean[arc(k)].iter_mut().zip(r) {
            *to += from / 8.0;
        }
        for (to, from) in fine[k / 4].iter_mut().zip(r) {
            *to += from / 4.0;
        }
        sum += r[0];
        square += r[0] * r[0];
    }
    let n = POINTS as f32;
    let spread = (square / n - (sum / n).powi(2)).max(0.0).sqrt();
    let step = mean.map(|m| m[3] - m[1]);
    let wide = mean.map(|m| m[4] - m[0]);
    let crease = mean.map(|m| m[3] + m[1] - 2.0 * m[2]);
    let beyond = mean.map(|m| m[5] - m[4]);
    let values = [
        step[0],
        0.5 * (step[1] + step[3]),
        step[2],
        0.5 * (step[1].abs() + step[3].abs()),
        step[1].abs().min(step[3].abs()),
        crease[0],
        0.5 * (crease[1] + crease[3]),
        crease[2],
        spread,
        wide[2],
        0.5 * (wide[1] + wide[3]),
        (mean[1][4] - mean[3][4]).abs(),
        beyond[0],
        0.5 * (beyond[1] + beyond[3]),
        beyond[2],
    ];
    for (to, from) in out.iter_mut().zip(values) {
        *to = squash(from);
    }
    // Left and right together, from the distal end to the proximal: weakest step, difference, weakest crease.
    for (pair, to) in [[1, 2], [0, 3], [7, 4], [6, 5]].iter().zip(out[values.len()..].chunks_exact_mut(3)) {
        let [step, crease] = [1usize, 2]
            .map(|d| pair.map(|a| fine[a]).map(|m| if d == 1 { m[3] - m[1] } else { m[3] + m[1] - 2.0 * m[2] }));
        let weakest = |x: [f32; 2]| if x[0].abs() < x[1].abs() { x[0] } else { x[1] };
        to[0] = squash(weakest(step));
        to[1] = squash((step[0] - step[1]).abs());
        to[2] = squash(weakest(crease));
    }
}
