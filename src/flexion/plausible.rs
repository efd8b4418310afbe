//! Whether a finger can have the angles that a video gave.
//!
//! In: each frame's angles; out: how often they were out of a joint's range, and a warning with its likely cause.
//! Nothing is changed or left out: a reversed `flexion` or a mirrored video negates every angle and looks well
//! otherwise.
//!
//! Ranges are the norms of the American Academy of Orthopaedic Surgeons (Joint Motion: Method of Measuring and
//! Recording, 1965) for the fingers: MP -45 to 90 degrees, PIP 0 to 100, DIP 0 to 90, wider by a margin (assumed) for
//! fingers more supple than most, for markers that lie beside the bone and, at the DIP, for a fingertip bent back while
//! it presses. Joints of other names may be any finger's, thumb's or wrist's: they are only held to half a turn.

use super::Flexion;

/// Degrees added to the norms on both sides (assumed); at the DIP's lower end, where pressing bends the fingertip back.
const MARGIN_DEG: f64 = 20.0;
const PRESSED_DIP_DEG: f64 = 30.0;
/// A recording is doubted where this share of its frames has an angle out of range (assumed) ...
const MOST: f64 = 0.2;
/// ... or this share, where hardly any would be with all angles negated.
const SOME: f64 = 0.1;
const HARDLY_ANY: f64 = 0.02;

/// No joint of a finger bends further.
const HALF_TURN_DEG: f64 = 180.0;
/// Angles that never reach this, and reach half a radian, may be radians.
const RADIANS: f64 = std::f64::consts::PI;

/// What to doubt of a table's angles, degrees, of each of the joints; NaN is missing.
pub(crate) fn doubts(joints: &[String], angles_deg: &[&[f64]]) -> Vec<String> {
    let mut doubts = Vec::new();
    let known = angles_deg.iter().copied().flatten().filter(|degrees| degrees.is_finite());
    let most_deg = known.map(|degrees| degrees.abs()).fold(0.0, f64::max);
    if (0.5..RADIANS).contains(&most_deg) {
        doubts.push(format!(
            "no angle is further from 0 than {most_deg:.2} degrees; if these are radians, write degrees"
        ));
    }
    for (joint, angles) in joints.iter().zip(angles_deg) {
        let beyond = || angles.iter().filter(|degrees| degrees.abs() > HALF_TURN_DEG);
        if let Some(first) = beyond().next() {
            let count = beyond().count();
            doubts.push(format!(
                "{joint} is {first} degrees in the first of {count} row(s) beyond half a turn; leave a cell empty \
                 where an angle is missing"
            ));
        }
    }
    let mut plausibility = Plausibility::new(joints.iter());
    for row in 0..angles_deg.first().map_or(0, |angles| angles.len()) {
        plausibility.add(angles_deg.iter().map(|angles| Some(angles[row]).filter(|degrees| degrees.is_finite())));
    }
    doubts.extend(plausibility.warning(None));
    doubts
}

/// The degrees of flexion that a joint of this name can have.
fn range_deg(joint: &str) -> [f64; 2] {
    match joint {
        "J1" => [-45.0 - MARGIN_DEG, 90.0 + MARGIN_DEG],
        "J2" => [0.0 - MARGIN_DEG, 100.0 + MARGIN_DEG],
        "J3" => [0.0 - PRESSED_DIP_DEG, 90.0 + MARGIN_DEG],
        _ => [-HALF_TURN_DEG, HALF_TURN_DEG],
    }
}

/// Counts angles that a finger can't have.
#[derive(Debug, Clone)]
pub(crate) struct Plausibility {
    joints: Vec<Counts>,
    /// Frames with an angle of any joint, with one out of range, and with one that would be so if it were negated.
    frames: u64,
    outside: u64,
    outside_negated: u64,
}

#[derive(Debug, Clone)]
struct Counts {
    name: String,
    range_deg: [f64; 2],
    frames: u64,
    outside: u64,
}

