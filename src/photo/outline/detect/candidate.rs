//! One place followed to its end: template, refined outline, and what speaks for it.

use std::sync::LazyLock;

use geo::{BoundingRect, Intersects, Rect};

use super::evidence::score;
use super::net::Net;
use super::patch::{Frame, Patch};
use super::picture::{Levels, RED, TONE, YELLOW};
use super::refine::{Band, Path, RAYS, SIDE, fitted};
use super::search::NAIL;
use super::shape::{OutlineShape, TAPER};
use crate::median::ends;
use crate::photo::outline::{Axis, Outline};

/// Three judges, each trained without a third of the scenes.
static JUDGES: LazyLock<[Net; 3]> = LazyLock::new(|| {
    [include_str!("weights/judge-0.txt"), include_str!("weights/judge-1.txt"), include_str!("weights/judge-2.txt")]
        .map(|text| Net::parse(text).expect("weights are checked by a test"))
});

/// Number of features of a candidate.
pub const FEATURES: usize = 31;

/// What the confidence of a candidate is made from.
#[derive(Debug, Clone, Copy)]
pub struct Features {
    /// The scorer's answer for the fitted template.
    score: f32,
    /// How much better that is than upside down.
    over_flipped: f32,
    /// The scorer's answer for the template before fitting.
    template_score: f32,
    /// Mean trust in the border's quarters: first, the worse and the better side, third.
    arc_trust: [f32; 4],
    /// The least mean trust over six neighbouring rays.
    lowest_trust: f32,
    /// Standard deviation of the border's offsets from the template, first and second pass.
    moved: f32,
    moved_again: f32,
    /// Mean offset of the first pass.
    grown: f32,
    log_aspect: f32,
    log_length_px: f32,
    /// 1 for a picture without colour.
    grey: f32,
    /// 1 for a candidate from a finger's tip; how well the tip fits, and the template's score there.
    tip: f32,
    tip_fit: f32,
    tip_score: f32,
    /// How far the outline is turned from the template, radians.
    turned: f32,
    /// Colour channels, see [`surroundings`].
    skin: [f32; 3],
    nail_less_skin: [f32; 3],
    far_less_skin: [f32; 3],
    /// How uneven the skin's tone is.
    spread: f32,
    /// How many candidates agree, from 0 towards 1; see [`compare`].
    agreement: f32,
    /// How much better the best contradicting candidate scores.
    rival_lead: f32,
    /// Overlap with the outline found from a displaced template.
    again_iou: f32,
}

impl Features {
    /// In the order of the committed weights.
    pub fn to_array(self) -> [f32; FEATURES] {
        let [first, worse, better, third] = self.arc_trust;
        let [skin, nail, far] =
            [self.skin, self.nail_less_skin, self.far_less_skin].map(|c| [c[TONE], c[RED], c[YELLOW]]);
        [
            self.score,
            self.over_flipped,
            self.template_score,
            first,
            worse,
            better,
            third,
            self.lowest_trust,
            self.moved,
            self.moved_again,
            self.grown,
            self.log_aspect,
            self.log_length_px,
            self.grey,
            self.tip,
            self.tip_fit,
            self.tip_score,
            self.turned,
            skin[0],
            skin[1],
            skin[2],
            nail[0],
            nail[1],
            nail[2],
            far[0],
            far[1],
            far[2],
            self.spread,
            self.agreement,
            self.rival_lead,
            self.again_iou,
        ]
    }
}

/// A nail that may be one.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Its outline.
    pub outline: Outline,
    /// From its proximal to its distal end.
    pub axis: Axis,
    /// What the confidence is made from.
    pub features: Features,
    nail: Frame,
    fitted: OutlineShape,
    /// Other leads that mean the same.
    support: f32,
    /// A bright reflection lies along its border, which may be the reflection's.
    mirrored: bool,
    /// Best score of a lead that contradicts it.
    rival: f32,
}

