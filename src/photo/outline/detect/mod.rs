//! Finds the outlines of nails in photographs that nobody has annotated.
#![allow(missing_docs, unreachable_pub, dead_code)]
mod candidate;
mod evidence;
mod net;
mod patch;
mod picture;
mod refine;
mod search;
mod shape;
mod silhouette;
mod tips;
#[cfg(test)]
mod training;
#[cfg(test)]
mod evaluation;

use image::DynamicImage;

use candidate::{Candidate, Lead, Origin, follow_all, own_frame};
use patch::{Frame, Patch};
use picture::Levels;

/// Longest side of the working picture.
const WORKING_PX: u32 = 1100;
/// Longest side of the picture that silhouettes are looked for on.
const SEARCH_PX: usize = 560;
/// Ends of fingers that are looked at.
const ENDS: usize = 40;
/// Most leads that are followed.
const FOLLOWED: usize = 16;
/// Lowest score in a coarse look that is looked at again.
const HOPE: f32 = 0.2;

/// Finger ends: frames of a finger's width with their fit.
fn ends(levels: &Levels, most: usize) -> Vec<(Frame, f64)> {
    let picture = levels.within(SEARCH_PX);
    let found = silhouette::silhouettes(picture).iter().flat_map(tips::tips).collect();
    tips::strongest(found, most)
        .into_iter()
        .map(|t| (Frame { origin: picture.to_source(t.apex), up: t.out, unit_px: t.width * picture.step }, t.fit))
        .collect()
}

/// Every template worth refining.
fn leads(levels: &Levels) -> Vec<Lead> {
    let mut leads = Vec::new();
    for (frame, fit) in ends(levels, ENDS) {
        let patch = Patch::cut(levels, frame, search::FINGER);
        let best = search::on_finger(&patch, 2).into_iter().filter(|s| s.1 > HOPE).map(|s| search::polish(&patch, s, true));
        if let Some((shape, score)) = best.max_by(|a, b| a.1.total_cmp(&b.1)) {
            let (nail, template) = own_frame(frame, &shape);
            leads.push(Lead { nail, template, origin: Origin::Tip { fit, score }, score });
        }
    }
    let (patch, places) = search::anywhere(levels, 5);
    for (shape, _) in places.into_iter().filter(|s| s.1 > HOPE) {
        let (nail, template) = own_frame(patch.frame, &shape);
        let patch = Patch::cut(levels, nail, search::NAIL);
        let first = evidence::score(&patch, &template, false);
        let (shape, score) = search::polish(&patch, (template, first), false);
        let (nail, template) = own_frame(nail, &shape);
        leads.push(Lead { nail, template, origin: Origin::Anywhere, score });
    }
    leads
}

/// Every candidate, unsorted.
fn candidates(levels: &Levels) -> Vec<Candidate> {
    follow_all(levels, leads(levels), FOLLOWED)
}

static JUDGE: std::sync::LazyLock<net::Net> =
    std::sync::LazyLock::new(|| net::Net::parse(include_str!("weights/judge.txt")).expect("weights are checked by a test"));

fn confidence(c: &Candidate) -> f64 {
    1.0 / (1.0 + f64::from(-JUDGE.answer(&c.figures)).exp())
}

pub struct Detected { pub outline: super::Outline, pub axis: super::Axis, pub confidence: f64 }

/// All, best first, none overlapping a better one
fn judged(image: &DynamicImage) -> Vec<Detected> {
    let mut all: Vec<(f64, Candidate)> = candidates(&Levels::of(image, WORKING_PX)).into_iter().map(|c| (confidence(&c), c)).collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<Detected> = Vec::new();
    for (confidence, c) in all {
        let clash = |k: &Detected| { let iou = k.outline.iou(&c.outline); let (a, b) = (k.outline.area_px2(), c.outline.area_px2()); iou * (a + b) / (1.0 + iou) > 0.25 * a.min(b) };
        if !kept.iter().any(clash) { kept.push(Detected { outline: c.outline, axis: c.axis, confidence }); }
    }
    kept
}
pub fn debug_detect(image: &DynamicImage) -> Vec<Detected> { judged(image) }
