//! Rows of the training sets: what a network sees, and what it should answer.

use lunula::photo::outline::Outline;
use lunula::photo::outline::training::{
    Band, Extent, FINGER, Frame, NAIL, OutlineShape, Patch, RAYS, SIDE, STEP, anywhere, inputs, on_finger, own_frame,
    polish, score,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::scenes::{Scene, bell, ends, levels, turn_between};

/// Rows of a network's training set.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) x: Vec<Vec<f32>>,
    pub(super) y: Vec<f32>,
}

impl Rows {
    /// Rows of every scene, each with its own random numbers.
    pub(super) fn gather(
        scenes: &[Scene],
        seed: u64,
        rows: impl Fn(&Scene, &mut ChaCha8Rng, &mut Self) + Sync,
    ) -> Self {
        let parts: Vec<Self> = scenes
            .par_iter()
            .enumerate()
            .map(|(k, scene)| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed + 1000 * k as u64);
                let mut part = Self::default();
                rows(scene, &mut rng, &mut part);
                part
            })
            .collect();
        let mut all = Self::default();
        for part in parts {
            all.x.extend(part.x);
            all.y.extend(part.y);
        }
        all
    }

    /// Adds one.
    pub(super) fn push(&mut self, x: &[f32], y: f64) {
        self.x.push(x.to_vec());
        self.y.push(y as f32);
    }
}

fn within(points: &[[f64; 2]], p: [f64; 2]) -> bool {
    let mut inside = false;
    for (i, a) in points.iter().enumerate() {
        let b = points[(i + 1) % points.len()];
        if (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
            inside = !inside;
        }
    }
    inside
}

/// Cells of a frame with whether the truth holds them.
struct Cells(Vec<([f64; 2], bool)>);

impl Cells {
    fn of(extent: Extent, truth: Option<&[[f64; 2]]>) -> Self {
        let mut cells = Vec::new();
        let n = 44;
        for j in 0..n {
            for i in 0..n {
                let at = |e: [f64; 2], k: usize| e[0] + (e[1] - e[0]) * (k as f64 + 0.5) / n as f64;
                let p = [at(extent.x, i), at(extent.y, j)];
                cells.push((p, truth.is_some_and(|t| within(t, p))));
            }
        }
        Self(cells)
    }

    fn iou(&self, shape: &OutlineShape) -> f64 {
        let (mut both, mut any) = (0u32, 0u32);
        for (p, truth) in &self.0 {
            let own = shape.holds(*p);
            both += u32::from(own && *truth);
            any += u32::from(own || *truth);
        }
        f64::from(both) / f64::from(any.max(1))
    }
}

fn jitter(s: &OutlineShape, k: f64, rng: &mut ChaCha8Rng) -> OutlineShape {
    let size = 0.5 * (s.length + s.width);
    OutlineShape {
        x: s.x + 0.15 * k * size * bell(rng),
        y: s.y + 0.2 * k * size * bell(rng),
        length: s.length * (0.22 * k * bell(rng)).exp(),
        width: s.width * (0.18 * k * bell(rng)).exp(),
        turn: s.turn + 0.22 * k * bell(rng),
        taper: (s.taper + 0.05 * k * bell(rng)).clamp(-0.1, 0.2),
    }
}

/// The template nearest to a polygon of a frame whose distal direction is `turn` clockwise from the frame's +y.
fn nearest(points: &[[f64; 2]], turn: f64, cells: &Cells, rng: &mut ChaCha8Rng) -> (OutlineShape, f64) {
    let (sin, cos) = turn.sin_cos();
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in points {
        let q = [p[0] * cos - p[1] * sin, p[0] * sin + p[1] * cos];
        for i in 0..2 {
            low[i] = low[i].min(q[i]);
            high[i] = high[i].max(q[i]);
        }
    }
    let m = [0, 1].map(|i| (low[i] + high[i]) / 2.0);
    let mut best = OutlineShape {
        x: m[0] * cos + m[1] * sin,
        y: -m[0] * sin + m[1] * cos,
        length: high[1] - low[1],
        width: high[0] - low[0],
        turn,
        taper: 0.03,
    };
    let mut value: f64 = cells.iou(&best);
    for i in 0..120 {
        let next = jitter(&best, if i < 60 { 0.4 } else { 0.15 }, rng);
        let v = cells.iou(&next);
        if v > value {
            (best, value) = (next, v);
        }
    }
    (best, value)
}

