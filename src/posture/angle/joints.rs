//! Joint angles of one frame after the other, with their standard errors.
//!
//! In: what each frame shows of each marker; out: each joint's angle, positive in flexion, its zero subtracted, and the
//! markers for want of which an angle is missing. A segment points from its proximal marker to its distal one; a
//! joint's angle is the direction of its distal segment from that of its proximal one, so a straight finger is at 0.
//!
//! Angles are continuous: the first known one lies in (-180, 180] degrees, each later one on the branch nearest to the
//! last known. Each joint is followed by itself, so their sum may pass 180 degrees.
//!
//! Errors of different markers are taken as independent. A marker that both segments share counts once, with both its
//! signs.

use super::cut::Cut;
use super::frozen::Frozen;
use super::lengths::Lengths;
use super::metric::Metric;
use super::view::{Spot, View};
use crate::posture::{Centre, Layout, Sight};
use crate::video::Info;

use std::f64::consts::{PI, TAU};

/// A joint's angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angle {
    /// Positive in flexion.
    pub rad: f64,
    /// Its standard error.
    pub sd_rad: f64,
    /// The part of it that stays from frame to frame, which no smoothing over time makes smaller.
    pub lasting_sd_rad: f64,
}

/// The joints of one frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AngleRow {
    /// One for each of the layout's joints; none where it is not known.
    pub angles: Vec<Option<Angle>>,
    /// The needed markers that are not seen, or coincide with their partner; in the layout's order.
    pub lost: Vec<usize>,
}

impl AngleRow {
    /// `ok`, or `lost:` and the markers.
    #[must_use]
    pub(crate) fn status(&self, layout: &Layout) -> String {
        if self.lost.is_empty() {
            return "ok".to_owned();
        }
        self.lost.iter().fold("lost:".to_owned(), |text, &m| text + " " + &layout.markers[m].name)
    }
}

/// Follows the joints through a video.
#[derive(Debug, Clone)]
pub(crate) struct Angles {
    layout: Layout,
    view: View,
    needed: Vec<bool>,
    last_rad: Vec<Option<f64>>,
    metric: Metric,
    lengths: Lengths,
    frozen: Frozen,
    cut: Cut,
    /// Of each joint, frames in which its segments overlap, and all.
    overlaps: Vec<[u64; 2]>,
}

/// Below so many frames of a joint nothing is said of its segments' order.
const FRAMES: u64 = 20;

/// Two markers nearer to each other than this many standard errors of their distance have no direction.
const APART_SD: f64 = 3.0;
/// Nor have two that are nearer than this, however sure their places.
const APART_PX: f64 = 1e-6;

impl Angles {
    /// For the frames of one video, in order.
    #[must_use]
    pub(crate) fn new(layout: &Layout, info: &Info) -> Self {
        Self::seen_by(layout, View::new(layout, info))
    }

    fn seen_by(layout: &Layout, view: View) -> Self {
        Self {
            view,
            needed: layout.needed(),
            last_rad: vec![None; layout.joints.len()],
            metric: Metric::new(layout.segments.len()),
            lengths: Lengths::new(layout.segments.len()),
            frozen: Frozen::default(),
            cut: Cut::default(),
            overlaps: vec![[0; 2]; layout.joints.len()],
            layout: layout.clone(),
        }
    }

    /// What to say of the view, of markers and of pictures, once all frames are through.
    pub(crate) fn doubts(&self) -> Vec<String> {
        let named = |(segment, text): (usize, String)| {
            let segment = &self.layout.segments[segment];
            let [a, b] = segment.markers.map(|marker| self.layout.markers[marker].name.as_str());
            format!("segment {} ({a} to {b}) {text}", segment.name)
        };
        let lengths = self.lengths.zoomed().into_iter().chain(self.lengths.changing().into_iter().map(named));
        // After pictures that stood still, angles leap as well.
        let time = self.frozen.doubt().or_else(|| self.cut.doubt());
        self.metric.doubt().into_iter().chain(lengths).chain(time).chain(self.overlapping()).collect()
    }

