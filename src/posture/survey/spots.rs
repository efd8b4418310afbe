//! Spots of the markers' colours followed from frame to frame, not yet named.

use super::super::layout::MarkerShape;
use super::super::marker::blot::Blot;
use super::super::marker::centre::{Scratch, centre};
use super::super::track::loose_look;
use crate::posture::marker::looks::look::Look;
use crate::posture::marker::looks::siting::{Siting, SitingEvidence};
use crate::posture::marker::sight::Centre;
use crate::posture::survey::find::{Area, Blob, Finder, Paint, distance};
use crate::posture::survey::naming::Point;
use crate::video::Frame;

/// A spot is lost for good after this many frames without it.
const PATIENCE: u64 = 8;
/// A thing in which no disc was found in so many frames is none.
const LOOSE_AFTER: usize = 3;
/// A disc leaves less unexplained, or is rounder (measured: discs of 8 to 11 px at most 0.014 and 1.03, blots of paint
/// 0.016 to 0.08 and 1.04 to 2).
const DISC_MISFIT: f64 = 0.02;
const DISC_ELONGATION: f64 = 1.1;
/// What is round but leaves more is ragged, unless too small to say so (assumed).
const RAGGED_MISFIT: f64 = 0.04;
pub(super) const SMALL_RADIUS_PX: f64 = 6.0;
/// The centres of a disc and of its outline are no further apart than so many of their standard errors (measured: discs
/// of phantoms, clean and hard, at most 1.6; round yellow paint, shaded and in strokes, up to 12. What a coarse codec
/// makes of discs of 5 px at crf 34 is as much as 3.6: small ones are not asked).
const APART_ERRORS: f64 = 2.0;
/// What moves less than this share of its radius from frame to frame is not blurred to another shape.
const STILL_RADII: f64 = 0.5;
/// Spots followed at once, at most.
const MOST: usize = 40;
/// What stands out less than this share of the best of its colour, or than this, is no marker.
const LEAST_OF_BEST: f64 = 0.3;
const LEAST_CONTRAST: f64 = 0.15;

/// A spot followed over frames.
#[derive(Debug, Clone)]
pub(super) struct Spot {
    /// Where it was, in the order of frames, frames without it left out.
    pub(super) points: Vec<Point>,
    /// Its look and the point at which it was learnt.
    pub(super) look: Option<(usize, Look)>,
    /// Its look as a blot, where it was taken for a disc.
    pub(super) as_blot: Option<Look>,
    /// Which paints found it.
    pub(super) paints: Vec<bool>,
    velocity_px: [f64; 2],
}

impl Spot {
    fn new(frame: u64, blob: &Blob, paints: Vec<bool>) -> Self {
        Self { points: vec![Point::new(frame, blob)], look: None, as_blot: None, paints, velocity_px: [0.0; 2] }
    }

    pub(super) fn last(&self) -> &Point {
        // A spot starts with a point and loses none.
        &self.points[self.points.len() - 1]
    }

    /// Where it was in a frame, if it was seen there.
    pub(super) fn at(&self, frame: u64) -> Option<&Point> {
        self.points.binary_search_by_key(&frame, |point| point.frame).ok().map(|index| &self.points[index])
    }

    fn is_followed(&self, frame: u64) -> bool {
        frame - self.last().frame <= PATIENCE
    }

    fn expected_px(&self, frame: u64) -> [f64; 2] {
        let ahead = ((frame - self.last().frame) as f64).min(3.0);
        [0, 1].map(|axis| self.last().at_px[axis] + ahead * self.velocity_px[axis])
    }
}

#[derive(Debug, Default)]
pub(super) struct Spots {
    pub(super) all: Vec<Spot>,
    finder: Finder,
    found: Vec<Blob>,
    scratch: Scratch,
    /// What markers are, where the marker file says.
    shape: Option<MarkerShape>,
    evidence: Option<SitingEvidence>,
}

/// A blob and which paints found it.
struct Candidate {
    blob: Blob,
    paints: Vec<bool>,
}

impl Spots {
    /// None yet, of markers of this shape.
    pub(super) fn new(shape: Option<MarkerShape>) -> Self {
        Self { shape, ..Self::default() }
    }

