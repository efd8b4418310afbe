//! Angles that leap between two neighbouring frames, off their course before and after: a video that was cut, or
//! joined of several takes. Times after a cut are not those of the film.
//!
//! In: from frame to frame the joints' angles. Out: what to say where they leap off their course: by how much a change
//! differs from the median of those about it. A finger that is fast changes its course in the frames beside as well,
//! and what was mistaken for a marker leaps back. A marker that is stuck on again beside its place leaps too.
//! Where a joint was not seen for some frames its course goes on through them, and what it can have turned by in them,
//! as fast as it turns anywhere in the video, is no leap.
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
}

/// A joint's last frames.
#[derive(Debug, Clone, Default)]
struct Course {
    /// The last known angle and its standard error, and of which frame.
    last: Option<([f64; 2], u64)>,
    changes: VecDeque<Change>,
    /// How fast it turns at most, radians a frame: in two frames running, as neither a leap nor a glitch does.
    fastest_rad: f64,
    leaps: Vec<Leap>,
}

/// A joint's change from one frame in which it is known to the next.
#[derive(Debug, Clone, Copy)]
struct Change {
    /// The later frame.
    frame: u64,
    /// How many frames it is after the earlier one.
    gap: u64,
    by_rad: f64,
    /// What a leap is more than.
    least_rad: f64,
}

impl Change {
    fn rad_a_frame(&self) -> f64 {
        self.by_rad / self.gap as f64
    }
}

/// A change off its course.
#[derive(Debug, Clone, Copy)]
struct Leap {
    change: Change,
    off_rad: f64,
}

impl Cut {
    /// Takes the next frame: each joint's angle and its standard error, radians.
    pub(super) fn add(&mut self, angles: &[Option<[f64; 2]>]) {
        self.joints.resize(angles.len(), Course::default());
        for (course, angle) in self.joints.iter_mut().zip(angles) {
            if let Some(angle) = angle {
                course.add(self.frames, *angle);
            }
        }
        self.frames += 1;
    }

    /// What to say where angles leap.
    pub(super) fn doubt(&self) -> Option<String> {
        let mut leaps: Vec<Leap> = self.joints.iter().flat_map(Course::leaps).copied().collect();
        leaps.sort_unstable_by_key(|leap| leap.change.frame);
        let most_rad = leaps.iter().map(|leap| leap.off_rad).fold(0.0, f64::max);
        // Markers are found again within some frames.
        leaps.dedup_by(|leap, before| leap.change.frame - before.change.frame <= LOST);
        let Change { frame, gap, .. } = leaps.first().filter(|_| leaps.len() <= CUTS)?.change;
        let unseen = match gap {
            1 => String::new(),
            _ => format!(" (not known since frame {})", frame - gap),
        };
        Some(format!(
            "angles leap off their course by up to {:.0} degrees, in {} place(s), the first before \
             frame {frame}{unseen}: was the video cut, joined of several, or a marker stuck on again? Times after a \
             cut are not the film's, and angles by another place of a marker not those before",
            most_rad.to_degrees(),
            leaps.len()
        ))
    }
}

impl Course {
    /// Takes the next known angle and its standard error, radians.
    fn add(&mut self, frame: u64, [rad, sd_rad]: [f64; 2]) {
        let Some(([before_rad, before_sd_rad], before)) = self.last.replace(([rad, sd_rad], frame)) else { return };
        let gap = frame - before;
        if gap > LOST {
            self.changes.clear();
            return;
        }
        let least_rad = LEAP_RAD.max(LEAP_SDS * sd_rad.hypot(before_sd_rad));
        let change = Change { frame, gap, by_rad: rad - before_rad, least_rad };
        if let Some(before) = self.changes.back().filter(|before| before.gap == 1 && gap == 1)
            && before.by_rad * change.by_rad > 0.0
        {
            self.fastest_rad = self.fastest_rad.max(before.by_rad.abs().min(change.by_rad.abs()));
        }
        self.changes.push_back(change);
        if self.changes.len() > CHANGES {
            self.changes.pop_front();
        }
        self.leaps.extend(self.leap());
    }

    /// How far a change is off those about it, radians.
    fn off(&self, at: usize) -> f64 {
        let about = self.changes.range(at - ABOUT..=at + ABOUT).enumerate().filter(|(k, _)| *k != ABOUT);
        let course_rad = median_of(about.map(|(_, one)| one.rad_a_frame())).unwrap_or(0.0);
        let change = &self.changes[at];
        (change.by_rad - course_rad * change.gap as f64).abs()
    }

    /// The change in the middle, where it is a leap and those beside it are near their course.
    fn leap(&self) -> Option<Leap> {
        const MIDDLE: usize = ABOUT + BESIDE;
        let change = *self.changes.get(MIDDLE).filter(|_| self.changes.len() == CHANGES)?;
        let off_rad = Some(self.off(MIDDLE)).filter(|off_rad| *off_rad > change.least_rad)?;
        let beside = (ABOUT..CHANGES - ABOUT).filter(|&at| at != MIDDLE).map(|at| self.off(at)).fold(0.0, f64::max);
        (off_rad > TIMES * beside).then_some(Leap { change, off_rad })
    }

    /// The leaps that are more than it can have turned by in frames that don't show it.
    fn leaps(&self) -> impl Iterator<Item = &Leap> {
        self.leaps.iter().filter(|leap| {
            let unseen = (leap.change.gap - 1) as f64;
            leap.off_rad > leap.change.least_rad + unseen * self.fastest_rad
        })
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
        let sought = said(|k| bends(cut(k)).filter(|_| !(90..94).contains(&k))).expect("it was cut");
        assert!(sought.contains("the first before frame 94 (not known since frame 89)"), "{sought}");
        // A frame in which another thing is taken for a marker, a long loss, a flick of three frames.
        assert_eq!(said(|k| if k == 90 { Some([80.0; 2]) } else { bends(k as f64) }), None);
        assert_eq!(said(|k| bends(cut(k)).filter(|_| !(90..120).contains(&k))), None);
        let flick = |k: usize| if k < 90 { 0.0 } else { (25.0 * (k - 89) as f64).min(75.0) };
        assert_eq!(said(|k| Some([0.3 * flick(k), flick(k)])), None);
    }

    #[test]
    fn a_joint_that_bends_on_while_it_is_not_seen_does_not_leap() {
        let bends = |frame: f64| Some([20.0 - 15.0 * (0.05 * frame).cos(), 40.0 - 40.0 * (0.05 * frame).cos()]);
        for first in (20..180).step_by(7) {
            for frames in [2, 5, 9] {
                let hidden = |k: &usize| (first..first + frames).contains(k);
                assert_eq!(said(|k| bends(k as f64).filter(|_| !hidden(&k))), None, "{frames} from {first}");
            }
        }
        // It bends and stops meanwhile, no faster than it did before.
        let once = |k: usize, by_deg: f64| {
            let bent = if k < 126 { 40.0 - 40.0 * (0.05 * k as f64).cos() } else { 0.0 };
            let meanwhile = by_deg * (k.clamp(150, 159) - 150) as f64;
            Some([0.0, bent + meanwhile]).filter(|_| !(151..159).contains(&k))
        };
        assert_eq!(said(|k| once(k, 1.9)), None);
        assert!(said(|k| once(k, 4.0)).is_some());
    }
}
