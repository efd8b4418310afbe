//! The lumens that a unit can have at a venous pressure.
//!
//! At rest a unit's lumen `l` decides the venous pressure `p(l) = w(l) - R_Vi f(l)` behind it. Its slope
//! `p' = w' - R f'`, `f' = g l^3 (4 (S - w) - l w')`, changes sign at turning points; between two of them `p` is
//! monotone, and every venous pressure has one lumen at most: a [`Branch`].
//!
//! Where walls don't touch, `f' = g l^3 (4 h - 5 e l)` with `h = S - P_ext + e` has its greatest value at
//! `l = 3 h / (5 e)`, so there are two turning points at most, one on each side of it. Where they touch, `p'` is
//! bounded over ranges of lumens, which are cut until `p'` or its own slope keeps its sign.

use super::range::product;
use crate::equilibrium::network::Vessel;
use crate::equilibrium::root::LEAST_LUMEN;
use crate::model::TOUCH;

/// Lumens over which the venous pressure is monotone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Branch {
    /// Its ends, the lesser first.
    pub(super) lumens: [f64; 2],
    /// The venous pressures there, Pa.
    pub(super) pressures: [f64; 2],
}

/// A range of lumens whose ends differ by less than this part is not cut any more.
const NARROWEST: f64 = 1e-9;
/// Newton steps and halvings before a lumen is taken as it is.
const MOST_STEPS: usize = 200;

impl Branch {
    pub(super) fn rises(&self) -> bool {
        self.pressures[1] >= self.pressures[0]
    }

    /// The lumen at a venous pressure; `None` where the branch does not reach it.
    pub(super) fn at(&self, vessel: &Vessel, venous: f64) -> Option<f64> {
        let [a, b] = self.pressures;
        match venous {
            _ if venous == a => Some(self.lumens[0]),
            _ if venous == b => Some(self.lumens[1]),
            _ if venous < a.min(b) || venous > a.max(b) => None,
            _ => Some(vessel.lumen_at(venous, self.lumens, self.rises())),
        }
    }
}

impl Vessel {
    /// The branches of a vessel with pressures inside between these; none where it would be closed. They cover every
    /// venous pressure between these at which a lumen of at least [`LEAST_LUMEN`] is possible.
    pub(super) fn branches(&self, inside: [f64; 2]) -> Vec<Branch> {
        let [least, greatest] = inside.map(|pressure| self.lumen_holding(pressure));
        if greatest < LEAST_LUMEN {
            return Vec::new();
        }
        let mut ends = vec![least.max(LEAST_LUMEN)];
        self.turning_points(ends[0], greatest, &mut ends);
        ends.push(greatest);
        let last = ends.len() - 1;
        let mut pressures: Vec<f64> = ends.iter().map(|&lumen| self.venous_at_turning(lumen)).collect();
        let end = self.venous(ends[0]);
        pressures[0] = if least < LEAST_LUMEN { end } else { end.min(inside[0]) };
        // Where the pressure inside is P_H, nothing flows and the venous pressure is P_H as well.
        pressures[last] = if self.source >= inside[1] { inside[1] } else { self.venous(ends[last]).max(inside[1]) };
        let pairs = ends.windows(2).zip(pressures.windows(2));
        pairs.map(|(l, p)| Branch { lumens: [l[0], l[1]], pressures: [p[0], p[1]] }).collect()
    }

    /// `p` at a lumen, Pa.
    fn venous(&self, lumen: f64) -> f64 {
        let inside = self.pressure(lumen);
        inside - self.venule * (self.conductance * (lumen * lumen) * (lumen * lumen) * (self.source - inside))
    }

    /// `p` at a turning point, Pa: `w' = R f'` leaves no difference of great pressures in it.
    fn venous_at_turning(&self, lumen: f64) -> f64 {
        let g = self.venule * (self.conductance * (lumen * lumen) * (lumen * lumen));
        self.source - self.pressure_slope(lumen) * lumen * (1.0 + g) * (1.0 + g) / (4.0 * g)
    }

    /// `p'` at a lumen, Pa.
    fn venous_slope(&self, lumen: f64) -> f64 {
        let slope = self.pressure_slope(lumen);
        let drop = self.source - self.pressure(lumen);
        slope - self.venule * (self.conductance * (lumen * lumen * lumen) * (4.0 * drop - lumen * slope))
    }

