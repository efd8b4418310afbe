//! Angles that leap between two neighbouring frames and are steady before and after: a video that was cut, or joined of
//! several takes. Times after a cut are not those of the film.
//!
//! In: from frame to frame the joints' angles. Out: what to say where they leap. A finger that is fast leaps in the
//! frames beside as well, and what was mistaken for a marker leaps back.
//!
//! Measured: a phantom of 20 s with 3.3 s cut out, and two takes joined, are named; none of 36 whole phantoms of 12 s
//! is (scenes clean, hard, small and fast, three seeds, regular and irregular times, random movement).

use std::collections::VecDeque;

/// A leap: so much, and so many standard errors of both angles (assumed).
const LEAP_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;
const LEAP_SDS: f64 = 10.0;
/// It is so many times what the frames beside it turn by, of which there are so many on each side.
const TIMES: f64 = 10.0;
const BESIDE: usize = 4;
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
    /// Changes from known frame to known frame, radians, each with its frame, and whether it is a leap.
    changes: VecDeque<(u64, f64, bool)>,
}

impl Cut {
    /// Takes the next frame: each joint's angle and its standard error, radians.
    pub(super) fn add(&mut self, angles: &[Option<[f64; 2]>]) {
        self.joints.resize(angles.len(), Course::default());
        for (course, angle) in self.joints.iter_mut().zip(angles) {
            let Some([rad, sd_rad]) = *angle else { continue };
            if let Some(([before_rad, before_sd_rad], frame)) = course.last.replace(([rad, sd_rad], self.frames)) {
                let by_rad = (rad - before_rad).abs();
                let gap = self.frames - frame;
                if gap > LOST {
                    course.changes.clear();
                } else {
                    let is_leap = by_rad > LEAP_RAD.max(LEAP_SDS * sd_rad.hypot(before_sd_rad));
                    course.changes.push_back((self.frames, by_rad, is_leap));
                }
            }
            if course.changes.len() > 2 * BESIDE + 1 {
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
            "angles leap by up to {:.0} degrees from one frame to the next, and are steady before and after, in {} \
             place(s), the first before frame {first}: was the video cut, or joined of several? Times after a cut are \
             not the film's; use the video that the camera made",
            most_rad.to_degrees(),
            frames.len()
        ))
    }
}

impl Course {
    /// The change in the middle, where it is a leap and those beside it are small.
    fn leap(&self) -> Option<(u64, f64)> {
        let &(frame, by_rad, is_leap) = self.changes.get(BESIDE).filter(|_| self.changes.len() > 2 * BESIDE)?;
        let beside = self.changes.iter().filter(|one| one.0 != frame).map(|one| one.1);
        (is_leap && by_rad > TIMES * beside.fold(0.0, f64::max)).then_some((frame, by_rad))
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
        // The markers are sought for some frames.
        assert!(said(|k| bends(cut(k)).filter(|_| !(90..94).contains(&k))).is_some());
        // A frame in which another thing is taken for a marker, a long loss, a flick of three frames.
        assert_eq!(said(|k| if k == 90 { Some([80.0; 2]) } else { bends(k as f64) }), None);
        assert_eq!(said(|k| bends(cut(k)).filter(|_| !(90..120).contains(&k))), None);
        let flick = |k: usize| if k < 90 { 0.0 } else { (25.0 * (k - 89) as f64).min(75.0) };
        assert_eq!(said(|k| Some([0.3 * flick(k), flick(k)])), None);
    }
}
