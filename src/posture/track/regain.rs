//! Lost markers: where to look for them, and when to take them back.
//!
//! The lost ones are named together, by the same costs as in the survey, among the blobs that are no marker yet, the
//! markers seen being given; what another naming fills otherwise, about as well, is not taken.

use super::agree::LOOSE;
use super::target::Target;
use super::{Tracker, loose};
use crate::posture::marker::centre::{Scratch, centre};
use crate::posture::marker::looks::look::Look;
use crate::posture::marker::looks::siting::Siting;
use crate::posture::marker::sight::Loss;
use crate::posture::survey::find::{Area, Blob, Paint, distance};
use crate::posture::survey::naming::{MARGIN, MISSING, Point, Scene, colour_cost};
use crate::video::Frame;

/// A whole frame is searched at this interval at first, then at longer ones.
const FIRST_INTERVAL: u64 = 2;
const LONGEST_INTERVAL: u64 = 32;
/// ... once a marker has been absent for this long.
const WHOLE_AFTER: u64 = 5;
/// Wide searches every frame for this long, then every few.
const EVERY_FRAME: u64 = 12;
const SELDOM: u64 = 4;
/// How fast a marker's whereabouts widen, in radii a frame.
const DRIFT_RADII: f64 = 1.5;
/// What its last place says is worth this at most, and nothing after this many frames.
const MEMORY_COST: f64 = 6.0;
const MEMORY_FRAMES: f64 = 45.0;
/// Radius of a marker taken back over the one it had: with segments to tell by, and without any.
const RADIUS_RANGE: (f64, f64) = (0.84, 1.2);
const LONE_RADIUS_RANGE: (f64, f64) = (0.5, 2.0);
/// Blobs that stand out less are no markers.
const LEAST_CONTRAST: f64 = 0.25;
/// Names given are dropped if others fit better by this.
const DOUBT_MARGIN: f64 = 6.0;
/// Samples with this share of a marker's colour are counted to see whether something has come into view.
const COUNTED_SHARE: f64 = 0.5;

/// When the whole frame was searched, and what it showed.
#[derive(Debug, Default)]
pub(super) struct Search {
    last_whole: Option<u64>,
    interval: u64,
    /// For each marker the count of samples of its colour at the last search.
    counts: Vec<usize>,
    blobs: Vec<Blob>,
    points: Vec<Option<Point>>,
}

impl Tracker {
    /// Looks for the markers that have been absent for a while.
    pub(super) fn regain(&mut self, frame: &Frame<'_>) {
        // All gone at once: the camera moved, or the scene was cut.
        let none_seen = self.targets.iter().all(|target| target.fit.is_none());
        let is_lost = |target: &Target| {
            target.fit.is_none() && (none_seen || target.last.is_none() || target.absent >= super::SHORTLY)
        };
        let lost: Vec<usize> =
            (0..self.targets.len()).filter(|&marker| self.needed[marker] && is_lost(&self.targets[marker])).collect();
        if lost.is_empty() {
            self.lost.interval = FIRST_INTERVAL;
            return;
        }
        let whole = self.whole_is_due(frame, &lost);
        let mut areas: Vec<(Vec<usize>, Option<Area>)> = Vec::new();
        if whole {
            self.effort.whole_searches += 1;
            self.lost.last_whole = Some(frame.index);
            self.lost.interval = (self.lost.interval + self.lost.interval / 2 + 1).min(LONGEST_INTERVAL);
            areas.push((lost.clone(), None));
        } else {
            for &marker in &lost {
                let absent = self.targets[marker].absent;
                if absent > EVERY_FRAME && !(frame.index + marker as u64).is_multiple_of(SELDOM) {
                    continue;
                }
                if let Some(area) = self.whereabouts(marker) {
                    self.effort.wide_searches += 1;
                    areas.push((vec![marker], Some(area)));
                }
            }
        }
        if areas.is_empty() {
            return;
        }
        self.gather(frame, &areas, whole);
        self.name_lost(frame, &lost, whole);
        if whole && lost.iter().any(|&marker| self.targets[marker].fit.is_some()) {
            self.lost.interval = FIRST_INTERVAL;
        }
    }

