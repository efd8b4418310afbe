//! One joint's angle between the frames in which it was really seen.
//!
//! In: the frames' times, angles and standard errors, missing ones NaN. Out: the angle, its rate of change and its
//! error at any time between two seen frames that are no further apart than the longest gap.
//!
//! Between two frames runs the polynomial through them and the next seen frame on either side (Lagrange): a cubic, at
//! the ends of a run a parabola, between two lone frames a line. A neighbour beyond a gap is not taken, nor one that is
//! nearer than half the two frames' distance: it would magnify its error.
//!
//! The error has two shares. The frames' own errors, taken as independent, go through the polynomial's weights. The
//! polynomial's is that of the next term of Newton's form: what the next frame on either side would change, the larger
//! of the two, less what the frames' errors explain of it. Where no further frame is near, it is what one frame fewer
//! would change; between two lone frames it follows from the joint's root mean square second derivative over the whole
//! recording.

/// Times nearer than this are one: half the last decimal of a table and the rounding of sums of seconds since 1970.
pub(super) const SAME_TIME_S: f64 = 1e-6;
/// A neighbour's least distance, as a share of that of the frames around the asked time.
const LEAST_SPACING: f64 = 0.5;
/// Frames that a polynomial runs through, at most.
const MOST_NODES: usize = 4;

/// An angle between frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Between {
    pub(super) deg: f64,
    /// Of the frames' errors and the interpolation's; NaN where it is not known.
    pub(super) variance_deg2: f64,
    /// Rate of change, degrees a second; NaN for a lone frame.
    pub(super) rate_deg_s: f64,
}

/// The seen frames around a time for which there is no angle, as times; none where there is no frame on that side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hole {
    pub(super) after_s: Option<f64>,
    pub(super) before_s: Option<f64>,
}

/// The polynomial between two frames that follow each other, by its barycentric weights (Berrut and Trefethen 2004,
/// doi:10.1137/S0036144502417715): the value at t is the sum of `inverse[i] * deg[i]` times the distances of t from all
/// other frames.
#[derive(Debug, Clone, Copy)]
struct Piece {
    left: usize,
    count: usize,
    time_s: [f64; MOST_NODES],
    deg: [f64; MOST_NODES],
    variance_deg2: [f64; MOST_NODES],
    inverse: [f64; MOST_NODES],
    /// The variance of its own error, over the squared distances from the first so many frames.
    own2: f64,
    own_count: usize,
}

impl Piece {
    fn at(&self, time_s: f64) -> Between {
        let from = self.time_s.map(|x| time_s - x);
        let nodes = 0..self.count;
        let (mut deg, mut noise, mut rate) = (0.0, 0.0, 0.0);
        for i in nodes.clone() {
            // The product of the distances from the other frames, and its derivative.
            let (mut product, mut slope) = (self.inverse[i], 0.0);
            for j in nodes.clone().filter(|&j| j != i) {
                slope = slope * from[j] + product;
                product *= from[j];
            }
            deg += product * self.deg[i];
            noise += product * product * self.variance_deg2[i];
            rate += slope * self.deg[i];
        }
        let reach: f64 = from[..self.own_count].iter().product();
        Between { deg, variance_deg2: noise + self.own2 * reach * reach, rate_deg_s: rate }
    }
}

/// The seen frames of a joint.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    time_s: Vec<f64>,
    deg: Vec<f64>,
    variance_deg2: Vec<f64>,
    max_gap_s: f64,
    /// Mean square of the second derivative; NaN where no three frames tell one.
    bend2: f64,
    /// The first frame after the time that was asked last.
    next: usize,
    /// The polynomial that was asked last.
    piece: Option<Piece>,
}

impl Curve {
    pub(super) fn new(times_s: &[f64], angles_deg: &[f64], sds_deg: &[f64], max_gap_s: f64) -> Self {
        let seen: Vec<usize> = (0..times_s.len()).filter(|&k| angles_deg[k].is_finite()).collect();
        let mut curve = Self {
            time_s: seen.iter().map(|&k| times_s[k]).collect(),
            deg: seen.iter().map(|&k| angles_deg[k]).collect(),
            variance_deg2: seen.iter().map(|&k| sds_deg[k] * sds_deg[k]).collect(),
            max_gap_s: max_gap_s + SAME_TIME_S,
            bend2: f64::NAN,
            next: 0,
            piece: None,
        };
        curve.bend2 = curve.mean_square_bend();
        curve
    }

    /// The angle at a time; fastest where times ascend.
    pub(super) fn at(&mut self, time_s: f64) -> Result<Between, Hole> {
        if self.next > 0 && self.time_s[self.next - 1] > time_s {
            self.next = self.time_s.partition_point(|&t| t <= time_s);
        }
        while self.time_s.get(self.next).is_some_and(|&t| t <= time_s) {
            self.next += 1;
        }
        let (before, after) = (self.next.checked_sub(1), Some(self.next).filter(|&k| k < self.time_s.len()));
        let is_hit = |k: &usize| (self.time_s[*k] - time_s).abs() <= SAME_TIME_S;
        match before.filter(is_hit).or(after.filter(is_hit)) {
            Some(k) => Ok(self.on(k)),
            None => match (before, after) {
                (Some(left), Some(_)) if self.joined(left) => Ok(self.between(left, time_s)),
                _ => Err(Hole { after_s: before.map(|k| self.time_s[k]), before_s: after.map(|k| self.time_s[k]) }),
            },
        }
    }

