//! The lines that agree with every reading, as a convex polygon.
//!
//! A line `c(t) - t = height + end t / half` over `-half <= t <= half` is a point `(height, end)`, both in seconds:
//! `end` is how far the line rises from the middle to the end. A frame at `t` that shows `R` bounds it from below by
//! `q = R - t` and from above by `q + room`. Of all frames only the hulls of the points `(t, q)` bound anything: the
//! upper hull from below, the lower from above.

/// A point of the plane: time and what the clock shows less the time; or height and end of a line.
pub(super) type Point = [f64; 2];

/// The hulls of readings.
#[derive(Debug, Clone)]
pub(super) struct Hulls {
    /// Convex from above.
    upper: Vec<Point>,
    /// Convex from below.
    lower: Vec<Point>,
    /// Half the time span, seconds; never 0.
    pub(super) half_s: f64,
}

impl Hulls {
    /// The hulls of points sorted by time, whose times are within `±half_s`.
    pub(super) fn new(sorted: impl Iterator<Item = Point> + Clone, half_s: f64) -> Self {
        Self { upper: hull(sorted.clone(), 1.0), lower: hull(sorted, -1.0), half_s }
    }

    /// The least room with which a line with `|end| <= most_end_s` agrees with all, and that line's `end`; below 0
    /// where much room is left over.
    pub(super) fn least_room(&self, most_end_s: f64) -> (f64, f64) {
        let room = |end: f64| {
            let rise = |p: &Point| p[1] - end * p[0] / self.half_s;
            let top = self.upper.iter().map(rise).fold(f64::NEG_INFINITY, f64::max);
            let bottom = self.lower.iter().map(rise).fold(f64::INFINITY, f64::min);
            top - bottom
        };
        // Convex in `end`, and bent only where the line runs along an edge of a hull.
        let slope = |pair: &[Point]| self.half_s * (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]);
        let mut bends: Vec<f64> = self.upper.windows(2).chain(self.lower.windows(2)).map(slope).collect();
        bends.retain(|end| end.abs() < most_end_s);
        bends.extend([-most_end_s, most_end_s]);
        bends.sort_by(f64::total_cmp);
        // Between two that are the same nothing rises or falls.
        bends.dedup_by(|later, before| *later - *before < 1e-9);
        let (mut low, mut high) = (0, bends.len() - 1);
        while low < high {
            let middle = usize::midpoint(low, high);
            if room(bends[middle]) <= room(bends[middle + 1]) {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        // Flat at the bottom: its middle.
        let best = room(bends[low]);
        let flat =
            bends[low..].iter().take_while(|&&end| room(end) <= best + 1e-12).last().copied().unwrap_or(bends[low]);
        (best, 0.5 * (bends[low] + flat))
    }

    /// The corners of the polygon of the lines with `|end| <= most_end_s` that agree with all when each frame leaves
    /// `room_s`, in order around it; empty where none does.
    pub(super) fn polygon(&self, room_s: f64, most_end_s: f64) -> Vec<Point> {
        let height = |p: &Point| p[1].abs() + most_end_s;
        let far = self.upper.iter().chain(&self.lower).map(height).fold(room_s, f64::max) + room_s;
        let mut corners = vec![[-far, -most_end_s], [far, -most_end_s], [far, most_end_s], [-far, most_end_s]];
        for p in &self.upper {
            corners = cut(&corners, |c| c[0] + c[1] * p[0] / self.half_s - p[1]);
        }
        for p in &self.lower {
            corners = cut(&corners, |c| p[1] + room_s - c[0] - c[1] * p[0] / self.half_s);
        }
        corners
    }
}

/// The hull's corners above (`side` 1) or below (-1).
fn hull(sorted: impl Iterator<Item = Point>, side: f64) -> Vec<Point> {
    let mut corners: Vec<Point> = Vec::new();
    for p in sorted {
        if let Some(last) = corners.last_mut()
            && last[0] == p[0]
        {
            if side * (p[1] - last[1]) <= 0.0 {
                continue;
            }
            corners.pop();
        }
        while let [.., a, b] = corners[..]
            && side * ((b[1] - a[1]) * (p[0] - a[0]) - (p[1] - a[1]) * (b[0] - a[0])) <= 0.0
        {
            corners.pop();
        }
        corners.push(p);
    }
    corners
}

/// The part of a convex polygon where `inside` (a linear function) is not negative.
fn cut(corners: &[Point], inside: impl Fn(&Point) -> f64) -> Vec<Point> {
    let mut left = Vec::with_capacity(corners.len() + 1);
    for (k, a) in corners.iter().enumerate() {
        let b = &corners[(k + 1) % corners.len()];
        let (at_a, at_b) = (inside(a), inside(b));
        if at_a >= 0.0 {
            left.push(*a);
        }
        if (at_a >= 0.0) != (at_b >= 0.0) {
            let share = at_a / (at_a - at_b);
            left.push([0, 1].map(|i| a[i] + share * (b[i] - a[i])));
        }
    }
    left
}

/// Mean, variances and covariance of a distribution over lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moments {
    /// Mean of height and end.
    pub(super) mean: Point,
    /// Variance of the height, covariance, variance of the end.
    pub(super) spread: [f64; 3],
}