    /// Whether the whole frame is to be searched: after some time, or as soon as more of a lost colour is in view.
    fn whole_is_due(&mut self, frame: &Frame<'_>, lost: &[usize]) -> bool {
        let none_seen = self.targets.iter().all(|target| target.fit.is_none());
        let waited = |target: &Target| target.last.is_none() || target.absent >= WHOLE_AFTER;
        let candidates: Vec<usize> =
            lost.iter().copied().filter(|&marker| none_seen || waited(&self.targets[marker])).collect();
        if candidates.is_empty() {
            return false;
        }
        self.lost.counts.resize(self.targets.len(), 0);
        let mut more = false;
        for &marker in &candidates {
            let pitch = 0.7 * self.typical_radius_px(marker);
            let count = self.paint(marker).count(frame, pitch, COUNTED_SHARE);
            let before = self.lost.counts[marker];
            more |= count as f64 > before as f64 + 2.0 + 3.0 * (before as f64).sqrt();
            self.lost.counts[marker] = count;
        }
        let since = self.lost.last_whole.map_or(u64::MAX, |last| frame.index - last);
        since >= self.lost.interval.max(FIRST_INTERVAL) || (more && since >= FIRST_INTERVAL)
    }

    /// Its colour as last seen, or as the marker file has it.
    fn paint(&self, marker: usize) -> Paint {
        match &self.targets[marker].look {
            Some(look) => look.paint(&self.paints[marker]),
            None => self.paints[marker],
        }
    }

    /// Its radius, or that of another marker for one never seen.
    fn typical_radius_px(&self, marker: usize) -> f64 {
        let radius = |target: &Target| target.look.as_ref().map(|look| look.radius_px);
        radius(&self.targets[marker])
            .or_else(|| self.targets.iter().find_map(radius))
            .unwrap_or(0.01 * self.size.0 as f64)
    }

    /// Where a lost marker can be: about a partner that is seen, else about where it was.
    fn whereabouts(&self, marker: usize) -> Option<Area> {
        let target = &self.targets[marker];
        let radius = self.typical_radius_px(marker);
        for rod in self.rods.iter().filter(|rod| rod.ends.contains(&marker)) {
            if let (Some(length), Some(fit)) = (rod.length_px, &self.targets[rod.other(marker)].fit) {
                return Some(Area::about(fit.centre.at_px, 1.2 * length + 4.0 * radius));
            }
        }
        target.last?;
        let reach = target.reach_px() + radius * (3.0 + DRIFT_RADII * target.absent.min(EVERY_FRAME) as f64);
        Some(Area::about(target.expected_px, reach))
    }

    /// The blobs that are no marker yet. In a whole frame also those of markers that are not needed but look alike.
    fn gather(&mut self, frame: &Frame<'_>, areas: &[(Vec<usize>, Option<Area>)], whole: bool) {
        self.lost.blobs.clear();
        for (markers, area) in areas {
            self.finder.load(frame, *area);
            let mut searched: Vec<Paint> = Vec::new();
            let helping = self.chain.links.iter().map(|link| link.marker).filter(|&m| whole && !self.needed[m]);
            for marker in markers.iter().copied().chain(helping) {
                let paint = self.paint(marker);
                if searched.iter().any(|other| other.is_like(&paint, 0.05)) {
                    continue;
                }
                searched.push(paint);
                self.finder.find(frame, &paint, &mut self.blobs);
                for blob in &self.blobs {
                    let taken = |target: &Target| {
                        target
                            .fit
                            .as_ref()
                            .is_some_and(|fit| distance(fit.centre.at_px, blob.at_px) < target.radius_px())
                    };
                    let known = |other: &Blob| distance(other.at_px, blob.at_px) < 0.6 * other.radius_px();
                    if blob.contrast >= LEAST_CONTRAST
                        && !blob.at_the_border
                        && !self.targets.iter().any(taken)
                        && !self.lost.blobs.iter().any(known)
                    {
                        self.lost.blobs.push(*blob);
                    }
                }
            }
        }
    }

