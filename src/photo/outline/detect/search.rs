//! Where a nail could be: templates that score well, in a finger's frame or anywhere on a close-up.

use super::evidence::score;
use super::patch::{Extent, Frame, Patch};
use super::picture::Levels;
use super::shape::{OutlineShape, TAPER};

/// What a patch in a finger's frame covers (unit: the finger's width, origin: its apex).
pub const FINGER: Extent = Extent { x: [-0.8, 0.8], y: [-1.6, 0.35], per_unit: 40.0 };
/// What a patch in a nail's frame covers (unit: the nail's length, origin: its centre).
pub const NAIL: Extent = Extent { x: [-1.1, 1.1], y: [-1.05, 1.05], per_unit: 48.0 };

/// Longest side of the picture that a close-up is searched on.
const COARSE_PX: usize = 112;

/// A template and its score.
pub type Scored = (OutlineShape, f32);

/// Templates tried in a finger's frame.
fn finger_grid() -> impl Iterator<Item = OutlineShape> {
    let all = |turn| [0.52, 0.65, 0.82].map(|width| (turn, width));
    [-0.3, 0.0, 0.3].into_iter().flat_map(all).flat_map(|(turn, width)| {
        [0.85, 1.25].into_iter().flat_map(move |aspect| {
            [-0.02, 0.1, 0.24].into_iter().flat_map(move |gap| {
                [-0.07, 0.07].into_iter().map(move |x| {
                    let length = width * aspect;
                    OutlineShape { x, y: -gap - length / 2.0, length, width, turn, taper: 0.04 }
                })
            })
        })
    })
}

/// The best `most` different templates of a coarse grid in a finger's frame.
pub fn on_finger(patch: &Patch, most: usize) -> Vec<Scored> {
    best_different(finger_grid().map(|s| (s, score(patch, &s, true))).collect(), most, 0.12)
}

/// Templates anywhere on a small picture of a close-up, upright within some 40 degrees or as much upside down.
///
/// The frame's unit is the picture's height, its origin the picture's middle.
pub fn anywhere(levels: &Levels, most: usize) -> (Patch, Vec<Scored>) {
    let picture = levels.within(COARSE_PX);
    let unit_px = levels.source_px[1];
    let wide = levels.source_px[0] / levels.source_px[1] / 2.0;
    let frame = Frame { origin: levels.source_px.map(|s| (s - 1.0) / 2.0), up: [0.0, -1.0], unit_px };
    let per_unit = COARSE_PX as f64 * unit_px / levels.source_px[0].max(levels.source_px[1]);
    let patch = Patch::of(picture, frame, Extent { x: [-wide, wide], y: [-0.5, 0.5], per_unit });
    let mut all: Vec<Scored> = Vec::new();
    let mut length: f64 = 0.25;
    while length < 1.0 {
        for aspect in [0.85, 1.1, 1.45] {
            let width = length / aspect;
            let stride = 0.15 * length.min(width * 1.2);
            for turn in [-0.4, 0.0, 0.4] {
                let rim = rim(length, width, turn);
                let mut y = -0.5 + 0.38 * length;
                while y <= 0.5 - 0.38 * length {
                    let mut x = -wide + 0.42 * width;
                    while x <= wide - 0.42 * width {
                        let value = closed_edge(&patch, [x as f32, y as f32], &rim);
                        all.push((OutlineShape { x, y, length, width, turn, taper: TAPER }, value));
                        x += stride;
                    }
                    y += stride;
                }
            }
        }
        length *= 1.22;
    }
    let count = all.len().min(150);
    if all.len() > count {
        all.select_nth_unstable_by(count, |a, b| b.1.total_cmp(&a.1));
        all.truncate(count);
    }
    let both: Vec<Scored> = all
        .iter()
        .flat_map(|(s, _)| [*s, OutlineShape { turn: s.turn + std::f64::consts::PI, ..*s }])
        .map(|s| (s, score(&patch, &s, false)))
        .collect();
    (patch, best_different_scaled(both, most))
}