impl Candidate {
    /// The chance that it is right: what the most doubtful judge says.
    pub(super) fn confidence(&self) -> f64 {
        let features = self.features.to_array();
        let lowest = JUDGES.iter().map(|judge| judge.answer(&features)).fold(f32::INFINITY, f32::min);
        let sure = 1.0 / (1.0 + f64::from(-lowest).exp());
        if self.mirrored { 0.5 * sure } else { sure }
    }

    /// Is it so good that what contradicts it need not be looked at?
    fn settled(&self) -> bool {
        self.features.score > 0.8 && self.features.lowest_trust > 0.35
    }
}

/// Where a candidate comes from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Origin {
    /// A finger's end of this fit; the template's score in its frame.
    Tip { fit: f64, score: f32 },
    /// The search over a close-up.
    Anywhere,
}

/// How often the template is fitted to the path around it.
const ROUNDS: usize = 2;
/// Places that the second path may move.
const AGAIN: usize = 8;

/// A template in its own nail's frame, before it is followed.
#[derive(Debug, Clone, Copy)]
pub struct Lead {
    /// The nail's frame: origin its centre, up its axis, unit its length.
    pub(super) nail: Frame,
    pub(super) template: OutlineShape,
    /// Where it comes from.
    pub(super) origin: Origin,
    /// The template's score.
    pub(super) score: f32,
}

impl Lead {
    /// Is it the same nail at the same place, roughly?
    fn like(&self, nail: &Frame, shape: &OutlineShape) -> bool {
        let c = nail.source_to_own(self.nail.origin);
        let size = self.nail.unit_px / nail.unit_px;
        let turn = self.nail.up[0] * nail.up[0] + self.nail.up[1] * nail.up[1];
        (c[0] - shape.x).hypot(c[1] - shape.y) < 0.12
            && (size / shape.length).ln().abs() < 0.16
            && (size * self.template.width / shape.width).ln().abs() < 0.16
            && turn > 0.8
    }
}

/// Follows the leads from the best score down, `most` of them.
///
/// A lead that meets what was found already adds to its support instead, and one that contradicts what is settled is
/// not followed.
pub fn follow_all(levels: &Levels, mut leads: Vec<Lead>, most: usize) -> Vec<Candidate> {
    leads.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut found: Vec<Candidate> = Vec::new();
    for lead in leads {
        if let Some(same) = found.iter_mut().find(|c| lead.like(&c.nail, &c.fitted)) {
            same.support += 1.0;
            continue;
        }
        let over = |c: &&mut Candidate| c.fitted.holds(c.nail.source_to_own(lead.nail.origin));
        if let Some(other) = found.iter_mut().filter(|c| c.settled()).find(over) {
            other.rival = other.rival.max(lead.score);
        } else if found.len() < most {
            found.extend(follow(levels, &lead));
        }
    }
    compare(&mut found);
    found
}

/// Refines a lead.
fn follow(levels: &Levels, lead: &Lead) -> Option<Candidate> {
    let Lead { nail, template, origin, .. } = *lead;
    if nail.unit_px.is_nan() || nail.unit_px <= 8.0 {
        return None;
    }
    let mut shape = template;
    let mut band = Band::around(levels, &nail, &shape);
    let mut first = band.path(SIDE, 2);
    for _ in 0..ROUNDS {
        shape = fitted(&shape, &band, &first);
        band = Band::around(levels, &nail, &shape);
        first = band.path(SIDE, 2);
    }
    let half = 0.25 * (shape.length + shape.width);
    let second = Band::of(levels, &nail, normals(&first.points), half).path(AGAIN, 1);
    let (turn, fitted) = box_of(&second.points, shape.turn);
    let axis = {
        let tip = nail.to_source(fitted.point(0.0, 1.0));
        let root = nail.to_source(fitted.point(0.0, -1.0));
        Axis::through(root, tip)?
    };
    let corners: Vec<[f64; 2]> = second.points.iter().map(|p| nail.to_source(*p)).collect();
    let outline = Outline::new(&corners).ok()?;
    let patch = Patch::cut(levels, nail, NAIL);
    let mut features = features(&patch, &shape, &fitted, &first, &second, origin, nail.unit_px, turn);
    features.again_iou = again(levels, &nail, &fitted, &outline);
    Some(Candidate {
        outline,
        axis,
        features,
        nail,
        fitted,
        mirrored: mirrored(&patch, &fitted, &second.points),
        support: 0.0,
        rival: -0.2,
    })
}