    /// Names the lost markers among the blobs, and takes back those about which there is no doubt.
    fn name_lost(&mut self, frame: &Frame<'_>, lost: &[usize], whole: bool) {
        let count = self.targets.len();
        // Spots: the markers seen, by their own numbers, then the blobs.
        let mut points = std::mem::take(&mut self.lost.points);
        points.clear();
        points.extend(self.targets.iter().map(|target| {
            target.fit.as_ref().map(|fit| Point {
                frame: frame.index,
                at_px: fit.centre.at_px,
                radius_px: fit.centre.radius_px,
                contrast: 1.0,
                colour: fit.marker,
            })
        }));
        points.extend(self.lost.blobs.iter().map(|blob| Some(Point::new(frame.index, blob))));
        let choices: Vec<Vec<(usize, f64)>> = (self.chain.links.iter())
            .map(|link| {
                if points[link.marker].is_some() {
                    return vec![(link.marker, 0.0)];
                }
                (self.lost.blobs.iter().enumerate())
                    .filter_map(|(number, blob)| Some((count + number, self.choice(frame, link.marker, blob)?)))
                    .collect()
            })
            .collect();
        let missing: Vec<f64> = (self.chain.links.iter())
            .map(|link| if points[link.marker].is_some() { f64::INFINITY } else { MISSING })
            .collect();
        let lengths: Vec<Option<f64>> = (self.chain.links.iter())
            .map(|link| {
                let before = self.chain.links[link.before?].marker;
                let rod = self.rods.iter().find(|rod| rod.ends == [before, link.marker])?;
                rod.length_px.filter(|_| link.rigid)
            })
            .collect();
        let namings = self.scene(&points, &choices, &lengths, &missing).namings();
        let given = namings.first().map_or(0.0, |best| best.1);
        if let Some((best, cost)) = namings.first() {
            for (place, link) in self.chain.links.iter().enumerate() {
                let Some(spot) = best[place].filter(|_| lost.contains(&link.marker)) else { continue };
                let sure =
                    namings[1..].iter().all(|(other, price)| *price >= cost + MARGIN || other[place] == Some(spot));
                if !sure {
                    self.targets[link.marker].loss = Loss::Ambiguous;
                    continue;
                }
                let blob = self.lost.blobs[spot - count];
                let lone = self.lone[link.marker];
                let target = &mut self.targets[link.marker];
                take_back(frame, self.siting, &self.paints[link.marker], target, &blob, lone, &mut self.scratch);
                if lone && target.fit.is_none() {
                    target.fit = target.look.as_ref().and_then(|look| loose::fit(look, &blob));
                    target.jumped = true;
                }
            }
        }
        if whole {
            self.doubt(&points, &choices, &lengths, given);
        }
        self.lost.points = points;
    }

    /// Drops names that the frame contradicts: where naming all markers again fits by far better than the names given.
    fn doubt(&mut self, points: &[Option<Point>], choices: &[Vec<(usize, f64)>], lengths: &[Option<f64>], given: f64) {
        let free: Vec<Vec<(usize, f64)>> = (self.chain.links.iter().zip(choices))
            .map(|(link, choices)| {
                let alike =
                    (0..self.targets.len()).filter(|&other| points[other].is_some() && self.alike[link.marker][other]);
                let mut free: Vec<(usize, f64)> = alike.map(|other| (other, 0.0)).collect();
                free.extend(choices.iter().copied().filter(|choice| choice.0 >= self.targets.len()));
                // A marker that is seen could be another blob instead.
                if points[link.marker].is_some() {
                    let paint = self.paint(link.marker);
                    let blobs = self.targets.len()..points.len();
                    free.extend(blobs.filter_map(|spot| Some((spot, colour_cost(&paint, &points[spot]?)))));
                }
                free
            })
            .collect();
        let missing = vec![MISSING; free.len()];
        let namings = self.scene(points, &free, lengths, &missing).namings();
        let Some((best, cost)) = namings.first() else { return };
        if cost + DOUBT_MARGIN >= given {
            return;
        }
        for (link, spot) in self.chain.links.iter().zip(best) {
            let target = &mut self.targets[link.marker];
            if points[link.marker].is_some() && *spot != Some(link.marker) {
                target.drop(Loss::Ambiguous);
                target.last = None;
            }
        }
    }