/// Templates near the truth and far from it.
pub(super) fn scorer_rows(scene: &Scene, rng: &mut ChaCha8Rng, rows: &mut Rows) {
    let real = scene.real;
    let levels = levels(scene);
    // In fingers' frames.
    for (frame, _) in ends(scene, if real { 40 } else { 6 }) {
        let patch = Patch::cut(&levels, frame, FINGER);
        let truth = scene
            .truths
            .iter()
            .map(|t| (t, t.outline.points().iter().map(|p| frame.source_to_own(*p)).collect::<Vec<_>>()))
            .map(|(t, points)| {
                let cells = Cells::of(FINGER, Some(&points));
                let under =
                    cells.0.iter().filter(|(p, t)| *t && p[0].abs() < 0.4 && (-1.1..0.1).contains(&p[1])).count();
                (t, points, cells, under)
            })
            .max_by_key(|t| t.3)
            .filter(|t| t.3 > 25);
        let mean = OutlineShape { x: 0.0, y: -0.5, length: 0.75, width: 0.65, turn: 0.0, taper: 0.04 };
        match truth {
            Some((t, points, cells, _)) => {
                let turn = t.up.map_or(0.0, |up| turn_between(frame.up, up));
                let (best, _) = nearest(&points, turn, &cells, rng);
                let count = if real { 40 } else { 16 };
                for i in 0..count {
                    let from = if i % 3 == 0 { mean } else { best };
                    let s = jitter(&from, [0.15, 0.35, 0.7, 1.2][i % 4], rng);
                    let off = (s.turn - turn).cos();
                    let worth = if off > 0.3 { 1.0 } else { 0.5 };
                    rows.push(&inputs(&patch, &s, true), cells.iou(&s) * worth);
                }
            }
            None => {
                for i in 0..if real { 12 } else { 8 } {
                    let s = jitter(&mean, [0.5, 1.0][i % 2], rng);
                    rows.push(&inputs(&patch, &s, true), 0.0);
                }
            }
        }
    }
    // In nails' frames, either way up.
    for t in &scene.truths {
        let Some(up) = t.up else { continue };
        let (points, centre, size) = about(&t.outline);
        for _ in 0..3 {
            let angle = 0.3 * bell(rng) + if rng.random_bool(0.3) { std::f64::consts::PI } else { 0.0 };
            let (s, c) = angle.sin_cos();
            let frame = Frame {
                origin: [centre[0] + 0.1 * size * bell(rng), centre[1] + 0.1 * size * bell(rng)],
                up: [up[0] * c - up[1] * s, up[0] * s + up[1] * c],
                unit_px: size * (0.15 * bell(rng)).exp(),
            };
            let patch = Patch::cut(&levels, frame, NAIL);
            let own: Vec<_> = points.iter().map(|p| frame.source_to_own(*p)).collect();
            let cells = Cells::of(NAIL, Some(&own));
            let turn = turn_between(frame.up, up);
            let (best, _) = nearest(&own, turn, &cells, rng);
            for i in 0..if real { 14 } else { 12 } {
                let mut shape = jitter(&best, [0.12, 0.3, 0.6, 1.2][i % 4], rng);
                let mut worth = 1.0;
                if i % 3 == 2 {
                    shape.turn += std::f64::consts::PI;
                    shape.taper = -shape.taper;
                    worth = 0.6;
                }
                rows.push(&inputs(&patch, &shape, false), worth * cells.iou(&shape));
            }
        }
    }
    // Anywhere, where there is nothing.
    if scene.truths.is_empty() {
        let (w, h) = (f64::from(scene.image.width()), f64::from(scene.image.height()));
        let mut places: Vec<Frame> = (0..4)
            .map(|_| Frame {
                origin: [w * rng.random_range(0.2..0.8), h * rng.random_range(0.2..0.8)],
                up: [0.0, -1.0],
                unit_px: h * rng.random_range(0.25..0.8),
            })
            .collect();
        let (patch, found) = anywhere(&levels, 6);
        places.extend(found.iter().map(|(s, _)| Frame {
            origin: patch.frame.to_source([s.x, s.y]),
            up: {
                let (sin, cos) = s.turn.sin_cos();
                [sin, -cos]
            },
            unit_px: s.length * patch.frame.unit_px,
        }));
        for frame in places {
            let patch = Patch::cut(&levels, frame, NAIL);
            for i in 0..6 {
                let base = OutlineShape { x: 0.0, y: 0.0, length: 1.0, width: 0.85, turn: 0.0, taper: 0.03 };
                let s = jitter(&base, [0.2, 0.8][i % 2], rng);
                rows.push(&inputs(&patch, &s, false), 0.0);
            }
        }
    }
}