    /// What to say of joints whose segments lie over each other.
    fn overlapping(&self) -> impl Iterator<Item = String> {
        self.layout.joints.iter().zip(&self.overlaps).filter_map(|(joint, &[behind, all])| {
            let [[_, end], [begin, _]] = joint.segments.map(|segment| self.layout.segments[segment].markers);
            (all >= FRAMES && 2 * behind > all).then(|| {
                format!(
                    "the distal segment of {} begins (`{}`) before its proximal one ends (`{}`) in {behind} of {all} \
                     frames: are the places of these markers exchanged in [start], or their names in [segments]?",
                    joint.name, self.layout.markers[begin].name, self.layout.markers[end].name
                )
            })
        })
    }

    /// The angles of the next frame, one sight a marker of the layout.
    pub(crate) fn step(&mut self, sights: &[Sight]) -> AngleRow {
        let spots: Vec<Option<Spot>> = sights
            .iter()
            .zip(&self.needed)
            .map(|(sight, needed)| match sight {
                Sight::Seen(centre) if *needed => self.view.flat(centre).filter(Spot::is_finite),
                _ => None,
            })
            .collect();
        let lasting: Vec<Option<Spot>> = sights
            .iter()
            .map(|sight| match sight {
                Sight::Seen(centre) => self.view.flat(&Centre { covariance_px2: centre.lasting_px2, ..*centre }),
                Sight::Lost(_) => None,
            })
            .collect();
        let mut lost: Vec<usize> = (0..spots.len()).filter(|&m| self.needed[m] && spots[m].is_none()).collect();
        let directions: Vec<Option<Direction>> = self
            .layout
            .segments
            .iter()
            .enumerate()
            .map(|(k, segment)| {
                let [a, b] = segment.markers;
                let wanted = self.layout.joints.iter().any(|j| j.segments.contains(&k));
                if !wanted {
                    return None;
                }
                let (proximal, distal) = (spots[a].as_ref()?, spots[b].as_ref()?);
                let direction = Direction::between(proximal, distal);
                if direction.is_none() {
                    lost.extend([a, b]);
                } else {
                    self.metric.add(k, [0, 1].map(|axis| distal.at_px[axis] - proximal.at_px[axis]));
                    self.lengths.add(k, [proximal.at_px, distal.at_px]);
                }
                direction
            })
            .collect();
        lost.sort_unstable();
        lost.dedup();
        let sign = self.layout.flexion.sign();
        let angles: Vec<Option<Angle>> = self
            .layout
            .joints
            .iter()
            .zip(self.last_rad.iter_mut().zip(&mut self.overlaps))
            .map(|(joint, (last, [behind, all]))| {
                let [a, b] = joint.segments.map(|s| directions[s].as_ref());
                let (a, b) = (a?, b?);
                let [[_, end], [begin, _]] = joint.segments.map(|s| self.layout.segments[s].markers);
                let gap = (spots[end].as_ref()?.at_px, spots[begin].as_ref()?.at_px);
                // However far it bends, a finger's gap points along both of its segments taken together.
                *behind += u64::from([a, b].map(|one| one.along(gap)).iter().sum::<f64>() < 0.0);
                *all += 1;
                let rad = nearest_branch(sign * (b.rad - a.rad) - joint.zero_rad, *last);
                *last = Some(rad);
                let pairs = joint.segments.map(|s| self.layout.segments[s].markers);
                let second_order_rad2 = a.second_order_rad2 + b.second_order_rad2;
                let sd_rad = variance(pairs, [a, b], &spots, second_order_rad2).sqrt();
                let lasting_sd_rad = variance(pairs, [a, b], &lasting, 0.0).sqrt();
                Some(Angle { rad, sd_rad, lasting_sd_rad })
            })
            .collect();
        let places = spots.iter().map(|spot| spot.as_ref().map(|spot| spot.at_px)).collect();
        let turned: Vec<Option<[f64; 2]>> =
            angles.iter().map(|angle| angle.map(|angle| [angle.rad, angle.sd_rad])).collect();
        self.lengths.next_frame();
        self.cut.add(&turned);
        self.frozen.add(places, turned);
        AngleRow { angles, lost }
    }
}

