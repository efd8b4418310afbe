//! Markers followed from frame to frame under their names.
//!
//! A survey and then frame after frame go in; for each frame and marker a centre or the reason of its loss comes out. A
//! marker is looked for where it should be by its motion; if it is not there, about that place; if it stays away, where
//! the segments that it belongs to allow it, and at last in the whole frame, at growing intervals. It is taken back
//! only where size, colour, the lengths of its segments and the order along the finger agree and nothing else fits
//! about as well; till then it is lost. Markers that can't be distinguished for a while are both lost.

mod agree;
mod covered;
mod loose;
mod regain;
mod target;

pub(crate) use loose::look as loose_look;

use agree::Rod;
use target::Target;

use super::layout::{Layout, MarkerShape};
use super::marker::centre::{Scratch, centre};
use super::marker::inflation::Inflation;
use super::marker::method::{Method, Search};
use super::marker::sight::{Loss, Sight};
use super::survey::{Start, Survey};
use crate::posture::marker::looks::siting::Siting;
use crate::posture::survey::find::{Area, Blob, Finder, Paint, distance};
use crate::posture::survey::naming::{Chain, lone};
use crate::video::{Frame, Info};

/// Colours whose directions in (Cb, Cr) differ by less than this may be taken for one another.
const ALIKE_RAD: f64 = 0.35;
/// A blob in a marker's neighbourhood has its radius within this factor.
const RADIUS_FACTOR: f64 = 1.4;
/// ... one on no segment, which may come nearer, within this one.
const LONE_RADIUS_FACTOR: f64 = 1.8;
/// A blob in a marker's neighbourhood stands out by this share of the colour that was seen last.
const LEAST_CONTRAST: f64 = 0.25;
/// Of two blobs that could be the marker, the nearer one must be nearer by this factor (and half a radius).
const NEARER: f64 = 2.0;
/// A marker absent for longer is looked for by its neighbours along the finger.
const SHORTLY: u64 = 2;
/// Every so many frames a marker that is seen is checked against the blob that is there, lest its fit drift away.
const CHECKED_EVERY: u64 = 12;
/// So many markers, and more than half of those seen, vanish together only where the scene is cut or the camera moved.
const GONE_AT_A_CUT: usize = 3;
/// A fit further from the blob than this share of the radius (and a pixel) has drifted.
const DRIFTED_RADII: f64 = 0.6;

/// How much looking it took.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Effort {
    /// Frames looked at.
    pub(crate) frames: u64,
    /// Frames that could not be decoded.
    pub(crate) undecoded: u64,
    /// Searches about the place where one marker was expected.
    pub(crate) near_searches: u64,
    /// Searches where lost markers can be.
    pub(crate) wide_searches: u64,
    pub(crate) whole_searches: u64,
    /// Samples looked at in all these, as a share of the luma samples of all frames.
    pub(crate) share_searched: f64,
}

/// Follows markers.
pub(crate) struct Tracker {
    chain: Chain,
    flexion: f64,
    needed: Vec<bool>,
    /// Whether two markers may be taken for one another.
    alike: Vec<Vec<bool>>,
    /// Markers on no segment.
    lone: Vec<bool>,
    paints: Vec<Paint>,
    size: (usize, usize),
    siting: Siting,
    /// For each marker where the survey saw it first.
    starts: Vec<Option<Start>>,
    targets: Vec<Target>,
    rods: Vec<Rod>,
    sights: Vec<Sight>,
    finder: Finder,
    blobs: Vec<Blob>,
    scratch: Scratch,
    inflation: Inflation,
    next_frame: u64,
    lost: regain::Search,
    effort: Effort,
}

impl Tracker {
    /// A tracker of the markers that the wanted joints need.
    pub(crate) fn new(layout: &Layout, survey: &Survey, info: &Info, method: Method) -> Self {
        let grey = info.grey;
        let paints: Vec<Paint> =
            layout.markers.iter().map(|marker| Paint::new(marker.colour, &info.matrix, grey)).collect();
        let alike = paints.iter().map(|a| paints.iter().map(|b| a.is_like(b, ALIKE_RAD)).collect()).collect();
        let needed = layout.needed();
        let rods = (layout.segments.iter().zip(&survey.lengths_px))
            .filter(|(segment, _)| segment.markers.iter().all(|&marker| needed[marker]))
            .map(|(segment, &length_px)| Rod { ends: segment.markers, length_px })
            .collect();
        Self {
            chain: Chain::new(layout),
            flexion: layout.flexion.sign(),
            alike,
            lone: lone(layout),
            paints,
            size: (info.format.width, info.format.height),
            siting: survey.siting,
            starts: survey.starts.clone(),
            targets: (survey.starts.iter())
                .map(|start| Target::new(start.as_ref().map(|start| start.look.clone())))
                .collect(),
            rods,
            sights: vec![Sight::Lost(Loss::NotFound); needed.len()],
            finder: Finder::default(),
            blobs: Vec::new(),
            scratch: Scratch::new(method),
            inflation: Inflation::new(survey.starts.len()),
            next_frame: 0,
            lost: regain::Search::default(),
            effort: Effort::default(),
            needed,
        }
    }