/// Points of the cheap look, inside and outside of the border, from the centre.
fn rim(length: f64, width: f64, turn: f64) -> [[[f32; 2]; 2]; 16] {
    let (sin, cos) = turn.sin_cos();
    std::array::from_fn(|k| {
        let (v, u) = ((k as f64 + 0.5) / 16.0 * std::f64::consts::TAU).sin_cos();
        // Corners of the rounded box lie farther out than an ellipse's.
        let r = 1.0 + 0.2 * (2.0 * u * v) * (2.0 * u * v);
        [0.86, 1.14].map(|g| {
            let (a, b) = (0.5 * g * r * u * width, 0.5 * g * r * v * length);
            [(a * cos + b * sin) as f32, (b * cos - a * sin) as f32]
        })
    })
}

/// How much of a closed edge an arc after arc runs along, whatever its sign: the cheap look at a template.
fn closed_edge(patch: &Patch, [x, y]: [f32; 2], rim: &[[[f32; 2]; 2]; 16]) -> f32 {
    const CONTRAST: [f32; 3] = [0.15, 0.08, 0.08];
    rim.chunks_exact(2)
        .map(|arc| {
            let mut sum = [0.0f32; 3];
            for [inner, outer] in arc {
                let (inner, outer) = (patch.at(x + inner[0], y + inner[1]), patch.at(x + outer[0], y + outer[1]));
                for c in 0..3 {
                    sum[c] += (outer[c] - inner[c]) / CONTRAST[c];
                }
            }
            let best = sum[0].abs().max(sum[1].abs()).max(sum[2].abs());
            best / (1.0 + best)
        })
        .sum()
}

/// The best, by `value`, that are not near a better one, which `near` takes second.
pub(super) fn best_apart<T>(
    mut all: Vec<T>,
    most: usize,
    value: impl Fn(&T) -> f64,
    near: impl Fn(&T, &T) -> bool,
) -> Vec<T> {
    all.sort_by(|a, b| value(b).total_cmp(&value(a)));
    let mut kept: Vec<T> = Vec::new();
    for one in all {
        if kept.len() == most {
            break;
        }
        if !kept.iter().any(|other| near(&one, other)) {
            kept.push(one);
        }
    }
    kept
}

fn best_shapes(all: Vec<Scored>, most: usize, near: impl Fn(&OutlineShape, &OutlineShape) -> bool) -> Vec<Scored> {
    best_apart(all, most, |one| f64::from(one.1), |one, other| near(&one.0, &other.0))
}

/// The best that are not near a better one (`apart` of the frame's unit, in any number of the shape).
fn best_different(all: Vec<Scored>, most: usize, apart: f64) -> Vec<Scored> {
    best_shapes(all, most, |s, k| {
        let d = [s.x - k.x, s.y - k.y, s.length - k.length, s.width - k.width, 0.4 * (s.turn - k.turn)];
        d.iter().all(|d| d.abs() < apart)
    })
}

/// The same, where sizes differ much: distances relative to the better one's size.
fn best_different_scaled(all: Vec<Scored>, most: usize) -> Vec<Scored> {
    best_shapes(all, most, |s, k| {
        let apart = (s.x - k.x).hypot(s.y - k.y) / k.length;
        let same_way = (s.turn - k.turn).cos() > 0.0;
        apart < 0.2 && (s.length / k.length).ln().abs() < 0.3 && (s.width / k.width).ln().abs() < 0.3 && same_way
    })
}

/// Climbs the score by ever smaller steps in each number of the shape.
pub fn polish(patch: &Patch, (mut shape, mut value): Scored, tip: bool) -> Scored {
    let size = 0.5 * (shape.length + shape.width);
    let mut step = 0.08;
    for _ in 0..3 {
        for _ in 0..2 {
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
