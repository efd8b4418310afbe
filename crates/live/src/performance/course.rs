//! A course and the times that operators took for it, as time per decision.

use serde::Serialize;

/// What has to be driven, and how fast that can be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Course {
    /// Length of the path, metres.
    pub path_m: f64,
    /// The machine's speed along it, metres a second.
    pub speed_mps: f64,
    /// Moves that an operator has to choose at least.
    pub decisions: u32,
}

/// A time this share short of the shortest is that time, rounded by whoever wrote it down.
const ROUNDED: f64 = 1e-9;

impl Course {
    /// The time of driving alone, seconds: no trial is shorter.
    #[must_use]
    pub fn shortest_s(&self) -> f64 {
        self.path_m / self.speed_mps
    }

    /// Time per decision of a trial that took `time_s`, seconds; none where that is shorter than driving alone.
    #[must_use]
    pub fn per_decision_s(&self, time_s: f64) -> Option<f64> {
        let over_s = time_s - self.shortest_s();
        let possible = over_s >= -ROUNDED * self.shortest_s();
        possible.then(|| over_s.max(0.0) / f64::from(self.decisions))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thesis_course_takes_57_seconds_of_driving() {
        let course = Course { path_m: 1.42, speed_mps: 0.025, decisions: 27 };
        assert!((course.shortest_s() - 56.8).abs() <= 1e-12);
        assert!((course.per_decision_s(56.8 + 27.0 * 3.25).unwrap() - 3.25).abs() <= 1e-12);
        assert_eq!(course.per_decision_s(course.shortest_s()), Some(0.0));
        assert_eq!(course.per_decision_s(56.8 - 1e-9), Some(0.0));
        assert_eq!(course.per_decision_s(56.7), None);
        assert_eq!(course.per_decision_s(f64::NAN), None);
    }
}
