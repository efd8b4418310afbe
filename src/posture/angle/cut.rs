//! Angles that leap between two neighbouring frames, off their course before and after: a video that was cut, or
//! joined of several takes. Times after a cut are not those of the film.
//!
//! In: from frame to frame the joints' angles. Out: what to say where they leap off their course: by how much a change
//! differs from the median of those about it. A finger that is fast changes its course in the frames beside as well,
//! and what was mistaken for a marker leaps back. A marker that is stuck on again beside its place leaps too.
//!
//! Measured: a phantom of 20 s with 3.3 s cut out, and two takes joined, are named; none of 36 whole phantoms of 12 s
//! is (scenes clean, hard, small and fast, three seeds, regular and irregular times, random movement). A third of a
//! second cut out of slow bending leaps by 6.6 degrees, a marker stuck on 5 pixels beside by 4.8; frames that are
//! doubled or left out, one a second, by 3.7 at most.

use std::collections::VecDeque;

use crate::median::median_of;

/// A leap off the course: so much, and so many standard errors of both angles (assumed).
const LEAP_RAD: f64 = 4.0 * std::f64::consts::PI / 180.0;
const LEAP_SDS: f64 = 10.0;
/// The course is the median of so many changes on each side.
const ABOUT: usize = 3;
/// A leap is so many times what the frames beside it are off the course, of which there are so many on each side.
const TIMES: f64 = 10.0;
const BESIDE: usize = 4;
/// Changes that are looked at together.
const CHANGES: usize = 2 * (ABOUT + BESIDE) + 1;
/// A video with more of them shows a finger that is fast for its rate of pictures, or hidden by its own streak.
const CUTS: usize = 3;
/// A joint that is lost for so many frames after a leap, as markers are sought, may be compared with where it was.
const LOST: u64 = 10;

/// What the frames of a video say.
#[derive(Debug, Clone, Default)]
pub(super) struct Cut {
    joints: Vec<Course>,
    frames: u64,
    /// Of each leap: the frame, by how much, radians.
    leaps: Vec<(u64, f64)>,
}

/// A joint's last frames.
#[derive(Debug, Clone, Default)]
struct Course {
    /// The last known angle and its standard error, and of which frame.
    last: Option<([f64; 2], u64)>,
    /// Changes from known frame to known frame, radians, each with its frame, and what a leap is more than.
    changes: VecDeque<(u64, f64, f64)>,
}

impl Cut {
    /// Takes the next frame: each joint's angle and its standard error, radians.
    pub(super) fn add(&mut self, angles: &[Option<[f64; 2]>]) {
        self.joints.resize(angles.len(), Course::default());
        for (course, angle) in self.joints.iter_mut().zip(angles) {
            let Some([rad, sd_rad]) = *angle else { continue };
            if let Some(([before_rad, before_sd_rad], frame)) = course.last.replace(([rad, sd_rad], self.frames)) {
                let gap = self.frames - frame;
                if gap > LOST {
                    course.changes.clear();
                } else {
                    let least_rad = LEAP_RAD.max(LEAP_SDS * sd_rad.hypot(before_sd_rad));
                    course.changes.push_back((self.frames, rad - before_rad, least_rad));
                }
            }
            if course.changes.len() > CHANGES {
                course.changes.pop_front();
            }
            if let Some((frame, by_rad)) = course.leap() {
                self.leaps.push((frame, by_rad));
            }
        }
        self.frames += 1;
    }

    /// What to say where angles leap.
    pub(super) fn doubt(&self) -> Option<String> {
        let mut frames: Vec<u64> = self.leaps.iter().map(|(frame, _)| *frame).collect();
        frames.sort_unstable();
        // Markers are found again within some frames.
        frames.dedup_by(|frame, before| *frame - *before <= LOST);
        let first = *frames.first().filter(|_| frames.len() <= CUTS)?;
        let most_rad = self.leaps.iter().map(|(_, by_rad)| *by_rad).fold(0.0, f64::max);
        Some(format!(
            "angles leap by up to {:.0} degrees from one frame to the next, in {} place(s), the first before frame \
             {first}: was the video cut, joined of several, or a marker stuck on again? Times after a cut are not the \
             film's, and angles by another place of a marker not those before",
            most_rad.to_degrees(),
            frames.len()
        ))
    }
}

impl Course {
    /// How far a change is off those about it, radians.
    fn off(&self, at: usize) -> f64 {
        let about = self.changes.range(at - ABOUT..=at + ABOUT).enumerate().filter(|(k, _)| *k != ABOUT);
        let course_rad = median_of(about.map(|(_, one)| one.1)).unwrap_or(0.0);
        (self.changes[at].1 - course_rad).abs()
    }

    /// The change in the middle, where it is a leap and those beside it are near their course.
    fn leap(&self) -> Option<(u64, f64)> {
        const MIDDLE: usize = ABOUT + BESIDE;
        let &(frame, _, least_rad) = self.changes.get(MIDDLE).filter(|_| self.changes.len() == CHANGES)?;
        let by_rad = Some(self.off(MIDDLE)).filter(|by_rad| *by_rad > least_rad)?;
        let beside = (ABOUT..CHANGES - ABOUT).filter(|&at| at != MIDDLE).map(|at| self.off(at)).fold(0.0, f64::max);
        (by_rad > TIMES * beside).then_some((frame, by_rad))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of angles of two joints, degrees.
    fn said(of: impl Fn(usize) -> Option<[f64; 2]>) -> Option<String> {
        let mut cut = Cut::default();
        for frame in 0..200 {
            let angles = of(frame).map(|both| both.map(|deg: f64| Some([deg.to_radians(), 0.004])));
            cut.add(&angles.unwrap_or([None; 2]));
        }
        cut.doubt()
    }

    #[test]
    fn a_cut_is_seen_and_fast_fingers_and_glitches_are_not() {
        let bends = |frame: f64| Some([20.0 - 15.0 * (0.05 * frame).cos(), 40.0 - 40.0 * (0.05 * frame).cos()]);
        assert_eq!(said(|k| bends(k as f64)), None);
        let cut = |k: usize| if k < 90 { k as f64 } else { k as f64 + 40.0 };
        let leaps = said(|k| bends(cut(k))).expect("it was cut");
        assert!(leaps.contains("in 1 place(s), the first before frame 90"), "{leaps}");
        // A marker that is stuck on again beside its place while the finger bends, and frames that are doubled.
        let moved =
            |k: usize| bends(k as f64).map(|[one, other]| if k < 90 { [one, other] } else { [one, other + 5.0] });
        assert!(said(moved).is_some());
        assert_eq!(said(|k| bends((k - k / 25) as f64)), None);
        // The markers are sought for some frames.
        assert!(said(|k| bends(cut(k)).filter(|_| !(90..94).contains(&k))).is_some());
        // A frame in which another thing is taken for a marker, a long loss, a flick of three frames.
        assert_eq!(said(|k| if k == 90 { Some([80.0; 2]) } else { bends(k as f64) }), None);
        assert_eq!(said(|k| bends(cut(k)).filter(|_| !(90..120).contains(&k))), None);
        let flick = |k: usize| if k < 90 { 0.0 } else { (25.0 * (k - 89) as f64).min(75.0) };
        assert_eq!(said(|k| Some([0.3 * flick(k), flick(k)])), None);
    }
}