    /// What the next frame shows of each marker of the layout; those not needed are never looked for.
    pub(crate) fn step(&mut self, frame: &Frame<'_>) -> &[Sight] {
        self.next_frame = frame.index + 1;
        self.effort.frames += 1;
        for ((target, lone), factor) in self.targets.iter_mut().zip(&self.lone).zip(self.inflation.factors()) {
            if let Some(look) = target.look.as_mut().filter(|_| !lone) {
                look.inflation = factor;
            }
        }
        for marker in 0..self.targets.len() {
            if self.needed[marker] {
                self.expect(marker, frame.index);
                self.look_where_expected(frame, marker);
            }
        }
        for marker in 0..self.targets.len() {
            if (frame.index + marker as u64).is_multiple_of(CHECKED_EVERY) && self.targets[marker].fit.is_some() {
                self.check(frame, marker);
            }
        }
        agree::settle(&mut self.targets, &self.rods, &self.alike);
        for marker in 0..self.targets.len() {
            let target = &self.targets[marker];
            if self.needed[marker] && target.fit.is_none() && target.last.is_some() && target.absent < SHORTLY {
                self.look_about(frame, marker);
            }
        }
        agree::settle(&mut self.targets, &self.rods, &self.alike);
        self.doubt_a_cut();
        self.regain(frame);
        covered::doubt(&mut self.targets, &self.lone);
        agree::learn(&self.targets, &mut self.rods);
        // A thing by itself may be no disc: its trembling says nothing of the others'.
        let discs = self.targets.iter().zip(&self.lone);
        let fits: Vec<_> = discs.map(|(target, lone)| target.fit.as_ref().filter(|_| !lone)).collect();
        self.inflation.push(&fits);
        for marker in 0..self.targets.len() {
            let target = &mut self.targets[marker];
            target.keep(frame.index);
            self.sights[marker] = match &target.fit {
                Some(fit) => Sight::Seen(fit.centre),
                None => Sight::Lost(target.loss),
            };
        }
        &self.sights
    }

    /// A frame that could not be decoded: no marker is seen, motion goes on.
    pub(crate) fn skip(&mut self) -> &[Sight] {
        self.next_frame += 1;
        self.effort.undecoded += 1;
        self.sights.fill(Sight::Lost(Loss::Undecoded));
        &self.sights
    }

    /// What a marker was taken for; none if it was never seen.
    pub(crate) fn shape(&self, marker: usize) -> Option<MarkerShape> {
        let look = self.targets[marker].look.as_ref()?;
        Some(if look.blot.is_some() { MarkerShape::Blot } else { MarkerShape::Disc })
    }

    /// How much looking it took so far.
    pub(crate) fn effort(&self) -> Effort {
        let all = (self.size.0 * self.size.1) as f64 * self.effort.frames.max(1) as f64;
        Effort { share_searched: self.finder.samples as f64 / all, ..self.effort }
    }

    fn expect(&mut self, marker: usize, frame: u64) {
        let target = &mut self.targets[marker];
        target.loss = Loss::NotFound;
        if let Some(start) = self.starts[marker].as_ref().filter(|start| start.frame == frame) {
            // It may have been found before, by itself.
            if target.absent > 0 || target.last.is_none() {
                target.place(start.at_px, start.velocity_px, frame);
            }
        }
        target.expect(frame);
    }

    /// Fits the marker where it should be.
    fn look_where_expected(&mut self, frame: &Frame<'_>, marker: usize) {
        let target = &mut self.targets[marker];
        let (Some(look), Some(_)) = (&target.look, target.last) else { return };
        if target.absent > SHORTLY {
            return;
        }
        let mut near_px = target.expected_px;
        if self.scratch.method.search == Search::Whole {
            // All that a whole frame shows of its colour, and of that the nearest.
            let paint = look.paint(&self.paints[marker]);
            self.finder.load(frame, None);
            self.finder.find(frame, &paint, &mut self.blobs);
            let nearest =
                (self.blobs.iter()).min_by(|a, b| distance(a.at_px, near_px).total_cmp(&distance(b.at_px, near_px)));
            near_px =
                nearest.map(|blob| blob.at_px).filter(|at| distance(*at, near_px) < look.radius_px).unwrap_or(near_px);
        }
        match centre(frame, self.siting, look, near_px, &mut self.scratch) {
            Ok(fit) if distance(fit.centre.at_px, target.expected_px) <= target.reach_px() => target.fit = Some(fit),
            Ok(_) => target.loss = Loss::NotFound,
            Err(loss) => target.loss = loss,
        }
    }