impl Moments {
    /// Makes the spread about the mean that of `other` about this mean.
    pub(super) fn widen(&mut self, other: &Self) {
        let off = [0, 1].map(|i| other.mean[i] - self.mean[i]);
        self.spread =
            [other.spread[0] + off[0] * off[0], other.spread[1] + off[0] * off[1], other.spread[2] + off[1] * off[1]];
    }
}

/// Slices between two corners of a polygon that its moments are summed over.
const SLICES: usize = 24;

/// Those of a distribution over a convex polygon: uniform in the height, and in the end as Cauchy's of the scale
/// `usual_end_s` about 0. None for no corners.
pub(super) fn moments(corners: &[Point], usual_end_s: f64) -> Option<Moments> {
    let first = corners.first()?;
    let mut ends: Vec<f64> = corners.iter().map(|c| c[1]).collect();
    ends.sort_by(f64::total_cmp);
    let (mut sum, mut sums, mut squares) = (0.0, [0.0; 2], [0.0; 3]);
    for pair in ends.windows(2).filter(|pair| pair[1] > pair[0]) {
        let angles = [pair[0], pair[1]].map(|end| (end / usual_end_s).atan());
        let chords = [pair[0], pair[1]].map(|end| chord(corners, end));
        for k in 0..SLICES {
            // In the angle whose tangent is the end Cauchy's distribution is even.
            let angle = angles[0] + (angles[1] - angles[0]) * (k as f64 + 0.5) / SLICES as f64;
            let end = usual_end_s * angle.tan();
            let share = ((end - pair[0]) / (pair[1] - pair[0])).clamp(0.0, 1.0);
            let [low, high] = [0, 1].map(|i| chords[0][i] + share * (chords[1][i] - chords[0][i]));
            let weight = (angles[1] - angles[0]) * (high - low).max(0.0);
            let (height, end) = (0.5 * (low + high) - first[0], end - first[1]);
            sum += weight;
            sums[0] += weight * height;
            sums[1] += weight * end;
            squares[0] += weight * (height * height + (high - low).powi(2) / 12.0);
            squares[1] += weight * height * end;
            squares[2] += weight * end * end;
        }
    }
    if sum <= 0.0 {
        // A line or a point.
        let mean = [0, 1].map(|i| corners.iter().map(|c| c[i]).sum::<f64>() / corners.len() as f64);
        return Some(Moments { mean, spread: [0.0; 3] });
    }
    let mean = sums.map(|s| s / sum);
    let spread = [
        (squares[0] / sum - mean[0] * mean[0]).max(0.0),
        squares[1] / sum - mean[0] * mean[1],
        (squares[2] / sum - mean[1] * mean[1]).max(0.0),
    ];
    Some(Moments { mean: [first[0] + mean[0], first[1] + mean[1]], spread })
}

/// The least and the greatest height of a convex polygon at an end between those of its corners.
fn chord(corners: &[Point], end: f64) -> [f64; 2] {
    let mut chord = [f64::INFINITY, f64::NEG_INFINITY];
    for (k, a) in corners.iter().enumerate() {
        let b = &corners[(k + 1) % corners.len()];
        if (a[1] <= end) == (b[1] <= end) && a[1] != end && b[1] != end {
            continue;
        }
        let share = if b[1] == a[1] { 0.0 } else { ((end - a[1]) / (b[1] - a[1])).clamp(0.0, 1.0) };
        let at = a[0] + share * (b[0] - a[0]);
        chord = [chord[0].min(at), chord[1].max(at)];
        if a[1] == end && b[1] == end {
            chord = [chord[0].min(b[0]), chord[1].max(b[0])];
        }
    }
    chord
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polygon_of_three_frames_is_known_by_hand() {
        // Lines h + e t with |e| <= 1: at least 0 at -1, at 0 and at 1, and at most 1 there.
        let hulls = Hulls::new([[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]].into_iter(), 1.0);
        let corners = hulls.polygon(1.0, 1.0);
        let m = moments(&corners, 1e6).unwrap();
        // |e| <= min(h, 1 - h): a square on its corner, of diagonal 1.
        assert!((m.mean[0] - 0.5).abs() < 1e-12 && m.mean[1].abs() < 1e-12);
        assert!((m.spread[0] - 1.0 / 24.0).abs() < 1e-4 && (m.spread[2] - 1.0 / 24.0).abs() < 1e-4, "{m:?}");
        assert!(m.spread[1].abs() < 1e-12);
        assert_eq!(hulls.least_room(1.0).0, 0.0);
        assert!(hulls.polygon(-0.1, 1.0).is_empty());
    }

    #[test]
    fn the_least_room_is_where_the_polygon_begins() {
        let points = [[-1.0, 0.3], [-0.5, -0.2], [0.1, 0.4], [0.6, 0.0], [1.0, 0.2]];
        let hulls = Hulls::new(points.into_iter(), 1.0);
        let (room, _) = hulls.least_room(0.5);
        assert!(hulls.polygon(room - 1e-9, 0.5).is_empty());
        assert!(!hulls.polygon(room + 1e-9, 0.5).is_empty());
    }
}