    /// Looks at a frame: in all of it, or about the spots that are followed.
    pub(super) fn look(&mut self, frame: &Frame<'_>, paints: &[Paint], whole: bool, loose: &[bool]) {
        let mut candidates: Vec<Candidate> = Vec::new();
        if whole {
            self.search(frame, None, paints, &vec![true; paints.len()], &mut candidates);
        } else {
            for index in 0..self.all.len() {
                let spot = &self.all[index];
                if spot.is_followed(frame.index) {
                    let speed = spot.velocity_px[0].hypot(spot.velocity_px[1]);
                    let reach = 4.0 * spot.last().radius_px + speed + 8.0;
                    let area = Area::about(spot.expected_px(frame.index), reach);
                    let paints_of = spot.paints.clone();
                    self.search(frame, Some(area), paints, &paints_of, &mut candidates);
                }
            }
        }
        let inside = |candidate: &Candidate| candidates.iter().any(|other| lies_in(&candidate.blob, &other.blob));
        let parts: Vec<bool> = candidates.iter().map(inside).collect();
        let mut parts = parts.into_iter();
        candidates.retain(|_| !parts.next().unwrap_or(false));
        self.link(frame, candidates, whole);
        self.learn(frame, loose);
    }

    fn search(
        &mut self,
        frame: &Frame<'_>,
        area: Option<Area>,
        paints: &[Paint],
        which: &[bool],
        candidates: &mut Vec<Candidate>,
    ) {
        self.finder.load(frame, area);
        for (number, paint) in paints.iter().enumerate().filter(|&(number, _)| which[number]) {
            self.finder.find(frame, paint, &mut self.found);
            let best = self.found.first().map_or(0.0, |blob| blob.contrast);
            let least = (LEAST_OF_BEST * best).max(LEAST_CONTRAST);
            for blob in self.found.iter().filter(|blob| blob.contrast >= least && !blob.at_the_border) {
                let known = candidates.iter_mut().find(|other| is_same(&other.blob, blob));
                if let Some(known) = known {
                    known.paints[number] = true;
                    if blob.contrast > known.blob.contrast {
                        known.blob = *blob;
                    }
                } else {
                    let mut paints = vec![false; paints.len()];
                    paints[number] = true;
                    candidates.push(Candidate { blob: *blob, paints });
                }
            }
        }
    }

