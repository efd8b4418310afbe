//! Which naming the frames looked at speak for, and where they leave a doubt.

use super::{LEAST_FRAMES, Surveyor};
use crate::posture::layout::Segment;
use crate::posture::survey::find::{Paint, distance};
use crate::posture::survey::naming::{MARGIN, Naming, Point, Scene, colour_cost, rigid_cost};

/// A naming seen in one frame costs half of this; in more frames, less.
const FRESH: f64 = 4.0;
/// A naming whose spots, once there, were seen together in none of the frames costs this.
const ABSENT: f64 = 5.0;

/// A spot without a name is a mark like those beside it where it stands out by this share of the fainter one and is as
/// large within this factor (measured: folds of skin and the like on five films of marks put onto photographs of real
/// hands: 0.2 to 0.45).
const ALIKE_CONTRAST: f64 = 0.5;
const ALIKE_SIZE: f64 = 2.0;

/// A naming and what the frames looked at said of it.
#[derive(Debug, Clone)]
pub(super) struct Hypothesis {
    pub(super) naming: Naming,
    pub(super) frames: usize,
    pub(super) shape: f64,
    pub(super) backwards: f64,
    /// Shortest and longest distance to the marker before, for each place.
    pub(super) spans: Vec<(f64, f64)>,
}

impl Surveyor<'_> {
    /// Which spots each place of the chain can have.
    pub(super) fn choices(&self) -> Vec<Vec<(usize, f64)>> {
        let links = self.chain.links.iter().zip(&self.fixed);
        links
            .map(|(link, fixed)| {
                let paint = self.paint_of[link.marker];
                let mut choices: Vec<(usize, f64)> = (self.spots.all.iter().enumerate())
                    .filter(|(number, spot)| spot.paints[paint] && fixed.is_none_or(|fixed| fixed == *number))
                    .map(|(number, spot)| {
                        let cost = |paint: &Paint| colour_cost(paint, spot.last());
                        let mine = cost(&self.paints[paint]);
                        // A spot that is rather another marker's colour.
                        let least = self.paints.iter().map(cost).fold(mine, f64::min);
                        (number, if fixed.is_some() { 0.0 } else { mine + 0.5 * (mine - least) })
                    })
                    .collect();
                choices.retain(|choice| fixed.is_some() || !self.fixed.contains(&Some(choice.0)));
                choices
            })
            .collect()
    }

    pub(super) fn scene<'b>(&'b self, points: &'b [Option<Point>], choices: &'b [Vec<(usize, f64)>]) -> Scene<'b> {
        Scene {
            chain: &self.chain,
            choices,
            points,
            lengths_px: &self.unknown,
            missing: &self.missing,
            flexion: self.layout.flexion.sign(),
            blots: self.spots.are_blots(),
        }
    }

    /// A naming that comes up is judged by the frames before too.
    pub(super) fn add(&mut self, naming: Naming, choices: &[Vec<(usize, f64)>], now: u64) {
        let spans = vec![(f64::INFINITY, 0.0); naming.len()];
        let mut hypothesis = Hypothesis { naming, frames: 0, shape: 0.0, backwards: 0.0, spans };
        for &frame in self.looked.iter().filter(|&&frame| frame != now) {
            let points: Vec<Option<Point>> = self.spots.all.iter().map(|spot| spot.at(frame).copied()).collect();
            update(&mut hypothesis, &self.scene(&points, choices));
        }
        self.hypotheses.push(hypothesis);
    }

    pub(super) fn judge(&mut self, points: &[Option<Point>], choices: &[Vec<(usize, f64)>]) {
        let mut hypotheses = std::mem::take(&mut self.hypotheses);
        for hypothesis in &mut hypotheses {
            update(hypothesis, &self.scene(points, choices));
        }
        self.hypotheses = hypotheses;
    }

    /// The mean over frames, the joints bent backwards as in the worst frame, and lengths that changed.
    pub(super) fn cost(&self, hypothesis: &Hypothesis) -> f64 {
        if hypothesis.frames == 0 {
            return f64::INFINITY;
        }
        // From the first frame that could show all its spots: those that come late are as good, those that vanish are
        // not.
        let born = hypothesis.naming.iter().flatten().map(|&spot| self.spots.all[spot].points[0].frame).max();
        let span = self.looked.len() - self.looked.partition_point(|&frame| Some(frame) < born);
        let absent = 1.0 - hypothesis.frames as f64 / span.max(1) as f64;
        let fresh = FRESH / (hypothesis.frames as f64 + 1.0);
        let rigid: f64 = (self.chain.links.iter().zip(&hypothesis.spans))
            .filter(|(link, span)| link.rigid && span.1 > 0.0)
            .map(|(_, &(shortest, longest))| rigid_cost(shortest, longest))
            .sum();
        hypothesis.shape / hypothesis.frames as f64 + hypothesis.backwards + rigid + ABSENT * absent + fresh
    }

    /// Needed places of the chain that another naming, about as good as the best one, fills otherwise.
    pub(super) fn unsure(&self) -> Vec<usize> {
        let Some(best) = self.hypotheses.first() else { return Vec::new() };
        let limit = self.cost(best) + MARGIN;
        let mut unsure = vec![false; self.chain.links.len()];
        for other in self.hypotheses[1..].iter().take_while(|other| self.cost(other) < limit) {
            for (place, unsure) in unsure.iter_mut().enumerate() {
                *unsure |= self.is_needed(place) && self.differ(best, other, place);
            }
        }
        (0..unsure.len()).filter(|&place| unsure[place]).collect()
    }

    /// What to say of segments between whose markers a spot lies that has no name: where the colours of two markers are
    /// exchanged in the marker file, one of a segment is passed over.
    pub(super) fn passed_over(&self, best: &Hypothesis) -> Vec<String> {
        let spot_of =
            |marker: usize| best.naming[self.chain.place_of(marker).filter(|&place| self.is_needed(place))?];
        let is_alike = |spot: usize, named: usize| {
            let [spot, named] = [spot, named].map(|number| self.spots.all[number].last());
            let growth = spot.radius_px / named.radius_px;
            spot.contrast >= ALIKE_CONTRAST * named.contrast && (1.0 / ALIKE_SIZE..=ALIKE_SIZE).contains(&growth)
        };
        let stranger = |[a, b]: [usize; 2]| {
            let nameless = (0..self.spots.all.len()).filter(|spot| !best.naming.contains(&Some(*spot)));
            nameless
                .filter(|&spot| is_alike(spot, a) || is_alike(spot, b))
                .map(|spot| {
                    let at = |spot: usize, frame| self.spots.all[spot].at(frame).map(|point| point.at_px);
                    let lies = |&&frame: &&u64| {
                        let points = at(a, frame).zip(at(b, frame)).zip(at(spot, frame));
                        points.is_some_and(|((a, b), between)| is_between(a, b, between))
                    };
                    (spot, self.looked.iter().filter(lies).count())
                })
                .max_by_key(|&(_, frames)| frames)
                .filter(|&(_, frames)| frames >= LEAST_FRAMES && 2 * frames > self.looked.len())
        };
        let said = |segment: &Segment| {
            let [a, b] = segment.markers;
            let (spot, frames) = stranger([spot_of(a)?, spot_of(b)?])?;
            let name = |marker: usize| self.layout.markers[marker].name.as_str();
            let alike = (0..self.paint_of.len()).find(|&marker| self.spots.all[spot].paints[self.paint_of[marker]])?;
            Some(format!(
                "between {} and {} of segment {} lies a mark of the colour of {} that has no name, in {frames} of {} \
                 frames: are the colours of two markers exchanged under [markers]?",
                name(a),
                name(b),
                segment.name,
                name(alike),
                self.looked.len()
            ))
        };
        self.layout.segments.iter().filter_map(said).collect()
    }

    /// Whether two namings can't both be right in a place. A spot that was lost and came back as another one is no
    /// contradiction.
    pub(super) fn differ(&self, best: &Hypothesis, other: &Hypothesis, place: usize) -> bool {
        match (best.naming[place], other.naming[place]) {
            (Some(a), Some(b)) if a == b => false,
            (Some(a), Some(b)) => {
                let [a_points, b_points] = [a, b].map(|spot| &self.spots.all[spot].points);
                let apart = a_points[a_points.len() - 1].frame < b_points[0].frame
                    || b_points[b_points.len() - 1].frame < a_points[0].frame;
                !apart || other.naming.contains(&Some(a)) || best.naming.contains(&Some(b))
            }
            (Some(_), None) => true,
            (None, _) => false,
        }
    }
}