    /// Mean square of the second derivative, degrees a second squared, squared; NaN where no three frames show one.
    pub(super) fn bend2(&self) -> f64 {
        self.bend2
    }

    /// From the least angle to the greatest.
    pub(super) fn range_deg(&self) -> f64 {
        let [least, greatest] = crate::median::ends(self.deg.iter().copied());
        greatest - least
    }

    /// At the seen frame `k`.
    fn on(&mut self, k: usize) -> Between {
        let left = if self.joined(k) { Some(k) } else { k.checked_sub(1).filter(|&left| self.joined(left)) };
        let rate_deg_s = left.map_or(f64::NAN, |left| self.between(left, self.time_s[k]).rate_deg_s);
        Between { deg: self.deg[k], variance_deg2: self.variance_deg2[k], rate_deg_s }
    }

    /// Whether the seen frame `k` and the next are no further apart than the longest gap.
    fn joined(&self, k: usize) -> bool {
        k + 1 < self.time_s.len() && self.time_s[k + 1] - self.time_s[k] <= self.max_gap_s
    }

    /// Between the seen frames `left` and the next.
    fn between(&mut self, left: usize, time_s: f64) -> Between {
        let piece = match self.piece.filter(|piece| piece.left == left) {
            Some(piece) => piece,
            None => self.piece(left),
        };
        self.piece = Some(piece);
        piece.at(time_s)
    }

    /// The polynomial between the seen frames `left` and the next.
    fn piece(&self, left: usize) -> Piece {
        let right = left + 1;
        let least_s = LEAST_SPACING * (self.time_s[right] - self.time_s[left]);
        let earlier = |k: usize| k.checked_sub(1).filter(|&k| self.joined(k));
        let later = |k: usize| self.joined(k).then_some(k + 1);
        let far = |a: usize, b: usize| self.time_s[b] - self.time_s[a] >= least_s;
        let first = earlier(left).filter(|&k| far(k, left));
        let last = later(right).filter(|&k| far(right, k));
        let (mut nodes, mut count) = ([left, right, left, left, left], 2);
        for k in [first, last].into_iter().flatten() {
            nodes[count] = k;
            count += 1;
        }
        // What one frame more would change: Newton's next term.
        let more = [earlier(first.unwrap_or(left)), later(last.unwrap_or(right))].into_iter().flatten();
        let next = more.map(|k| {
            let mut longer = nodes;
            longer[count] = k;
            self.term2(&longer[..=count])
        });
        // Of two, the larger. NaN stays NaN.
        let (own2, own_count) = match next.reduce(|a, b| if a < b { b } else { a }) {
            Some(own2) => (own2, count),
            None if count > 2 => (self.term2(&nodes[..count]), count - 1),
            // Half the second derivative, times the distances from both frames.
            None => (0.25 * self.bend2, 2),
        };
        let inverse = self.inverse(&nodes[..count]);
        let of = |values: &[f64]| std::array::from_fn(|i| values[nodes[i]]);
        Piece {
            left,
            count,
            time_s: of(&self.time_s),
            deg: of(&self.deg),
            variance_deg2: of(&self.variance_deg2),
            inverse: std::array::from_fn(|i| inverse[i]),
            own2,
            own_count,
        }
    }

    /// Of each frame one over the product of its distances from the others; of at most one frame more than a polynomial
    /// has.
    fn inverse(&self, nodes: &[usize]) -> [f64; MOST_NODES + 1] {
        let mut inverse = [0.0; MOST_NODES + 1];
        for (i, (inverse, &own)) in inverse.iter_mut().zip(nodes).enumerate() {
            let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
            *inverse = others.map(|(_, &k)| self.time_s[own] - self.time_s[k]).product::<f64>().recip();
        }
        inverse
    }

    /// The square of the frames' divided difference, less what their errors explain of it.
    fn term2(&self, nodes: &[usize]) -> f64 {
        let inverse = self.inverse(nodes);
        let known = || nodes.iter().zip(&inverse);
        let term: f64 = known().map(|(&k, w)| w * self.deg[k]).sum();
        let noise: f64 = known().map(|(&k, w)| w * w * self.variance_deg2[k]).sum();
        let rest = term * term - noise;
        // Not `max`, which would lose a NaN.
        if rest < 0.0 { 0.0 } else { rest }
    }

    /// The mean square of the second derivative at all seen frames with two near neighbours, less what the frames'
    /// errors explain.
    fn mean_square_bend(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0);
        for k in 1..self.time_s.len().saturating_sub(1) {
            if !(self.joined(k - 1) && self.joined(k)) {
                continue;
            }
            let nodes = [k - 1, k, k + 1];
            let inverse = self.inverse(&nodes);
            // Twice the divided difference.
            let bend: f64 = (0..3).map(|i| 2.0 * inverse[i] * self.deg[nodes[i]]).sum();
            let noise: f64 = (0..3).map(|i| (2.0 * inverse[i]).powi(2) * self.variance_deg2[nodes[i]]).sum();
            if noise.is_finite() {
                sum += bend * bend - noise;
                count += 1;
            }
        }
        if count > 0 { (sum / f64::from(count)).max(0.0) } else { f64::NAN }
    }
}

#[cfg(test)]
mod tests;
