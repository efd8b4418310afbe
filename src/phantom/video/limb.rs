//! The limb's outline: tapered capsules around its bones.

/// The limb at one moment.
pub(super) struct Limb {
    pub(super) ends: [[f64; 2]; 5],
    /// Half widths at the bones' ends.
    half_widths: [f64; 5],
    /// 1 over the bones' squared lengths.
    inverse: [f64; 4],
}

impl Limb {
    pub(super) fn new(ends: [[f64; 2]; 5], half_widths: [f64; 5]) -> Self {
        let inverse = std::array::from_fn(|k| {
            let [dx, dy] = [ends[k + 1][0] - ends[k][0], ends[k + 1][1] - ends[k][1]];
            1.0 / (dx * dx + dy * dy).max(1e-12)
        });
        Self { ends, half_widths, inverse }
    }

    /// The distance of a point from the outline of the bones `within`, and where it lies across the limb: from the bone's nearest point, in
    /// units of half the width there.
    pub(super) fn nearest(&self, within: [bool; 4], [x, y]: [f64; 2]) -> (f64, [f64; 2]) {
        let mut best = (f64::INFINITY, [0.0; 2]);
        for k in (0..4).filter(|&k| within[k]) {
            let [x0, y0] = self.ends[k];
            let [dx, dy] = [self.ends[k + 1][0] - x0, self.ends[k + 1][1] - y0];
            let [px, py] = [x - x0, y - y0];
            let along = ((px * dx + py * dy) * self.inverse[k]).clamp(0.0, 1.0);
            let (ox, oy) = (px - along * dx, py - along * dy);
            let half = self.half_widths[k] + along * (self.half_widths[k + 1] - self.half_widths[k]);
            let distance = (ox * ox + oy * oy).sqrt() - half;
            if distance < best.0 {
                best = (distance, [ox / half, oy / half]);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_from_tapered_capsules() {
        let limb =
            Limb::new([[0.0, 0.0], [10.0, 0.0], [20.0, 0.0], [20.0, 10.0], [20.0, 20.0]], [4.0, 3.0, 2.0, 2.0, 1.0]);
        let (distance, across) = limb.nearest([true; 4], [5.0, -7.0]);
        assert!((distance - 3.5).abs() < 1e-12 && (across[1] + 2.0).abs() < 1e-12);
        let (distance, across) = limb.nearest([true; 4], [20.0, 20.5]);
        assert!((distance + 0.5).abs() < 1e-12 && (across[1] - 0.5).abs() < 1e-12);
        assert!((limb.nearest([true, false, false, false], [20.0, 20.0]).0 - (10f64.hypot(20.0) - 3.0)).abs() < 1e-12);
    }
}
