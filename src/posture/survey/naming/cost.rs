//! Which spot is which marker: what a naming costs, and the cheapest namings of a frame.
//!
//! A naming gives each marker of the chain a spot or none. Its cost is about minus the logarithm of how likely it is:
//! colours as the marker file says but for light and white balance, markers of one size, neighbours near one another,
//! no turns that a finger can't make, no crossing. Costs are weights that were set by hand on scenes, not
//! probabilities.

use crate::posture::survey::find::Paint;
use crate::posture::survey::naming::{Chain, Point};

/// A marker that is not seen costs this.
pub(crate) const MISSING: f64 = 7.0;
/// A segment may seem longer or shorter than it was by this share and this much.
pub(crate) const LENGTH_SHARE: f64 = 0.15;
pub(crate) const LENGTH_FREE_PX: f64 = 2.0;
/// How much radii of neighbours differ, as a logarithm (assumed; blots of a real recording are 19 to 40 px long, 8 to
/// 28 px wide).
const DISC_SIZES: f64 = 0.22;
const BLOT_SIZES: f64 = 0.5;
/// What a segment of another length costs: more than any other fault.
const IMPOSSIBLE: f64 = 50.0;
/// Namings carried from one marker to the next.
const BEAM: usize = 300;
/// Namings handed on for a frame.
const KEPT: usize = 24;

/// For each place of the chain the spot that it is given.
pub(crate) type Naming = Vec<Option<usize>>;

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Cost {
    /// All that does not depend on which way flexion turns.
    pub(crate) shape: f64,
    /// Joints bent backwards.
    pub(crate) backwards: f64,
}

impl Cost {
    fn total(self) -> f64 {
        self.shape + self.backwards
    }
}

/// A frame's spots and what they could be.
pub(crate) struct Scene<'a> {
    pub(crate) chain: &'a Chain,
    /// For each place of the chain, which spots it can have and what their colours cost.
    pub(crate) choices: &'a [Vec<(usize, f64)>],
    /// For each spot where it is in the frame.
    pub(crate) points: &'a [Option<Point>],
    /// For each place how far its marker is from the one before it, where that is known and can't change.
    pub(crate) lengths_px: &'a [Option<f64>],
    /// For each place what it costs to leave it without a spot.
    pub(crate) missing: &'a [f64],
    /// 1 where flexion is clockwise, else -1.
    pub(crate) flexion: f64,
    /// Marks are blots of paint, of all sizes, rather than discs of one.
    pub(crate) blots: bool,
}