/// Does anything along the border's sides, just outside or just inside, shine far above the nail's own tone? A streak
/// of reflected light has an edge on either side, and each may pass for the nail's.
fn mirrored(patch: &Patch, shape: &OutlineShape, border: &[[f64; 2]]) -> bool {
    /// ln of the ratio; skin is never that much lighter than the nail in it.
    const SHINE: f32 = 0.45;
    /// Distances looked at, in widths: a streak may be a twentieth of the nail wide and must not slip through.
    const OUTWARDS: [f64; 6] = [-0.06, -0.03, 0.02, 0.05, 0.08, 0.12];
    let tone = |[x, y]: [f64; 2]| patch.at(x as f32, y as f32)[TONE];
    let rows = [-0.6, -0.4, -0.2, 0.0, 0.2, 0.4, 0.6];
    let mut inside: Vec<f32> = rows.iter().flat_map(|&v| [-0.4, 0.0, 0.4].map(|u| tone(shape.point(u, v)))).collect();
    inside.sort_by(f32::total_cmp);
    // The distal end is left out: the free edge is white by right.
    let sides = normals(border).into_iter().filter(|(_, normal)| normal[0].abs() > 0.6);
    let along = sides.flat_map(|([x, y], [nx, ny])| {
        OUTWARDS.map(|out| tone([x + out * shape.width * nx, y + out * shape.width * ny]))
    });
    along.fold(f32::NEG_INFINITY, f32::max) > inside[inside.len() / 2] + SHINE
}

/// Overlap (IoU) of the outline with the one found from a template that is a little too large and displaced.
fn again(levels: &Levels, nail: &Frame, fit: &OutlineShape, outline: &Outline) -> f32 {
    let mut shape = OutlineShape {
        y: fit.y - 0.05 * fit.length,
        length: 1.1 * fit.length,
        width: 1.12 * fit.width,
        turn: fit.turn + 0.08,
        ..*fit
    };
    let mut points = Vec::new();
    for _ in 0..2 {
        let band = Band::around(levels, nail, &shape);
        let path = band.path(SIDE, 2);
        shape = fitted(&shape, &band, &path);
        points = path.points;
    }
    let corners: Vec<[f64; 2]> = points.iter().map(|p| nail.to_source(*p)).collect();
    Outline::new(&corners).map_or(0.0, |other| outline.iou(&other) as f32)
}

/// The frame of a nail itself: origin its centre, up its axis, unit its length; and the template there.
pub fn own_frame(frame: Frame, shape: &OutlineShape) -> (Frame, OutlineShape) {
    let (sin, cos) = shape.turn.sin_cos();
    let [ux, uy] = frame.up;
    let up = [ux * cos - uy * sin, ux * sin + uy * cos];
    let own = Frame { origin: frame.to_source([shape.x, shape.y]), up, unit_px: shape.length * frame.unit_px };
    (
        own,
        OutlineShape { x: 0.0, y: 0.0, length: 1.0, width: shape.width / shape.length, turn: 0.0, taper: shape.taper },
    )
}

/// Points with outward normals of a closed path that runs counter-clockwise in a frame with y up.
fn normals(points: &[[f64; 2]]) -> Vec<([f64; 2], [f64; 2])> {
    let n = points.len();
    (0..n)
        .map(|k| {
            let (a, b) = (points[(k + n - 2) % n], points[(k + 2) % n]);
            let (tx, ty) = (b[0] - a[0], b[1] - a[1]);
            let d = tx.hypot(ty).max(1e-9);
            (points[k], [ty / d, -tx / d])
        })
        .collect()
}