    /// Where most markers vanish in one frame, the others may be taken for one another: all are to be named again.
    fn doubt_a_cut(&mut self) {
        let before = self.targets.iter().filter(|target| target.last.is_some() && target.absent == 0);
        let (seen, gone) =
            before.fold((0, 0), |(seen, gone), target| (seen + 1, gone + usize::from(target.fit.is_none())));
        if gone >= GONE_AT_A_CUT && 2 * gone > seen {
            self.targets.iter_mut().for_each(|target| target.drop(Loss::Ambiguous));
        }
    }

    /// Drops a fit beside which the marker's blob lies.
    fn check(&mut self, frame: &Frame<'_>, marker: usize) {
        let target = &self.targets[marker];
        let (Some(look), Some(fit)) = (&target.look, &target.fit) else { return };
        let (at, radius) = (fit.centre.at_px, target.radius_px());
        let paint = look.paint(&self.paints[marker]);
        self.finder.load(frame, Some(Area::about(at, 4.0 * radius + 4.0)));
        self.finder.find(frame, &paint, &mut self.blobs);
        let outstanding = self.blobs.iter().find(|blob| {
            let alike = (blob.radius_px() / radius).ln().abs() < RADIUS_FACTOR.ln();
            alike && !blob.at_the_border && distance(blob.at_px, at) < 2.0 * radius
        });
        if outstanding.is_some_and(|blob| distance(blob.at_px, at) > DRIFTED_RADII * radius + 1.0) {
            self.targets[marker].drop(Loss::NotFound);
        }
    }

    /// Looks for a blob about the place where the marker should be, and fits the marker there.
    fn look_about(&mut self, frame: &Frame<'_>, marker: usize) {
        let target = &self.targets[marker];
        let Some(look) = &target.look else { return };
        let (expected, reach, radius) =
            (target.expected_px, target.reach_px() + target.radius_px(), target.radius_px());
        let paint = look.paint(&self.paints[marker]);
        self.effort.near_searches += 1;
        self.finder.load(frame, Some(Area::about(expected, reach + 2.0 * radius)));
        self.finder.find(frame, &paint, &mut self.blobs);
        let mut nearest: Option<(f64, usize)> = None;
        let mut second = f64::INFINITY;
        for (index, blob) in self.blobs.iter().enumerate() {
            let off = distance(blob.at_px, expected);
            let factor = (blob.radius_px() / radius).ln().abs();
            if off > reach || blob.contrast < LEAST_CONTRAST {
                continue;
            }
            if blob.at_the_border {
                if off < 2.0 * radius + target.speed_px() {
                    // It goes out of the picture: followed there, but not seen.
                    let target = &mut self.targets[marker];
                    target.loss = Loss::AtTheBorder;
                    return;
                }
                continue;
            }
            let range = if self.lone[marker] { LONE_RADIUS_FACTOR } else { RADIUS_FACTOR };
            if factor > range.ln() || !self.suits(marker, blob.at_px) {
                continue;
            }
            if nearest.is_none_or(|(other, _)| off < other) {
                second = nearest.map_or(f64::INFINITY, |(other, _)| other);
                nearest = Some((off, index));
            } else {
                second = second.min(off);
            }
        }
        let Some((off, index)) = nearest else { return };
        if second < NEARER * off + 0.5 * radius {
            self.targets[marker].loss = Loss::Ambiguous;
            return;
        }
        let at = self.blobs[index].at_px;
        let target = &mut self.targets[marker];
        let Some(look) = &target.look else { return };
        match centre(frame, self.siting, look, at, &mut self.scratch) {
            Ok(fit) if distance(fit.centre.at_px, at) <= radius => target.fit = Some(fit),
            Ok(_) => {}
            Err(loss) => target.loss = loss,
        }
        if target.fit.is_none() && self.lone[marker] {
            target.fit = target.look.as_ref().and_then(|look| loose::fit(look, &self.blobs[index]));
        }
    }

    /// Whether a marker can be at a place as far as its segments and the other markers' places tell.
    fn suits(&self, marker: usize, at: [f64; 2]) -> bool {
        let place = |marker: usize| self.targets[marker].fit.as_ref().map(|fit| fit.centre.at_px);
        let rods_hold = self
            .rods
            .iter()
            .filter(|rod| rod.ends.contains(&marker))
            .all(|rod| place(rod.other(marker)).is_none_or(|end| rod.can_be(distance(at, end))));
        let radius = self.targets[marker].radius_px();
        rods_hold
            && (0..self.targets.len())
                .all(|other| other == marker || place(other).is_none_or(|end| distance(at, end) > radius))
    }
}

#[cfg(test)]
pub(super) mod scenes;
#[cfg(test)]
mod tests;