impl Scene<'_> {
    /// The cheapest namings of the frame.
    pub(crate) fn namings(&self) -> Vec<(Naming, f64)> {
        let mut beam: Vec<(Naming, Cost)> = vec![(Vec::new(), Cost::default())];
        for place in 0..self.chain.links.len() {
            let mut next: Vec<(Naming, Cost)> = Vec::new();
            for (naming, cost) in &beam {
                for choice in self.choices[place].iter().map(|&(spot, _)| Some(spot)).chain([None]) {
                    let taken = |spot| naming.contains(&Some(spot)) || self.points[spot].is_none();
                    if choice.map_or(self.missing[place].is_infinite(), taken) {
                        continue;
                    }
                    let mut longer = naming.clone();
                    longer.push(choice);
                    let step = self.step(&longer, place);
                    next.push((
                        longer,
                        Cost { shape: cost.shape + step.shape, backwards: cost.backwards + step.backwards },
                    ));
                }
            }
            next.sort_by(|a, b| a.1.total().total_cmp(&b.1.total()));
            next.truncate(if place + 1 == self.chain.links.len() { KEPT } else { BEAM });
            beam = next;
        }
        beam.into_iter().map(|(naming, cost)| (naming, cost.total())).collect()
    }

    /// What a naming of spots that are all seen costs.
    pub(crate) fn cost(&self, naming: &[Option<usize>]) -> Cost {
        (0..naming.len()).map(|place| self.step(&naming[..=place], place)).fold(Cost::default(), |sum, step| Cost {
            shape: sum.shape + step.shape,
            backwards: sum.backwards + step.backwards,
        })
    }

    fn point(&self, naming: &[Option<usize>], place: usize) -> Option<Point> {
        naming[place].and_then(|spot| self.points[spot])
    }

    /// The nearest place before one that has a spot.
    fn before(&self, naming: &[Option<usize>], place: usize) -> Option<usize> {
        let mut at = self.chain.links[place].before;
        while let Some(before) = at {
            if naming[before].is_some() {
                return at;
            }
            at = self.chain.links[before].before;
        }
        None
    }

    /// What the marker of `place` adds to the cost of those before it.
    fn step(&self, naming: &[Option<usize>], place: usize) -> Cost {
        let Some(here) = self.point(naming, place) else { return Cost { shape: self.missing[place], backwards: 0.0 } };
        let spot = naming[place];
        let mut cost = Cost::default();
        cost.shape +=
            self.choices[place].iter().find(|choice| Some(choice.0) == spot).map_or(MISSING, |choice| choice.1);
        let Some(b) = self.before(naming, place) else {
            // A chain that starts again is compared in size with any other marker.
            if let Some(other) = (0..place).find_map(|other| self.point(naming, other)) {
                cost.shape += self.size_cost(&here, &other);
            }
            return cost;
        };
        let Some(before) = self.point(naming, b) else { return cost };
        cost.shape += self.size_cost(&here, &before);
        let link = minus(here.at_px, before.at_px);
        let length = norm(link);
        cost.shape += half_square((length / (6.0 * before.radius_px.max(1.0))).ln(), 1.2);
        if length < 1.2 * before.radius_px {
            cost.shape += 2.0;
        }
        let mut links = Vec::with_capacity(naming.len());
        self.links_before(naming, b, &mut links);
        let direct = self.chain.links[place].before == Some(b);
        let rigid = direct && self.chain.links[place].rigid;
        if let Some(known) = self.lengths_px[place].filter(|_| direct) {
            let off = (length - known).abs();
            cost.shape += half_square(off, 0.04 * known + 1.5).min(4.0);
            if off > LENGTH_SHARE * known + LENGTH_FREE_PX {
                cost.shape += IMPOSSIBLE;
            }
        // Compared with the last link of its kind.
        } else if let Some(alike) = links.iter().find(|other| other.rigid == rigid) {
            cost.shape += half_square((length / norm(alike.vector)).ln(), 0.55);
        }
        if let Some(last) = links.first() {
            let turn = self.flexion * angle(last.vector, link);
            cost.shape += half_square(turn, 75f64.to_radians()).min(4.0);
            if turn.abs() > 150f64.to_radians() {
                cost.shape += 6.0;
            }
        }
        if rigid
            && self.chain.links[place].bends
            && let Some(segment) = links.iter().find(|other| other.rigid)
        {
            let turn = self.flexion * angle(segment.vector, link);
            if turn < (-60f64).to_radians() {
                cost.shape += 3.0;
            }
            cost.backwards += half_square((-turn - 15f64.to_radians()).max(0.0), 10f64.to_radians()).min(8.0);
        }
        for other in &links {
            // The last link ends where this one starts.
            if other.end != b && cross(other, before.at_px, here.at_px) {
                cost.shape += 5.0;
            }
        }
        cost
    }

    fn size_cost(&self, a: &Point, b: &Point) -> f64 {
        half_square((a.radius_px / b.radius_px).ln(), if self.blots { BLOT_SIZES } else { DISC_SIZES }).min(6.0)
    }

    /// The links that lead to `place`, the last one first.
    fn links_before(&self, naming: &[Option<usize>], place: usize, links: &mut Vec<Segment>) {
        let mut at = place;
        while let Some(before) = self.before(naming, at) {
            if let (Some(from), Some(to)) = (self.point(naming, before), self.point(naming, at)) {
                let rigid = self.chain.links[at].rigid && self.chain.links[at].before == Some(before);
                links.push(Segment { from: from.at_px, vector: minus(to.at_px, from.at_px), rigid, end: at });
            }
            at = before;
        }
    }
}

/// What a spot's looks cost as a marker of this paint.
pub(crate) fn colour_cost(paint: &Paint, point: &Point) -> f64 {
    let faint = -0.7 * point.contrast.clamp(0.05, 1.0).ln();
    if !paint.is_chromatic() {
        return faint;
    }
    let zero = paint.zero();
    let chroma = |colour: [f64; 3]| [colour[1] - zero[0], colour[2] - zero[1]];
    let (seen, painted) = (chroma(point.colour), chroma(paint.colour));
    let hue = angle(painted, seen);
    let share = (norm(seen).max(1.0) / norm(painted)).ln();
    // Light scales luma and chroma alike: what remains is how pale or dark the paint itself is.
    let depth = share - (point.colour[0].max(16.0) / paint.colour[0].max(16.0)).ln();
    faint + half_square(hue, 9f64.to_radians()).min(12.0) + half_square(share, 0.6) + half_square(depth, 0.6).min(3.0)
}

/// How far apart the same two markers have been, seen over time: a segment does not change its length.
pub(crate) fn rigid_cost(shortest: f64, longest: f64) -> f64 {
    // Places of spots are good to about a pixel.
    let free = 2.5 + 0.015 * longest;
    half_square((longest - shortest - free).max(0.0) / longest, 0.02).min(6.0)
}

struct Segment {
    from: [f64; 2],
    vector: [f64; 2],
    rigid: bool,
    /// The place that it leads to.
    end: usize,
}

fn half_square(value: f64, scale: f64) -> f64 {
    0.5 * (value / scale) * (value / scale)
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn norm([x, y]: [f64; 2]) -> f64 {
    x.hypot(y).max(1e-6)
}

/// The angle from `a` to `b`, clockwise on the picture.
fn angle(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1])
}

fn cross(segment: &Segment, from: [f64; 2], to: [f64; 2]) -> bool {
    let side = |start: [f64; 2], way: [f64; 2], point: [f64; 2]| {
        let to_point = minus(point, start);
        way[0] * to_point[1] - way[1] * to_point[0]
    };
    let end = [segment.from[0] + segment.vector[0], segment.from[1] + segment.vector[1]];
    let way = minus(to, from);
    side(segment.from, segment.vector, from) * side(segment.from, segment.vector, to) < 0.0
        && side(from, way, segment.from) * side(from, way, end) < 0.0
}
