//! The limb's outline: tapered capsules around its bones.

/// The limb at one moment.
#[derive(Debug)]
pub(in crate::phantom::video) struct Limb {
    pub(in crate::phantom::video) bones: Vec<Bone>,
}

/// A capsule.
#[derive(Debug)]
pub(in crate::phantom::video) struct Bone {
    pub(in crate::phantom::video) ends: [[f64; 2]; 2],
    pub(in crate::phantom::video) half_widths: [f64; 2],
    /// 1 over its squared length.
    inverse: f64,
}

impl Limb {
    /// Bones between two each of these points, at which the limb is so wide.
    pub(in crate::phantom::video) fn new(points: &[[f64; 2]], half_widths: &[f64], bones: &[[usize; 2]]) -> Self {
        let bone = |&bone: &[usize; 2]| {
            let [from, to] = bone.map(|point| points[point]);
            let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
            let inverse = 1.0 / (dx * dx + dy * dy).max(1e-12);
            Bone { ends: [from, to], half_widths: bone.map(|point| half_widths[point]), inverse }
        };
        Self { bones: bones.iter().map(bone).collect() }
    }

    /// The distance of a point from the outline of the bones `within`, and where it lies across the limb: from the
    /// bone's nearest point, in units of half the width there.
    pub(in crate::phantom::video) fn nearest(&self, within: &[bool], [x, y]: [f64; 2]) -> (f64, [f64; 2]) {
        let mut best = (f64::INFINITY, [0.0; 2]);
        for bone in self.bones.iter().zip(within).filter_map(|(bone, within)| within.then_some(bone)) {
            let [[x0, y0], [x1, y1]] = bone.ends;
            let [dx, dy] = [x1 - x0, y1 - y0];
            let [px, py] = [x - x0, y - y0];
            let along = ((px * dx + py * dy) * bone.inverse).clamp(0.0, 1.0);
            let (ox, oy) = (px - along * dx, py - along * dy);
            let half = bone.half_widths[0] + along * (bone.half_widths[1] - bone.half_widths[0]);
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
        let points = [[0.0, 0.0], [10.0, 0.0], [20.0, 0.0], [20.0, 10.0], [20.0, 20.0]];
        let limb = Limb::new(&points, &[4.0, 3.0, 2.0, 2.0, 1.0], &[[0, 1], [1, 2], [2, 3], [3, 4]]);
        let (distance, across) = limb.nearest(&[true; 4], [5.0, -7.0]);
        assert!((distance - 3.5).abs() < 1e-12 && (across[1] + 2.0).abs() < 1e-12);
        let (distance, across) = limb.nearest(&[true; 4], [20.0, 20.5]);
        assert!((distance + 0.5).abs() < 1e-12 && (across[1] - 0.5).abs() < 1e-12);
        assert!((limb.nearest(&[true, false, false, false], [20.0, 20.0]).0 - (10f64.hypot(20.0) - 3.0)).abs() < 1e-12);
    }
}
