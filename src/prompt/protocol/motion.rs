//! What a step prompts over its own time: a force, or how far the finger bends.

use std::f64::consts::TAU;

use lunula_predictor::{Bending, RELEASE_S, RandomBending, RandomForce, Spiral, smooth};

use crate::words::Words;

/// How long a gauge takes to come to what it holds, and to let go, seconds.
const LEAD_S: f64 = 2.0;

/// A movement of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// How long the path itself takes, seconds; letting go is added.
    pub seconds: f64,
    /// The path.
    pub path: Path,
}

/// A way through the forces, or the postures.
#[derive(Debug, Clone, PartialEq)]
pub enum Path {
    /// The finger in the air, straight.
    Rest,
    /// Equations 21 to 23.
    Spiral(Spiral),
    /// At random all over the cone.
    Random(Box<RandomForce>),
    /// One force slowly to and fro.
    Gauge(Gauge),
    /// Straight lines through `[time_s, Fx, Fy, Fz]`, newtons.
    Points(Vec<[f64; 4]>),
    /// Equation 27.
    Bending(Bending),
    /// At random within equation 27's range.
    RandomBending(RandomBending),
}

/// Which force a gauge moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GaugeAxis {
    /// Fz from 0 to -N and back, no shear.
    Normal,
    /// Fx to N, to -N and back, Fz held.
    Lateral,
    /// Fy to N, to -N and back, Fz held.
    Longitudinal,
}

impl Words for GaugeAxis {
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(Self::Normal, "normal", ""), (Self::Lateral, "lateral", ""), (Self::Longitudinal, "longitudinal", "")];
}

/// The gauges of 3.2.3 and 3.3: one force in cycles, the others held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gauge {
    /// Which.
    pub axis: GaugeAxis,
    /// How far it goes, newtons.
    pub newtons: f64,
    /// The pressing that is held under shear, newtons.
    pub held_n: f64,
    /// Cycles a second.
    pub hz: f64,
}

impl Gauge {
    /// `[Fx, Fy, Fz]`, newtons, at a time from its beginning on.
    fn forces_n(&self, t_s: f64) -> [f64; 3] {
        let phase = TAU * self.hz * t_s;
        let shear_n = self.newtons * phase.sin();
        match self.axis {
            GaugeAxis::Normal => [0.0, 0.0, -0.5 * self.newtons * (1.0 - phase.cos())],
            GaugeAxis::Lateral => [shear_n, 0.0, -self.held_n],
            GaugeAxis::Longitudinal => [0.0, shear_n, -self.held_n],
        }
    }

    fn largest_n(&self) -> f64 {
        if self.axis == GaugeAxis::Normal { self.newtons } else { self.held_n }
    }
}

/// What is prompted at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prompted {
    /// `[Fx, Fy, Fz]` of the finger on the surface, newtons, the finger straight.
    Force([f64; 3]),
    /// J2, degrees, the finger in the air.
    Bend(f64),
}

impl Motion {
    /// What is prompted at `t_s` of the step, seconds; before 0 as at 0.
    #[must_use]
    pub fn at(&self, t_s: f64) -> Prompted {
        let t_s = t_s.clamp(0.0, self.whole_s());
        match &self.path {
            Path::Rest => Prompted::Force([0.0; 3]),
            Path::Spiral(spiral) => Prompted::Force(spiral.forces_n(t_s)),
            Path::Random(random) => Prompted::Force(random.forces_n(t_s)),
            Path::Gauge(gauge) => Prompted::Force(self.gauged(gauge, t_s)),
            Path::Points(points) => Prompted::Force(between(points, t_s)),
            Path::Bending(bending) => Prompted::Bend(bending.j2_deg(t_s.min(self.seconds))),
            Path::RandomBending(random) => Prompted::Bend(random.j2_deg(t_s.min(self.seconds))),
        }
    }

    /// A gauge comes out of rest, and lets go at its end.
    fn gauged(&self, gauge: &Gauge, t_s: f64) -> [f64; 3] {
        let own_s = (t_s - self.lead_s()).clamp(0.0, self.seconds);
        let forces_n = gauge.forces_n(own_s);
        let rises = if self.lead_s() > 0.0 { smooth(t_s / self.lead_s()) } else { 1.0 };
        let left = rises * (1.0 - smooth((t_s - self.lead_s() - self.seconds) / RELEASE_S));
        forces_n.map(|force| left * force)
    }

