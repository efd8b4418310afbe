//! The nail's outline: a closed curve that fills the box -1..1 in `u` and `v` exactly.
//!
//! |x|^p + |y|^q = 1, where x and y run from the curve's own middle (`middle_u`, `widest_v`) to the box's sides, `q`
//! differs between the proximal and the distal half, and `p` goes smoothly from one end to the other. The exponents set
//! how round the eponychium (proximal) and the hyponychium (distal) are and how parallel the lateral folds run.
//! Distances are to first order, exact at the outline.

use super::smooth::step01;

/// Corners of the truth's polygon. At a nail 400 px wide it lies within 0.02 px of the curve.
pub(super) const CORNERS: usize = 360;

/// The form of one nail, without size or place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NailShape {
    /// Length over width.
    pub aspect: f64,
    /// Where across the nail its ends reach farthest, as `u`; 0 for a symmetrical nail.
    pub middle_u: f64,
    /// Where along the nail it is widest, as `v`; positive for a nail that narrows towards the eponychium.
    pub widest_v: f64,
    /// Exponent across, at the eponychium and at the hyponychium (2 round, more: flatter with sharper corners).
    pub across: [f64; 2],
    /// Exponent along, of the proximal and of the distal half (2 round, more: parallel lateral folds).
    pub along: [f64; 2],
    /// How much the exponent across is larger on the right than on the left, relative.
    pub skew: f64,
}

/// Where a place lies with respect to the nail.
#[derive(Debug, Clone, Copy)]
pub(super) struct NailPlace {
    /// Distance to the outline in half widths, negative inside.
    pub(super) outline: f64,
    /// Distance to the end of the free edge in half widths, negative inside; equal to `outline` on the proximal half.
    pub(super) plate: f64,
    /// Along the nail from its widest place: -1 at the eponychium, 1 at the hyponychium.
    pub(super) y: f64,
}

impl NailShape {
    fn exponent(&self, u_from_middle: f64, v: f64) -> (f64, f64) {
        let side = 1.0 + 0.5 * self.skew * u_from_middle.signum();
        let t = (0.5 * (v + 1.0)).clamp(0.0, 1.0);
        let slope = 15.0 * t * t * (t - 1.0) * (t - 1.0);
        let span = self.across[1] - self.across[0];
        (side * (self.across[0] + span * step01(t)), side * span * slope)
    }

    /// Where (`u`, `v`) lies; `shrink` is [`Self::free_edge`].
    pub(super) fn place(&self, u: f64, v: f64, shrink: f64) -> NailPlace {
        let (du, dv) = (u - self.middle_u, v - self.widest_v);
        let half_u = 1.0 - self.middle_u * du.signum();
        let half_v = 1.0 - self.widest_v * dv.signum();
        let (x, y) = ((du / half_u).abs().max(1e-9), (dv / half_v).abs().max(1e-9));
        let (p, p_slope) = self.exponent(du, v);
        let q = self.along[usize::from(dv > 0.0)];
        let log_x = x.ln();
        let (power_x, power_y) = ((p * log_x).exp(), y.powf(q));
        let slope_u = p * power_x / x / half_u;
        let slope_v_x = power_x * log_x * p_slope;
        let slope_v_y = q * power_y / y / half_v * dv.signum();
        let distance = |shrink: f64| {
            let level = power_x + shrink * power_y;
            let slope_v = (slope_v_x + shrink * slope_v_y) / self.aspect;
            let slope = (slope_u * slope_u + slope_v * slope_v).sqrt();
            2.0 * (level - level.sqrt()) / slope.max(1e-12)
        };
        let outline = distance(1.0);
        let plate = if dv > 0.0 && shrink < 1.0 { distance(shrink) } else { outline };
        NailPlace { outline, plate, y: y * dv.signum() }
    }

    /// What a free edge of `length` (fraction of the nail's) makes of |y|^q on the distal half: 1 without one.
    pub(super) fn free_edge(&self, length: f64) -> f64 {
        (1.0 + 2.0 * length / (1.0 - self.widest_v)).powf(-self.along[1])
    }

    /// Is (`u`, `v`) within the outline?
    pub(super) fn contains(&self, u: f64, v: f64) -> bool {
        self.level(u, v) <= 1.0
    }

    fn level(&self, u: f64, v: f64) -> f64 {
        let (du, dv) = (u - self.middle_u, v - self.widest_v);
        let x = (du / (1.0 - self.middle_u * du.signum())).abs();
        let y = (dv / (1.0 - self.widest_v * dv.signum())).abs();
        x.powf(self.exponent(du, v).0) + y.powf(self.along[usize::from(dv > 0.0)])
    }

    /// Corners `[u, v]` on the outline, in order, among them the four places where it touches its box.
    pub(in crate::phantom) fn corners(&self) -> Vec<[f64; 2]> {
        (0..CORNERS)
            .map(|k| {
                let (x, y) = match 4 * k / CORNERS * usize::from((4 * k).is_multiple_of(CORNERS)) {
                    _ if k == 0 => (1.0, 0.0),
                    1 => (0.0, 1.0),
                    2 => (-1.0, 0.0),
                    3 => (0.0, -1.0),
                    _ => {
                        let (sin, cos) = (std::f64::consts::TAU * k as f64 / CORNERS as f64).sin_cos();
                        (cos, sin)
                    }
                };
                let at = |r: f64| {
                    [
                        self.middle_u + r * x * (1.0 - self.middle_u * x.signum()),
                        self.widest_v + r * y * (1.0 - self.widest_v * y.signum()),
                    ]
                };
                if x == 0.0 || y == 0.0 {
                    return at(1.0);
                }
                let (mut inside, mut outside) = (0.5, 1.5);
                for _ in 0..60 {
                    let middle = 0.5 * (inside + outside);
                    let [u, v] = at(middle);
                    if self.level(u, v) <= 1.0 { inside = middle } else { outside = middle }
                }
                at(inside)
            })
            .collect()
    }
}