    /// What markers are named in.
    fn scene<'a>(
        &'a self,
        points: &'a [Option<Point>],
        choices: &'a [Vec<(usize, f64)>],
        lengths_px: &'a [Option<f64>],
        missing: &'a [f64],
    ) -> Scene<'a> {
        let blots = Look::are_blots(self.targets.iter().filter_map(|target| target.look.as_ref()));
        Scene { chain: &self.chain, choices, points, lengths_px, missing, flexion: self.flexion, blots }
    }

    /// What a blob costs as a marker; none if it can't be it.
    fn choice(&self, frame: &Frame<'_>, marker: usize, blob: &Blob) -> Option<f64> {
        let paint = self.paint(marker);
        let point = Point::new(frame.index, blob);
        let target = &self.targets[marker];
        let mut cost = colour_cost(&paint, &point);
        if let Some(look) = &target.look {
            let factor = (blob.radius_px() / look.radius_px).ln().abs();
            if factor > LONE_RADIUS_RANGE.1.ln() + 0.1 {
                return None;
            }
            cost += 0.5 * (factor / 0.25).powi(2).min(4.0);
        }
        // Where all are gone at once, the last places say nothing.
        let cut = self.targets.iter().all(|target| target.fit.is_none());
        if let Some((_, seen)) = target.last.filter(|_| !cut) {
            let absent = (frame.index - seen) as f64;
            let scale = target.reach_px() + DRIFT_RADII * target.radius_px() * absent;
            let cap = MEMORY_COST * (1.0 - absent / MEMORY_FRAMES).max(0.0);
            cost += (0.5 * (distance(blob.at_px, target.expected_px) / scale).powi(2)).min(cap);
        }
        (cost < MISSING + LOOSE).then_some(cost)
    }
}

/// Fits a marker at a blob, with the looks that it had or, if it is the same one in another light, new ones.
fn take_back(
    frame: &Frame<'_>,
    siting: Siting,
    paint: &Paint,
    target: &mut Target,
    blob: &Blob,
    lone: bool,
    scratch: &mut Scratch,
) {
    let near = |at: [f64; 2]| distance(at, blob.at_px) <= blob.radius_px();
    let range = if lone { LONE_RADIUS_RANGE } else { RADIUS_RANGE };
    if let Some(look) = &target.look {
        match centre(frame, siting, look, blob.at_px, scratch) {
            Ok(fit) if near(fit.centre.at_px) => {
                target.fit = Some(fit);
                target.jumped = true;
                return;
            }
            Ok(_) => target.loss = Loss::NotFound,
            Err(loss) => target.loss = loss,
        }
    }
    let new = match &target.look {
        Some(Look { blot: Some(_), .. }) => Look::learn_blot(frame, siting, blob.at_px, blob.radius_px()),
        _ => Look::learn(frame, siting, blob.at_px, blob.radius_px(), scratch),
    };
    let Some(mut new) = new else { return };
    if let Some(old) = &target.look {
        let ratio = new.radius_px / old.radius_px;
        let alike = paint.seen_as(old.marker).is_like(&paint.seen_as(new.marker), super::ALIKE_RAD);
        if ratio < range.0 || ratio > range.1 || !alike {
            return;
        }
        // It may be a part that is seen again, the rest still hidden.
        new.keep_first(old);
    }
    if let Ok(fit) = centre(frame, siting, &new, blob.at_px, scratch)
        && near(fit.centre.at_px)
    {
        target.look = Some(new);
        target.fit = Some(fit);
        target.jumped = true;
    }
}