    /// The lumen at which the wall holds a pressure inside.
    fn lumen_holding(&self, inside: f64) -> f64 {
        let lumen = 1.0 + (inside - self.outside) / self.stiffness;
        if !self.contact || lumen >= TOUCH {
            return lumen;
        }
        // The contact's force is l - lumen with 0 < l < TOUCH.
        let least = TOUCH / (1.0 + libm::cbrt(TOUCH - lumen));
        Vessel { venule: 0.0, ..*self }.lumen_at(inside, [0.5 * least, TOUCH], true)
    }

    /// The lumen in a range at which the venous pressure behind is this one, `p` being monotone over the range.
    pub(super) fn lumen_at(&self, venous: f64, [mut low, mut high]: [f64; 2], rises: bool) -> f64 {
        let mut at = low + 0.5 * (high - low);
        for _ in 0..MOST_STEPS {
            let row = self.row(at, venous, 0.0);
            if row.residual == 0.0 {
                return at;
            }
            *(if (row.residual > 0.0) == rises { &mut high } else { &mut low }) = at;
            let mut next = at - row.residual / row.alpha;
            if !(next > low && next < high) {
                next = low + 0.5 * (high - low);
            }
            if (next - at).abs() <= f64::EPSILON * at {
                return next;
            }
            at = next;
        }
        at
    }

    /// Where `p'` changes its sign between two lumens, growing.
    fn turning_points(&self, low: f64, high: f64, out: &mut Vec<f64>) {
        if self.venule == 0.0 {
            return;
        }
        let mut open = low;
        if self.contact && low < TOUCH {
            open = high.min(TOUCH);
            self.turning_points_in_contact(low, open, out);
        }
        let steepest = 0.6 * ((self.source - self.outside) / self.stiffness + 1.0);
        let middle = steepest.clamp(open, high);
        out.extend(self.turning_point(open, middle));
        out.extend(self.turning_point(middle, high));
    }

    /// Where `p'` changes its sign between two lumens over which it is monotone.
    fn turning_point(&self, mut low: f64, mut high: f64) -> Option<f64> {
        let falls = self.venous_slope(low) > 0.0;
        if (self.venous_slope(high) > 0.0) == falls {
            return None;
        }
        loop {
            let middle = low + 0.5 * (high - low);
            if middle <= low || middle >= high {
                return Some(middle);
            }
            *(if (self.venous_slope(middle) > 0.0) == falls { &mut low } else { &mut high }) = middle;
        }
    }

    /// The same where walls touch. With `T` for [`TOUCH`], `p' / e` is `1 + 3 T (T - l)^2 / l^4` less `R g` times
    /// `4 (h / e) l^3 - 5 l^4 + (T - l)^2 (T - 4 l)`.
    fn turning_points_in_contact(&self, low: f64, high: f64, out: &mut Vec<f64>) {
        let factor = self.venule * self.conductance;
        let head = (self.source - self.outside) / self.stiffness + 1.0;
        let [near, far] = [TOUCH - high, TOUCH - low];
        let wall = |l: f64| 1.0 + 3.0 * TOUCH * (TOUCH - l) * (TOUCH - l) / (l * l * l * l);
        let open = product([4.0 * head, 4.0 * head], [low * low * low, high * high * high]);
        let touching = product([near * near, far * far], [TOUCH - 4.0 * high, TOUCH - 4.0 * low]);
        let most = open[1] - 5.0 * low * low * low * low + touching[1];
        let least = open[0] - 5.0 * high * high * high * high + touching[0];
        if wall(high) - factor * most > 0.0 || wall(low) - factor * least < 0.0 {
            return;
        }
        // The slope of p' / e.
        let wall = |l: f64| -6.0 * TOUCH * (TOUCH - l) * (2.0 * TOUCH - l) / (l * l * l * l * l);
        let open = product([12.0 * head, 12.0 * head], [low * low, high * high]);
        let touching = product([near, far], [TOUCH - 2.0 * high, TOUCH - 2.0 * low]);
        let most = open[1] - 20.0 * low * low * low - 6.0 * touching[0];
        let least = open[0] - 20.0 * high * high * high - 6.0 * touching[1];
        let monotone = wall(high) - factor * least < 0.0 || wall(low) - factor * most > 0.0;
        if monotone || high <= low * (1.0 + NARROWEST) {
            out.extend(self.turning_point(low, high));
            return;
        }
        let middle = (low * high).sqrt();
        self.turning_points_in_contact(low, middle, out);
        self.turning_points_in_contact(middle, high, out);
    }
}