/// A spot lies between two others where it is at least the first share of their distance from either, along it, and at
/// most the second beside it (assumed: blots fall into parts, which lie at their ends; what is passed over at a joint
/// bends away).
const FROM_EITHER: f64 = 0.15;
const BESIDE: f64 = 0.4;

fn is_between(a: [f64; 2], b: [f64; 2], point: [f64; 2]) -> bool {
    let [way, to_point] = [b, point].map(|end| [end[0] - a[0], end[1] - a[1]]);
    let square = way[0] * way[0] + way[1] * way[1];
    let along = (way[0] * to_point[0] + way[1] * to_point[1]) / square;
    let beside = (way[0] * to_point[1] - way[1] * to_point[0]) / square;
    (FROM_EITHER..=1.0 - FROM_EITHER).contains(&along) && beside.abs() <= BESIDE
}

/// Takes a frame into account.
fn update(hypothesis: &mut Hypothesis, scene: &Scene<'_>) {
    // What is seen of it shows which way it bends, and how long segments are, though something be hidden.
    let seen: Naming = hypothesis.naming.iter().map(|spot| spot.filter(|&spot| scene.points[spot].is_some())).collect();
    let cost = scene.cost(&seen);
    if seen == hypothesis.naming {
        hypothesis.frames += 1;
        hypothesis.shape += cost.shape;
    }
    hypothesis.backwards = hypothesis.backwards.max(cost.backwards);
    for (place, link) in scene.chain.links.iter().enumerate() {
        let at = |place: usize| hypothesis.naming[place].and_then(|spot| scene.points[spot]);
        if let (Some(here), Some(before)) = (at(place), link.before.and_then(at)) {
            let length = distance(here.at_px, before.at_px);
            let span = &mut hypothesis.spans[place];
            *span = (span.0.min(length), span.1.max(length));
        }
    }
}