/// `rad` plus or minus whole turns: nearest to `last`, or in (-pi, pi].
fn nearest_branch(rad: f64, last: Option<f64>) -> f64 {
    match last {
        Some(last) => rad - TAU * ((rad - last) / TAU).round(),
        None => rad - TAU * ((rad - PI) / TAU).ceil(),
    }
}

impl Spot {
    fn is_finite(&self) -> bool {
        self.at_px.iter().chain(&self.covariance_px2).all(|v| v.is_finite())
    }
}

/// Where a segment points.
#[derive(Debug, Clone, Copy)]
struct Direction {
    /// Clockwise from the picture's right.
    rad: f64,
    /// Its derivatives by the distal marker's place; those by the proximal one's are the opposite.
    slope: [f64; 2],
    /// What the curvature of the arc tangent adds to its variance.
    second_order_rad2: f64,
}

impl Direction {
    /// How far it is from one place to another along it.
    fn along(&self, (from, to): ([f64; 2], [f64; 2])) -> f64 {
        (to[0] - from[0]) * self.rad.cos() + (to[1] - from[1]) * self.rad.sin()
    }

    /// `None` where the two can't be distinguished.
    fn between(proximal: &Spot, distal: &Spot) -> Option<Self> {
        let [dx, dy] = [distal.at_px[0] - proximal.at_px[0], distal.at_px[1] - proximal.at_px[1]];
        let length = dx.hypot(dy);
        if length <= APART_PX {
            return None;
        }
        let [xx, xy, yy] = std::array::from_fn(|k| proximal.covariance_px2[k] + distal.covariance_px2[k]);
        let (ux, uy) = (dx / length, dy / length);
        let along = ux * ux * xx + 2.0 * ux * uy * xy + uy * uy * yy;
        let across = uy * uy * xx - 2.0 * ux * uy * xy + ux * ux * yy;
        if length <= APART_SD * along.max(across).sqrt() {
            return None;
        }
        // atan(t / (length + a)) for independent normal errors t across and a along, to the fourth order.
        let (along, across) = (along / (length * length), across / (length * length));
        let second_order_rad2 = across * (3.0 * along - 2.0 * across).max(0.0);
        Some(Self { rad: dy.atan2(dx), slope: [-uy / length, ux / length], second_order_rad2 })
    }
}

/// The variance of the angle from the segment `a` to the segment `b`, whose markers are `pairs`, beside that of second
/// order.
fn variance(pairs: [[usize; 2]; 2], [a, b]: [&Direction; 2], spots: &[Option<Spot>], second_order_rad2: f64) -> f64 {
    let parts = [(pairs[0][0], a, 1.0), (pairs[0][1], a, -1.0), (pairs[1][0], b, -1.0), (pairs[1][1], b, 1.0)];
    let mut variance = second_order_rad2;
    for (k, &(marker, ..)) in parts.iter().enumerate() {
        if parts[..k].iter().any(|p| p.0 == marker) {
            continue;
        }
        let same = parts.iter().filter(|p| p.0 == marker);
        let [gx, gy] = same.fold([0.0, 0.0], |g, (_, d, sign)| [g[0] + sign * d.slope[0], g[1] + sign * d.slope[1]]);
        if let Some(spot) = &spots[marker] {
            let [xx, xy, yy] = spot.covariance_px2;
            variance += gx * gx * xx + 2.0 * gx * gy * xy + gy * gy * yy;
        }
    }
    variance.max(0.0)
}

#[cfg(test)]
mod tests;