/// What the search with the present weights takes for nails, rightly or not.
pub(super) fn found_rows(scene: &Scene, rng: &mut ChaCha8Rng, rows: &mut Rows) {
    let levels = levels(scene);
    let truths = |frame: &Frame| -> Vec<(Vec<[f64; 2]>, f64)> {
        scene
            .truths
            .iter()
            .map(|t| {
                let points = t.outline.points().iter().map(|p| frame.source_to_own(*p)).collect();
                (points, t.up.map_or(f64::NAN, |up| turn_between(frame.up, up)))
            })
            .collect()
    };
    let take = |patch: &Patch, shape: &OutlineShape, tip: bool, rows: &mut Rows| {
        let worth = truths(&patch.frame)
            .iter()
            .map(|(points, turn)| {
                let iou = Cells::of(patch.extent, Some(points)).iou(shape);
                // Unknown directions count as the finger's.
                if turn.is_nan() || (shape.turn - turn).cos() > 0.3 { iou } else { 0.5 * iou }
            })
            .fold(0.0, f64::max);
        rows.push(&inputs(patch, shape, tip), worth);
    };
    for (frame, _) in ends(scene, 12) {
        let patch = Patch::cut(&levels, frame, FINGER);
        let coarse = on_finger(&patch, 3);
        coarse.iter().for_each(|(s, _)| take(&patch, s, true, rows));
        for (shape, _) in coarse.into_iter().map(|s| polish(&patch, s, true)) {
            for k in [0.0, 0.15, 0.3] {
                take(&patch, &jitter(&shape, k, rng), true, rows);
            }
        }
    }
    if scene.real {
        return;
    }
    let (coarse, found) = anywhere(&levels, 10);
    for (shape, _) in found {
        take(&coarse, &shape, false, rows);
        let (nail, template) = own_frame(coarse.frame, &shape);
        let patch = Patch::cut(&levels, nail, NAIL);
        let (better, _) = polish(&patch, (template, score(&patch, &template, false)), false);
        for k in [0.0, 0.15, 0.3] {
            take(&patch, &jitter(&better, k, rng), false, rows);
        }
    }
}

/// An outline's corners, their mean, and about its length, pixels.
fn about(outline: &Outline) -> (Vec<[f64; 2]>, [f64; 2], f64) {
    let points = outline.points();
    let n = points.len() as f64;
    let centre = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    (points, centre, outline.area_px2().sqrt() * 1.1)
}

/// Places on rays, by their distance from the truth.
pub(super) fn border_rows(scene: &Scene, rng: &mut ChaCha8Rng, rows: &mut Rows) {
    let levels = levels(scene);
    for t in &scene.truths {
        let Some(up) = t.up else { continue };
        let (points, centre, size) = about(&t.outline);
        let angle = 0.12 * bell(rng);
        let (s, c) = angle.sin_cos();
        let frame = Frame { origin: centre, up: [up[0] * c - up[1] * s, up[0] * s + up[1] * c], unit_px: size };
        let own: Vec<_> = points.iter().map(|p| frame.source_to_own(*p)).collect();
        let cells = Cells::of(NAIL, Some(&own));
        let (best, v) = nearest(&own, turn_between(frame.up, up), &cells, rng);
        if v < 0.75 {
            continue;
        }
        let sd = if scene.real { 2.2 } else { 1.0 };
        for _ in 0..2 {
            let base = jitter(&best, 0.35, rng);
            let band = Band::around(&levels, &frame, &base);
            for k in (rng.random_range(0..3)..RAYS).step_by(if scene.real { 2 } else { 4 }) {
                let (p, nrm) = band.rays[k];
                let at = |m: f64| {
                    let d = (m - SIDE as f64) * STEP * band.half;
                    within(&own, [p[0] + d * nrm[0], p[1] + d * nrm[1]])
                };
                let places = 2 * SIDE;
                let Some(cross) = (0..places).find(|&m| at(m as f64) && !at(m as f64 + 1.0)) else { continue };
                let exact = (0..10)
                    .map(|i| cross as f64 + f64::from(i) / 10.0)
                    .take_while(|m| at(*m))
                    .last()
                    .unwrap_or(cross as f64);
                for i in 0..7 {
                    let m = match i {
                        0 | 1 => exact.round() as i64,
                        2 => exact.round() as i64 + rng.random_range(-2..=2),
                        3 => exact.round() as i64 + rng.random_range(-6..=6),
                        _ => rng.random_range(0..=places as i64),
                    };
                    let m = m.clamp(0, places as i64) as usize;
                    let off = (m as f64 - exact) / sd;
                    rows.push(&band.inputs(k, m), (-off * off / 2.0).exp());
                }
            }
        }
    }
}
