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

use candidate::{Candidate, Origin, fine, follow};
use patch::{Frame, Patch};
use picture::Picture;

/// Longest side of the picture that silhouettes are looked for on.
const SEARCH_PX: u32 = 384;
/// Longest side of the picture that a close-up is searched on.
const COARSE_PX: u32 = 112;

/// Every candidate, unsorted.
fn candidates(image: &DynamicImage) -> Vec<Candidate> {
    let picture = Picture::whole(image, SEARCH_PX);
    let ends: Vec<_> = silhouette::silhouettes(&picture).iter().flat_map(tips::tips).collect();
    let mut found = Vec::new();
    for tip in tips::strongest(ends, 24) {
        let frame =
            Frame { origin: picture.to_source(tip.apex), up: tip.out, unit_px: tip.width * f64::from(picture.step) };
        let patch = Patch::cut(image, frame, search::FINGER);
        for (shape, score) in search::on_finger(&patch, 2).into_iter().take(1) {
            found.extend(follow(image, frame, shape, Origin::Tip { fit: tip.fit, score }));
        }
    }
    let small = Picture::whole(image, COARSE_PX);
    let size = [f64::from(image.width()), f64::from(image.height())];
    let (patch, places) = search::anywhere(&small, size, 6);
    for (shape, _) in places {
        found.extend(follow(image, patch.frame, shape, Origin::Anywhere));
    }
    candidate::compare(&mut found);
    found
}

static JUDGE: std::sync::LazyLock<net::Net> =
    std::sync::LazyLock::new(|| net::Net::parse(include_str!("weights/judge.txt")).expect("weights are checked by a test"));

fn confidence(c: &Candidate) -> f64 {
    1.0 / (1.0 + f64::from(-JUDGE.answer(&c.figures)).exp())
}

pub struct Detected { pub outline: super::Outline, pub axis: super::Axis, pub confidence: f64 }

/// All, best first, none overlapping a better one
fn judged(image: &DynamicImage) -> Vec<Detected> {
    let mut all: Vec<(f64, Candidate)> = candidates(image).into_iter().map(|c| (confidence(&c), c)).collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<Detected> = Vec::new();
    for (confidence, c) in all {
        let clash = |k: &Detected| { let iou = k.outline.iou(&c.outline); let (a, b) = (k.outline.area_px2(), c.outline.area_px2()); iou * (a + b) / (1.0 + iou) > 0.25 * a.min(b) };
        if !kept.iter().any(clash) { kept.push(Detected { outline: c.outline, axis: c.axis, confidence }); }
    }
    kept
}
pub fn debug_detect(image: &DynamicImage) -> Vec<Detected> { judged(image) }