    /// A gauge of shear has to press first.
    fn lead_s(&self) -> f64 {
        match &self.path {
            Path::Gauge(gauge) if gauge.axis != GaugeAxis::Normal => LEAD_S,
            _ => 0.0,
        }
    }

    /// How long the step takes with coming and letting go, seconds.
    #[must_use]
    pub fn whole_s(&self) -> f64 {
        let release_s = match &self.path {
            Path::Spiral(_) | Path::Random(_) | Path::Gauge(_) => RELEASE_S,
            _ => 0.0,
        };
        self.lead_s() + self.seconds + release_s
    }

    /// Whether the finger is to bend.
    #[must_use]
    pub fn bends(&self) -> bool {
        matches!(self.path, Path::Bending(_) | Path::RandomBending(_))
    }

    /// The largest pressing that is prompted, newtons; `fz_max_n` of the protocol for paths through its cone.
    #[must_use]
    pub fn largest_n(&self, fz_max_n: f64) -> f64 {
        match &self.path {
            Path::Gauge(gauge) => gauge.largest_n(),
            Path::Points(points) => points.iter().map(|point| -point[3]).fold(0.0, f64::max),
            Path::Spiral(_) | Path::Random(_) => fz_max_n,
            _ => 0.0,
        }
    }
}

/// The force at a time on the lines through points; before the first and after the last it stays there.
fn between(points: &[[f64; 4]], t_s: f64) -> [f64; 3] {
    let after = points.partition_point(|point| point[0] <= t_s);
    let at = |k: usize| points.get(k).map_or([0.0; 3], |point| [point[1], point[2], point[3]]);
    match (after.checked_sub(1), points.get(after)) {
        (None, _) => at(0),
        (Some(last), None) => at(last),
        (Some(before), Some(next)) => {
            let from_s = points.get(before).map_or(0.0, |point| point[0]);
            let part = (t_s - from_s) / (next[0] - from_s);
            let (one, two) = (at(before), at(after));
            std::array::from_fn(|k| one[k] + part * (two[k] - one[k]))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gauge(axis: GaugeAxis, newtons: f64) -> Motion {
        Motion { seconds: 100.0, path: Path::Gauge(Gauge { axis, newtons, held_n: 3.0, hz: 0.05 }) }
    }

    #[test]
    fn gauges_begin_at_rest_have_the_ranges_of_chapter_3_and_let_go() {
        for (axis, newtons, k) in
            [(GaugeAxis::Normal, 4.0, 2), (GaugeAxis::Lateral, 2.0, 0), (GaugeAxis::Longitudinal, 2.0, 1)]
        {
            let motion = gauge(axis, newtons);
            let whole_s = motion.whole_s();
            assert_eq!(whole_s, if k == 2 { 102.0 } else { 104.0 });
            let mut range = [f64::MAX, f64::MIN];
            for step in 0..=10_000 {
                let Prompted::Force(force) = motion.at(whole_s * f64::from(step) / 10_000.0) else { panic!("bends") };
                range = [range[0].min(force[k]), range[1].max(force[k])];
                assert!(force[0].hypot(force[1]) <= -0.75 * force[2] + 1e-9, "{force:?}");
            }
            let expected = if k == 2 { [-4.0, 0.0] } else { [-2.0, 2.0] };
            assert!((0..2).all(|side| (range[side] - expected[side]).abs() <= 1e-3), "{axis:?} {range:?}");
            for ends_s in [-1.0, 0.0, whole_s, whole_s + 9.0] {
                let Prompted::Force(force) = motion.at(ends_s) else { panic!("bends") };
                assert!(force.iter().all(|one| one.abs() <= 1e-9), "{axis:?} {ends_s} {force:?}");
            }
        }
    }

    #[test]
    fn points_are_joined_by_lines_and_kept_at_the_ends() {
        let points = vec![[0.0, 0.0, 0.0, 0.0], [2.0, 0.4, -0.2, -1.0], [3.0, 0.0, 0.0, 0.0]];
        let motion = Motion { seconds: 3.0, path: Path::Points(points) };
        let at = |t_s: f64| motion.at(t_s);
        assert_eq!((at(-1.0), at(9.0)), (Prompted::Force([0.0; 3]), Prompted::Force([0.0; 3])));
        assert_eq!((at(1.0), at(2.0)), (Prompted::Force([0.2, -0.1, -0.5]), Prompted::Force([0.4, -0.2, -1.0])));
        assert_eq!(motion.largest_n(3.0), 1.0);
    }
}
