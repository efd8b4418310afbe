//! Where a nail could be: templates that score well, in a finger's frame or anywhere on a close-up.

use super::evidence::{HasTip, score};
use super::patch::{Extent, Frame, Patch};
use super::picture::Picture;
use super::shape::Shape;

/// What a patch in a finger's frame covers (unit: the finger's width, origin: its apex).
pub(super) const FINGER: Extent = Extent { x: [-0.8, 0.8], y: [-1.6, 0.35], per_unit: 48.0 };
/// What a patch in a nail's frame covers (unit: the nail's length, origin: its centre).
pub(super) const NAIL: Extent = Extent { x: [-1.1, 1.1], y: [-1.05, 1.05], per_unit: 48.0 };

/// A template and its score.
pub(super) type Scored = (Shape, f32);

/// The best `most` different templates in a finger's frame.
pub(super) fn on_finger(patch: &Patch, most: usize) -> Vec<Scored> {
    let mut all = Vec::new();
    for turn in [-0.35, -0.12, 0.12, 0.35] {
        for width in [0.5, 0.6, 0.72, 0.86] {
            for aspect in [0.8, 1.05, 1.4] {
                for gap in [-0.03, 0.06, 0.16, 0.28] {
                    for x in [-0.1, 0.0, 0.1] {
                        let length = width * aspect;
                        let shape = Shape { x, y: -gap - length / 2.0, length, width, turn, taper: 0.04 };
                        all.push((shape, score(patch, &shape, true)));
                    }
                }
            }
        }
    }
    let mut best: Vec<Scored> = best_different(all, most, 0.12).into_iter().map(|s| polish(patch, s, true)).collect();
    best.sort_by(|a, b| b.1.total_cmp(&a.1));
    best
}

/// Templates anywhere on a small picture of a close-up, upright within some 40 degrees or as much upside down.
///
/// The frame's unit is the picture's height, its origin the picture's middle.
pub(super) fn anywhere(picture: &Picture, source_px: [f64; 2], most: usize) -> (Patch, Vec<Scored>) {
    let middle = source_px.map(|s| (s - 1.0) / 2.0);
    let unit_px = source_px[1];
    let wide = source_px[0] / source_px[1] / 2.0;
    let per_unit = f64::from(picture.tone.height());
    let frame = Frame { origin: middle, up: [0.0, -1.0], unit_px };
    let patch = Patch::of(picture, source_px, frame, Extent { x: [-wide, wide], y: [-0.5, 0.5], per_unit });
    let mut all: Vec<Scored> = Vec::new();
    let mut length: f64 = 0.2;
    while length < 1.0 {
        for aspect in [0.85, 1.1, 1.45] {
            let width = length / aspect;
            let stride = 0.1 * length.min(width * 1.2);
            for turn in [-0.5, -0.25, 0.0, 0.25, 0.5] {
                let mut y = -0.5 + 0.35 * length;
                while y <= 0.5 - 0.35 * length {
                    let mut x = -wide + 0.4 * width;
                    while x <= wide - 0.4 * width {
                        let shape = Shape { x, y, length, width, turn, taper: 0.03 };
                        all.push((shape, closed_edge(&patch, &shape)));
                        x += stride;
                    }
                    y += stride;
                }
            }
        }
        length *= 1.2;
    }
    let count = all.len().min(240);
    if all.len() > count {
        all.select_nth_unstable_by(count, |a, b| b.1.total_cmp(&a.1));
        all.truncate(count);
    }
    let both: Vec<Scored> = all
        .iter()
        .flat_map(|(s, _)| [*s, Shape { turn: s.turn + std::f64::consts::PI, ..*s }])
        .map(|s| (s, score(&patch, &s, false)))
        .collect();
    (patch, best_different_scaled(both, most))
}

/// How much of a closed edge of one sign an arc runs along: the cheap look at a template.
fn closed_edge(patch: &Patch, shape: &Shape) -> f32 {
    const POINTS: usize = 16;
    const CONTRAST: [f32; 3] = [0.15, 0.08, 0.08];
    let (sin, cos) = shape.turn.sin_cos();
    let mut arcs = [[0.0f32; 3]; 8];
    for k in 0..POINTS {
        let (v, u) = ((k as f64 + 0.5) / POINTS as f64 * std::f64::consts::TAU).sin_cos();
        // Corners of the rounded box lie farther out than an ellipse's.
        let r = 1.0 + 0.2 * (2.0 * u * v) * (2.0 * u * v);
        let at = |g: f64| {
            let (a, b) = (g * r * u * shape.width / 2.0, g * r * v * shape.length / 2.0);
            patch.index(shape.x + a * cos + b * sin, shape.y - a * sin + b * cos)
        };
        let (inner, outer) = (at(0.86), at(1.14));
        for (c, plane) in patch.planes.iter().enumerate() {
            arcs[k / 2][c] += (plane[outer] - plane[inner]) / CONTRAST[c];
        }
    }
    arcs.iter().map(|arc| arc.iter().map(|s| s.abs()).fold(0.0, f32::max)).map(|s| s / (1.0 + s)).sum()
}

/// The best that are not near a better one (`apart` of the frame's unit, in any number of the shape).
fn best_different(mut all: Vec<Scored>, most: usize, apart: f64) -> Vec<Scored> {
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut kept: Vec<Scored> = Vec::new();
    for (s, value) in all {
        if kept.len() == most {
            break;
        }
        let near = |k: &Shape| {
            let d = [s.x - k.x, s.y - k.y, s.length - k.length, s.width - k.width, 0.4 * (s.turn - k.turn)];
            d.iter().all(|d| d.abs() < apart)
        };
        if !kept.iter().any(|(k, _)| near(k)) {
            kept.push((s, value));
        }
    }
    kept
}

/// The same, where sizes differ much: distances relative to the better one's size.
fn best_different_scaled(mut all: Vec<Scored>, most: usize) -> Vec<Scored> {
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut kept: Vec<Scored> = Vec::new();
    for (s, value) in all {
        if kept.len() == most {
            break;
        }
        let near = |k: &Shape| {
            let apart = (s.x - k.x).hypot(s.y - k.y) / k.length;
            let same_way = (s.turn - k.turn).cos() > 0.0;
            apart < 0.2 && (s.length / k.length).ln().abs() < 0.3 && (s.width / k.width).ln().abs() < 0.3 && same_way
        };
        if !kept.iter().any(|(k, _)| near(k)) {
            kept.push((s, value));
        }
    }
    kept
}

/// Climbs the score by steps in each number of the shape, halved three times.
pub(super) fn polish(patch: &Patch, (mut shape, mut value): Scored, tip: HasTip) -> Scored {
    let size = 0.5 * (shape.length + shape.width);
    let mut step = 0.08;
    for _ in 0..4 {
        for _ in 0..3 {
            let before = value;
            for axis in 0..6 {
                for sign in [-1.0, 1.0] {
                    let d = sign * step;
                    let mut next = shape;
                    match axis {
                        0 => next.x += d * size,
                        1 => next.y += d * size,
                        2 => next.length *= 1.0 + d,
                        3 => next.width *= 1.0 + d,
                        4 => next.turn += 1.2 * d,
                        _ => next.taper = (next.taper + 0.5 * d).clamp(-0.1, 0.2),
                    }
                    let found = score(patch, &next, tip);
                    if found > value {
                        (shape, value) = (next, found);
                    }
                }
            }
            if value - before < 1e-4 {
                break;
            }
        }
        step *= 0.55;
    }
    (shape, value)
}