impl Plausibility {
    pub(crate) fn new<'a>(joints: impl Iterator<Item = &'a String>) -> Self {
        let counts = |name: &String| Counts { name: name.clone(), range_deg: range_deg(name), frames: 0, outside: 0 };
        Self { joints: joints.map(counts).collect(), frames: 0, outside: 0, outside_negated: 0 }
    }

    /// Takes in a frame: degrees for each of the joints.
    pub(crate) fn add(&mut self, angles_deg: impl Iterator<Item = Option<f64>>) {
        let (mut any, mut outside, mut negated) = (false, false, false);
        for (joint, degrees) in self.joints.iter_mut().zip(angles_deg) {
            let Some(degrees) = degrees else { continue };
            let [least, most] = joint.range_deg;
            let is_outside = |degrees: f64| degrees < least || degrees > most;
            any = true;
            joint.frames += 1;
            joint.outside += u64::from(is_outside(degrees));
            outside |= is_outside(degrees);
            negated |= is_outside(-degrees);
        }
        self.frames += u64::from(any);
        self.outside += u64::from(outside);
        self.outside_negated += u64::from(negated);
    }

    /// For each joint, how many of its angles are out of its range.
    pub(crate) fn outside(&self, joint: usize) -> u64 {
        self.joints[joint].outside
    }

    /// What to doubt, where a finger can't have had these angles; `flexion` is the marker file's, where there is one.
    pub(crate) fn warning(&self, flexion: Option<Flexion>) -> Option<String> {
        let share = |count: u64| count as f64 / self.frames.max(1) as f64;
        let negated_fit = share(self.outside_negated) <= HARDLY_ANY.max(0.2 * share(self.outside));
        let doubted =
            share(self.outside) > MOST || (share(self.outside) >= SOME && share(self.outside_negated) <= HARDLY_ANY);
        if !doubted {
            return None;
        }
        let joints = self.joints.iter().filter(|joint| joint.outside > 0).map(|joint| {
            let [least, most] = joint.range_deg;
            let percent = 100.0 * joint.outside as f64 / joint.frames as f64;
            format!("{} is outside of {least:.0} to {most:.0} degrees in {percent:.0} % of its frames", joint.name)
        });
        let joints: Vec<String> = joints.collect();
        let cause = match flexion {
            Some(flexion) if negated_fit => {
                let other_flexion = match flexion {
                    Flexion::Clockwise => Flexion::Counterclockwise.name(),
                    Flexion::Counterclockwise => Flexion::Clockwise.name(),
                };
                format!(
                    "negated, all would be possible: `flexion` is reversed (write flexion = \"{other_flexion}\"), the \
                     video is mirrored, or segments and joints are listed with the distal one first"
                )
            }
            Some(_) => {
                "check the order of the markers in [segments] and of the segments in [joints] (proximal first), \
                        whether the markers have the right names (--overlay shows them), and [zero]"
                    .to_owned()
            }
            None if negated_fit => "negated, all would be possible: flexion is positive here".to_owned(),
            None => "check that these are the joints' own angles, flexion positive and 0 where the finger is straight"
                .to_owned(),
        };
        Some(format!("angles that a finger can't have: {} (AAOS norms and a margin); {cause}", joints.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The warning of frames with these angles, degrees.
    fn warning(names: &[&str], frames: impl Iterator<Item = Vec<f64>>) -> Option<String> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let mut plausibility = Plausibility::new(names.iter());
        frames.for_each(|degrees| plausibility.add(degrees.into_iter().map(Some)));
        plausibility.warning(Some(Flexion::Clockwise))
    }

    /// Equation 27 over one period, times `sign`.
    fn bending(sign: f64) -> impl Iterator<Item = Vec<f64>> {
        (0..100).map(move |k| {
            let j2 = 35.0 - 40.0 * (std::f64::consts::TAU * f64::from(k) / 100.0).cos();
            vec![sign * 15.0, sign * j2, sign * j2 * 2.0 / 3.0]
        })
    }

    #[test]
    fn a_finger_that_bends_backwards_is_doubted_and_flexion_named() {
        assert_eq!(warning(&["J1", "J2", "J3"], bending(1.0)), None);
        let warned = warning(&["J1", "J2", "J3"], bending(-1.0)).expect("a warning");
        assert!(warned.contains("J2") && warned.contains("flexion = \"counterclockwise\""), "{warned}");
        assert!(!warned.contains("J1 is"), "15 degrees of extension are possible at the MP: {warned}");
    }

    #[test]
    fn a_segment_the_wrong_way_round_is_no_matter_of_flexion() {
        let turned = bending(1.0).map(|angles| vec![angles[0], angles[1] + 180.0]);
        let warned = warning(&["J1", "J2"], turned).expect("a warning");
        assert!(warned.contains("order of the markers") && !warned.contains("flexion ="), "{warned}");
    }

    #[test]
    fn other_joints_and_few_frames_are_left_alone() {
        assert_eq!(warning(&["thumb"], bending(-1.0).map(|angles| vec![angles[1]])), None);
        let few = (0..100).map(|k| vec![if k < 5 { -60.0 } else { 30.0 }]);
        assert_eq!(warning(&["J2"], few), None);
        assert_eq!(warning(&["J2"], std::iter::empty()), None);
        // A hand that is turned over for a third of the time.
        let turned = bending(1.0).chain(bending(1.0)).chain(bending(-1.0));
        let warned = warning(&["J1", "J2", "J3"], turned).expect("a warning");
        assert!(warned.contains("right names"), "{warned}");
    }
}