    /// Gives each candidate to the spot that it continues, the nearest pairs first; the others start spots of their
    /// own.
    fn link(&mut self, frame: &Frame<'_>, mut candidates: Vec<Candidate>, whole: bool) {
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (number, spot) in self.all.iter().enumerate().filter(|(_, spot)| spot.is_followed(frame.index)) {
            let expected_px = spot.expected_px(frame.index);
            let radius = spot.last().radius_px;
            let speed = spot.velocity_px[0].hypot(spot.velocity_px[1]);
            // A spot seen once may have any velocity.
            let free = if spot.points.len() < 2 { 3.0 } else { 1.2 };
            let gap = ((frame.index - spot.last().frame) as f64).sqrt();
            let reach = free * radius * gap + 0.6 * speed + 3.0;
            for (index, candidate) in candidates.iter().enumerate() {
                let distance = distance(candidate.blob.at_px, expected_px);
                let growth = (candidate.blob.radius_px() / radius).ln().abs();
                let related = candidate.paints.iter().zip(&spot.paints).any(|(a, b)| *a && *b);
                if related && distance < reach && growth < 0.35 {
                    pairs.push((distance + 2.0 * radius * growth, number, index));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut taken = vec![false; candidates.len()];
        for (_, number, index) in pairs {
            let spot = &mut self.all[number];
            if taken[index] || spot.last().frame == frame.index {
                continue;
            }
            taken[index] = true;
            let (point, before) = (Point::new(frame.index, &candidates[index].blob), *spot.last());
            let frames = (frame.index - before.frame) as f64;
            for axis in 0..2 {
                spot.velocity_px[axis] = (point.at_px[axis] - before.at_px[axis]) / frames;
            }
            spot.points.push(point);
            for (mine, theirs) in spot.paints.iter_mut().zip(&candidates[index].paints) {
                *mine |= theirs;
            }
        }
        if !whole {
            return;
        }
        let mut followed = self.all.iter().filter(|spot| spot.is_followed(frame.index)).count();
        let mut taken = taken.into_iter();
        candidates.retain(|_| !taken.next().unwrap_or(false));
        for candidate in candidates {
            if followed < MOST {
                followed += 1;
                self.all.push(Spot::new(frame.index, &candidate.blob, candidate.paints));
            }
        }
    }

    /// Whether most spots of known look are no discs.
    pub(super) fn are_blots(&self) -> bool {
        Look::are_blots(self.all.iter().filter_map(|spot| Some(&spot.look.as_ref()?.1)))
    }

    /// The number of a new spot at a place of the first frame, of this one of so many paints.
    pub(super) fn start(&mut self, frame: &Frame<'_>, blob: &Blob, paint: usize, paints: usize) -> usize {
        let paints = (0..paints).map(|number| number == paint).collect();
        self.all.push(Spot::new(frame.index, blob, paints));
        self.all.len() - 1
    }

    /// What stands out most from its surroundings at a place, of all these paints.
    pub(super) fn outstanding(
        &mut self,
        frame: &Frame<'_>,
        at: [f64; 2],
        reach_px: f64,
        paints: &[Paint],
    ) -> Option<Blob> {
        self.finder.load(frame, Some(Area::about(at, 4.0 * reach_px)));
        let mut best: Option<Blob> = None;
        for paint in paints {
            self.finder.find(frame, paint, &mut self.found);
            for blob in &self.found {
                let off = distance(blob.at_px, at);
                if off < reach_px.min(1.2 * blob.radius_px() + 2.0)
                    && blob.contrast >= LEAST_CONTRAST
                    && best.is_none_or(|other| other.contrast < blob.contrast)
                {
                    best = Some(*blob);
                }
            }
        }
        best
    }

    /// Learns the looks of the spots that have none, and of those that have some where chroma lies.
    fn learn(&mut self, frame: &Frame<'_>, loose: &[bool]) {
        let siting = Siting::usual(frame);
        let evidence = self.evidence.get_or_insert_with(|| SitingEvidence::new(siting, frame.subsampling()));
        for spot in &mut self.all {
            let last = *spot.last();
            if last.frame != frame.index {
                continue;
            }
            if spot.look.is_none() {
                let patient = spot.points.len() >= LOOSE_AFTER;
                let is_loose = spot.paints.iter().zip(loose).any(|(found, loose)| *found && *loose);
                let mut disc = || Look::learn(frame, siting, last.at_px, last.radius_px, &mut self.scratch);
                let blot = || Look::learn_blot(frame, siting, last.at_px, last.radius_px);
                let look = match self.shape {
                    Some(MarkerShape::Disc) => disc(),
                    Some(MarkerShape::Blot) => blot(),
                    None => {
                        let (disc, blot) = (disc(), blot());
                        // What moves is longer by its blur.
                        let still = spot.velocity_px[0].hypot(spot.velocity_px[1]) < STILL_RADII * last.radius_px;
                        let looks = disc.as_ref().zip(blot.as_ref());
                        let apart = looks
                            .and_then(|(disc, blot)| Apart::of(frame, [disc, blot], last.at_px, &mut self.scratch));
                        let is_held = apart.is_some_and(|apart| apart.is_held);
                        let apart =
                            apart.filter(|_| disc.as_ref().is_some_and(|disc| disc.radius_px > SMALL_RADIUS_PX));
                        let agree = !is_held && apart.is_none_or(|apart| apart.errors <= APART_ERRORS);
                        let is_round = |disc: &Look| blot.as_ref().is_none_or(|blot| agree && is_disc(disc, blot));
                        match disc {
                            Some(disc) if is_round(&disc) || (patient && !still) => {
                                spot.as_blot = blot;
                                Some(Look { apart_px2: apart.map_or(0.0, |apart| apart.px2), ..disc })
                            }
                            _ => blot.filter(|_| patient),
                        }
                    }
                };
                let look = look.or_else(|| (is_loose && patient).then(|| loose_look(frame, &last)));
                spot.look = look.map(|look| (spot.points.len() - 1, look));
            }
            let Some((_, look)) = &spot.look else { continue };
            if self.shape.is_none() && look.blot.is_none() && spot.as_blot.is_none() {
                spot.as_blot = Look::learn_blot(frame, siting, last.at_px, last.radius_px);
            }
            if let Ok(fit) = centre(frame, siting, look, last.at_px, &mut self.scratch) {
                evidence.push(fit.chroma_shift_px);
            }
        }
    }

    /// Where chroma samples lie: as the spots tell, else as the header does, else where most encoders put them.
    pub(super) fn siting(&self, header: Option<Siting>) -> Siting {
        let evidence = self.evidence.as_ref();
        let measured = evidence.and_then(SitingEvidence::siting).or(header);
        measured.or(evidence.map(|evidence| evidence.assumed)).unwrap_or(Siting { dx_px: 0.0, dy_px: 0.0 })
    }
}

/// How far the centre of what is taken for a disc is from that of its outline.
#[derive(Debug, Clone, Copy)]
struct Apart {
    /// In standard errors of both.
    errors: f64,
    /// The variance of a coordinate that it shows beyond these, pixels squared.
    px2: f64,
    /// The disc's is held near where its colour lies.
    is_held: bool,
}

impl Apart {
    /// Wherever chroma lies, the nearest; none where either has no centre. Shading, strokes and grain within paint, of
    /// which no disc's model knows, pull the one and not the other.
    fn of(frame: &Frame<'_>, looks: [&Look; 2], at_px: [f64; 2], scratch: &mut Scratch) -> Option<Self> {
        let apart = |siting: Siting| {
            let [disc, outline] = looks.map(|look| centre(frame, siting, look, at_px, scratch).ok());
            let is_held = disc.as_ref()?.is_held;
            let [disc, outline] = [disc?.centre, outline?.centre];
            let variance = |one: &Centre| 0.5 * (one.covariance_px2[0] + one.covariance_px2[2]);
            let (both, off) = (variance(&disc) + variance(&outline), distance(disc.at_px, outline.at_px));
            Some(Self { errors: off / both.sqrt(), px2: (0.5 * off * off - both).max(0.0), is_held })
        };
        Siting::likely(frame).into_iter().filter_map(apart).min_by(|a, b| a.errors.total_cmp(&b.errors))
    }
}

/// Whether what both looks were learnt of is a disc.
fn is_disc(disc: &Look, blot: &Look) -> bool {
    let elongation = blot.blot.as_ref().map_or(1.0, Blot::elongation);
    let ragged = disc.misfit > RAGGED_MISFIT && disc.radius_px > SMALL_RADIUS_PX;
    disc.misfit <= DISC_MISFIT || (elongation <= DISC_ELONGATION && !ragged)
}

/// Whether a blob is only a part of a larger one that stands out more.
fn lies_in(part: &Blob, whole: &Blob) -> bool {
    let distance = distance(part.at_px, whole.at_px);
    part.radius_px() < whole.radius_px() && distance < whole.radius_px() && part.contrast < 0.8 * whole.contrast
}

fn is_same(a: &Blob, b: &Blob) -> bool {
    let distance = distance(a.at_px, b.at_px);
    let growth = (a.radius_px() / b.radius_px()).ln().abs();
    distance < 0.6 * a.radius_px().min(b.radius_px()) && growth < 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::posture::stage::{SKIN, Stage};

    /// As bright as skin is.
    const YELLOW: [u8; 3] = [0xd8, 0xb0, 0x40];

    /// How far a disc's centre and its outline's are apart, of a mark of paint that gets darker downward by so many
    /// levels a pixel; and how far off each is.
    fn looked_at(at: [f64; 2], shade: f64) -> (Apart, [f64; 2]) {
        let mut stage = Stage::new(120, 100, SKIN);
        stage.disc(at, 10.0, YELLOW);
        let mut picture = stage.picture(3);
        for (k, luma) in picture.planes[0].iter_mut().enumerate() {
            let place = [(k % 120) as f64, (k / 120) as f64];
            let inside = (10.5 - distance(place, at)).clamp(0.0, 1.0);
            *luma = (f64::from(*luma) + inside * shade * (at[1] - place[1])).round() as u8;
        }
        let (frame, mut scratch) = (picture.frame(0, 0.0), Scratch::default());
        let siting = Siting { dx_px: 0.5, dy_px: 0.5 };
        let disc = Look::learn(&frame, siting, at, 10.0, &mut scratch).expect("a disc");
        let outline = Look::learn_blot(&frame, siting, at, 10.0).expect("an outline");
        let looks = [&disc, &outline];
        let off = looks.map(|look| {
            let centre = centre(&frame, siting, look, at, &mut scratch).expect("a centre").centre;
            distance(centre.at_px, at)
        });
        (Apart::of(&frame, looks, at, &mut scratch).expect("two centres"), off)
    }

    #[test]
    fn round_paint_that_is_shaded_is_no_disc() {
        for at in [[60.2, 49.7], [60.5, 49.5], [60.0, 50.0], [59.8, 50.3]] {
            let (apart, [disc, outline]) = looked_at(at, 0.0);
            assert!(apart.errors < 1.0 && apart.px2 == 0.0, "{apart:?}");
            assert!(disc < 0.1 && outline < 0.1, "{disc} {outline}");
            let (apart, [disc, outline]) = looked_at(at, 2.5);
            assert!(apart.errors > APART_ERRORS && apart.px2 > 0.01, "{apart:?}");
            assert!(disc > 0.2 && outline < 0.15, "{disc} {outline}");
        }
    }
}