/// The axis along which the outline's middle line runs, started from `turn`, and the template of its box.
fn box_of(points: &[[f64; 2]], mut turn: f64) -> (f64, OutlineShape) {
    let turned = |turn: f64| -> Vec<[f64; 2]> {
        let (sin, cos) = f64::sin_cos(turn);
        points.iter().map(|p| [p[0] * cos - p[1] * sin, p[0] * sin + p[1] * cos]).collect()
    };
    for _ in 0..3 {
        let q = turned(turn);
        let [low, high] = span(&q, 1);
        let (mut sv, mut sm, mut svv, mut svm, mut n) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for i in 0..15 {
            let v = low + (high - low) * (0.15 + 0.7 * f64::from(i) / 14.0);
            let crossings: Vec<f64> = (0..q.len())
                .filter_map(|k| {
                    let (a, b) = (q[k], q[(k + 1) % q.len()]);
                    ((a[1] > v) != (b[1] > v)).then(|| a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
                })
                .collect();
            if crossings.len() == 2 {
                let m = 0.5 * (crossings[0] + crossings[1]);
                sv += v;
                sm += m;
                svv += v * v;
                svm += v * m;
                n += 1.0;
            }
        }
        let bend = (svm - sv * sm / n) / (svv - sv * sv / n);
        if bend.is_finite() {
            turn += (0.7 * bend.atan()).clamp(-0.1, 0.1);
        }
    }
    let q = turned(turn);
    let [left, right] = span(&q, 0);
    let [low, high] = span(&q, 1);
    let (sin, cos) = turn.sin_cos();
    let (x, y) = ((left + right) / 2.0, (low + high) / 2.0);
    let shape = OutlineShape {
        x: x * cos + y * sin,
        y: -x * sin + y * cos,
        length: high - low,
        width: right - left,
        turn,
        taper: TAPER,
    };
    (turn, shape)
}

fn span(points: &[[f64; 2]], axis: usize) -> [f64; 2] {
    ends(points.iter().map(|point| point[axis]))
}

#[allow(clippy::too_many_arguments)]
fn features(
    patch: &Patch,
    template: &OutlineShape,
    fitted: &OutlineShape,
    first: &Path,
    second: &Path,
    origin: Origin,
    length_px: f64,
    turn: f64,
) -> Features {
    let (fit, tip_score, tip) = match origin {
        Origin::Tip { fit, score } => (fit as f32, score, 1.0),
        Origin::Anywhere => (0.0, 0.0, 0.0),
    };
    let chance = |t: &f32| 1.0 / (1.0 + (-t).exp());
    let arc = |from: usize, to: usize| -> f32 {
        (from..to).map(|k| chance(&second.trust[k % RAYS])).sum::<f32>() / (to - from) as f32
    };
    let arcs = [arc(8, 24), arc(24, 40), arc(40, 56), arc(56, 72)];
    let lowest = (0..RAYS / 6).map(|i| arc(6 * i, 6 * i + 6)).fold(f32::INFINITY, f32::min);
    let rms = |offset: &[f64]| {
        let mean = offset.iter().sum::<f64>() / offset.len() as f64;
        ((offset.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / offset.len() as f64).sqrt() as f32, mean as f32)
    };
    let (moved, grown) = rms(&first.offset);
    let (moved_again, _) = rms(&second.offset);
    let flipped = OutlineShape { turn: fitted.turn + std::f64::consts::PI, ..*fitted };
    let (around, spread) = surroundings(patch, fitted);
    let own = score(patch, fitted, false);
    let [skin, nail_less_skin, far_less_skin] = around;
    Features {
        score: own,
        over_flipped: own - score(patch, &flipped, false),
        template_score: score(patch, template, false),
        arc_trust: [arcs[0], arcs[1].min(arcs[3]), arcs[1].max(arcs[3]), arcs[2]],
        lowest_trust: lowest,
        moved,
        moved_again,
        grown,
        log_aspect: (fitted.length / fitted.width).ln() as f32,
        log_length_px: length_px.ln() as f32,
        grey: if patch.colour { 0.0 } else { 1.0 },
        tip,
        tip_fit: fit,
        tip_score,
        turned: (turn - template.turn).abs() as f32,
        skin,
        nail_less_skin,
        far_less_skin,
        spread,
        agreement: 0.0,
        rival_lead: 0.0,
        again_iou: 0.0,
    }
}

/// Colours of the skin around (on the sides and below), of the nail less the skin, of the far surroundings less the
/// skin; and how uneven the skin's tone is.
fn surroundings(patch: &Patch, shape: &OutlineShape) -> ([[f32; 3]; 3], f32) {
    let mean = |places: &[(f64, f64)]| {
        let (mut sum, mut square) = ([0.0f32; 3], 0.0f32);
        for &(u, v) in places {
            let [x, y] = shape.point(u, v);
            let cell = patch.at(x as f32, y as f32);
            for c in 0..3 {
                sum[c] += cell[c] / places.len() as f32;
            }
            square += cell[TONE] * cell[TONE] / places.len() as f32;
        }
        (sum, (square - sum[TONE] * sum[TONE]).max(0.0).sqrt())
    };
    let grid = |us: &[f64], vs: &[f64]| -> Vec<(f64, f64)> {
        us.iter().flat_map(|&u| vs.iter().map(move |&v| (u, v))).collect()
    };
    let mut near = grid(&[-1.25, 1.25], &[-0.6, -0.3, 0.0, 0.3]);
    near.extend(grid(&[-0.5, 0.0, 0.5], &[-1.2, -1.35]));
    let (skin, spread) = mean(&near);
    let (nail, _) = mean(&grid(&[-0.5, -0.25, 0.0, 0.25, 0.5], &[-0.6, -0.3, 0.0, 0.3, 0.6]));
    let mut far = grid(&[-1.9, 1.9], &[-0.3, 0.3, 0.9, 1.4]);
    far.extend(grid(&[-0.6, 0.0, 0.6], &[1.6]));
    let (far, _) = mean(&far);
    let less = |a: [f32; 3]| [0, 1, 2].map(|c| (a[c] - skin[c]).clamp(-1.0, 1.0));
    ([skin, less(nail), less(far)], spread)
}

/// The part of the smaller of two outlines that the other covers.
pub(super) fn shared(a: &Outline, b: &Outline) -> f64 {
    let iou = a.iou(b);
    let (a, b) = (a.area_px2(), b.area_px2());
    iou * (a + b) / (1.0 + iou) / a.min(b)
}

/// Fills in what the candidates say of each other: how many agree, and the best that contradicts.
pub(super) fn compare(all: &mut [Candidate]) {
    let boxes: Vec<Rect<f64>> = all.iter().filter_map(|c| c.outline.polygon().bounding_rect()).collect();
    let mut agree: Vec<f32> = all.iter().map(|c| c.support).collect();
    let mut rival: Vec<f32> = all.iter().map(|c| c.rival).collect();
    for i in 0..all.len() {
        for j in 0..i {
            if !boxes[i].intersects(&boxes[j]) {
                continue;
            }
            let iou = all[i].outline.iou(&all[j].outline);
            if iou > 0.8 {
                agree[i] += 1.0;
                agree[j] += 1.0;
            } else if shared(&all[i].outline, &all[j].outline) > 0.3 {
                rival[i] = rival[i].max(all[j].features.score);
                rival[j] = rival[j].max(all[i].features.score);
            }
        }
    }
    for ((c, agree), rival) in all.iter_mut().zip(agree).zip(rival) {
        c.features.agreement = agree / (2.0 + agree);
        c.features.rival_lead = rival - c.features.score;
    }
}
