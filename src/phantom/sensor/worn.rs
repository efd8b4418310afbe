//! A sensor whose photodiodes see the nail's own colour, in place of formulae of their own.
//!
//! In: a person, a session and [`Positions`]. Out: volts at each moment, 7 V times the encoded green of the disc below
//! each photodiode in the thesis' chamber's light, times gains of the LED's and the amplifier's (4 % from session to
//! session, as the formulae's). A nail at rest is then at 2.5 to 3.1 V and full blanching adds 0.4 to 0.7 V, as in the
//! formulae.
//!
//! **Put in**: zones by pose (4.2.3 to 4.2.6), saturations and lags, the places of photodiodes, the volts of full
//! scale. **Follows**: what each photodiode does when the finger presses, shears or bends. Where that is not what
//! section 3.3 says of the photodiode, `docs/src/jobs/phantom.md` lists it.

use rand::RngExt;

use super::photodiode::{KIND_SESSION, PEOPLE, SESSION};
use super::{CHANNELS, Discs, Touch};
use crate::nail::Positions;
use crate::phantom::nail::{Blood, Camera, ColourWeights, Light, NailScene, Pose, Subject, numbers};

/// Volts of a photodiode below which everything is of full scale's green (assumed).
const FULL_SCALE_V: f64 = 7.0;
/// Sessions of this sensor have other numbers than those of the formulae.
const OWN: u32 = 1 << 31;
/// The nail's width where its texture is seen as finely as a photodiode's disc needs, pixels.
const NAIL_PX: f64 = 400.0;

/// Whose fingertip `subject` is, the same in logs, videos and whatever the seed.
#[must_use]
pub fn person(subject: u32) -> Subject {
    Subject::random(PEOPLE, subject).with_specks()
}

/// A sensor on a person's nail.
#[derive(Debug, Clone)]
pub struct WornSensor {
    subject: Subject,
    discs: Discs,
    gains: Vec<f64>,
}

impl WornSensor {
    /// The sensor on the nail of person `subject` as it sits in `session`; of more than [`CHANNELS`] photodiodes it
    /// reads the first.
    #[must_use]
    pub fn new(subject: u32, session: u32, positions: &Positions) -> Self {
        let mut rng = numbers(u64::from(subject), KIND_SESSION, session | OWN);
        let mut gain = || FULL_SCALE_V * (1.0 + SESSION.0 * rng.random_range(-1.0..=1.0));
        let gains = positions.photodiodes.iter().map(|_| gain()).collect();
        let side = (4.0 * NAIL_PX) as u32;
        let camera = Camera::upright([side; 2], [0.5 * f64::from(side); 2], NAIL_PX);
        let light = Light { gradient: [0.0; 2], ..Light::chamber() };
        let subject = person(subject);
        let scene = NailScene { subject: subject.clone(), pose: Pose::Nominal, light, camera };
        Self { subject, discs: Discs::new(&scene, positions), gains }
    }

    /// What each photodiode adds at a moment when the LED is on, volts; 0 where there is no photodiode.
    #[must_use]
    pub fn volts(&self, weights: &ColourWeights) -> [f64; CHANNELS] {
        let mut volts = [0.0; CHANNELS];
        let seen = self.discs.colours(weights);
        for ((volts, [_, green, _]), gain) in volts.iter_mut().zip(seen).zip(&self.gains) {
            *volts = gain * green;
        }
        volts
    }

    /// The same for what the finger does, without hysteresis and lag.
    #[must_use]
    pub fn static_v(&self, touch: &Touch) -> [f64; CHANNELS] {
        self.volts(&ColourWeights::resting(&self.subject, touch.forces_n, touch.angles_rad))
    }

    /// The blood below the nail, whose colour follows.
    pub(in crate::phantom) fn blood(&self) -> Blood {
        Blood::of(&self.subject)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The static volts of P1..P8 at forces and a J2 in degrees.
    fn volts(sensor: &WornSensor, forces_n: [f64; 3], j2_deg: f64) -> [f64; CHANNELS] {
        sensor.static_v(&Touch { forces_n, angles_rad: [0.0, j2_deg.to_radians(), 0.0] })
    }

    fn all() -> Vec<WornSensor> {
        (0..16).map(|subject| WornSensor::new(subject, 1, &Positions::thesis())).collect()
    }

    const P1: usize = 0;
    const P2: usize = 1;
    const P3: usize = 2;
    const P4: usize = 3;
    const P5: usize = 4;
    const P6: usize = 5;
    const P7: usize = 6;
    const P8: usize = 7;

    #[test]
    fn pressing_raises_1_5_and_7_and_lowers_3_and_4_before_they_rise_a_little() {
        for sensor in all() {
            let at: Vec<_> = (0..=40).map(|k| volts(&sensor, [0.0, 0.0, -0.1 * f64::from(k)], 0.0)).collect();
            assert!([P1, P5, P7].iter().all(|&p| at.windows(2).all(|pair| pair[1][p] > pair[0][p])));
            for p in [P3, P4] {
                let lowest = (0..at.len()).min_by(|&a, &b| at[a][p].total_cmp(&at[b][p])).unwrap();
                assert!((5..=25).contains(&lowest), "lowest at {lowest} tenths of a newton");
                let (fall, rise) = (at[0][p] - at[lowest][p], at[40][p] - at[lowest][p]);
                assert!(rise > 0.02 && rise < 0.5 * fall, "{fall} {rise}");
            }
        }
    }

    #[test]
    fn lateral_shear_is_seen_left_and_right_in_opposite_phase_and_alike_over_the_bone() {
        for sensor in all() {
            let at = |fx_n: f64| volts(&sensor, [fx_n, 0.0, -3.0], 0.0);
            let (left, none, right) = (at(-2.0), at(0.0), at(2.0));
            assert!(right[P7] - left[P7] > 0.2 && left[P5] - right[P5] > 0.2);
            assert!([P3, P4].iter().all(|&p| left[p] - none[p] > 0.1 && right[p] - none[p] > 0.1));
        }
    }

    #[test]
    fn longitudinal_shear_raises_3_and_4_when_positive_and_changes_little_when_negative() {
        for sensor in all() {
            let at = |fy_n: f64| volts(&sensor, [0.0, fy_n, -3.0], 0.0);
            let (back, none, forth) = (at(-2.0), at(0.0), at(2.0));
            assert!([P3, P4].iter().all(|&p| forth[p] - none[p] > 3.0 * (none[p] - back[p]).abs()));
            assert!(back[P1] > none[P1] && back[P2] > none[P2] - 0.02);
        }
    }

    #[test]
    fn bending_lowers_2_to_8_most_over_the_bone_and_beyond_30_degrees_nothing_changes() {
        for sensor in all() {
            let at: Vec<_> = (-10..=80).map(|deg| volts(&sensor, [0.0; 3], f64::from(deg))).collect();
            for p in P1..=P8 {
                assert!(at[40..].iter().all(|v| v[p] == at[40][p]));
                assert!(p == P1 || at[10][p] - at[40][p] > 0.3, "P{}", p + 1);
            }
            let sense = |p: usize| at[0][p] - at[40][p];
            assert!([P1, P5, P6, P7, P8].iter().all(|&p| sense(P2) > sense(p) && sense(P3) > sense(p)));
        }
    }

    #[test]
    fn what_section_3_3_says_and_the_zones_do_not_do() {
        // These are listed in docs/src/jobs/phantom.md.
        for sensor in all() {
            let pressed = |n: f64| volts(&sensor, [0.0, 0.0, -n], 0.0);
            assert!(pressed(3.0)[P2] < pressed(0.0)[P2], "3.3.2: P2 rises with pressing");
            let sheared = |fx_n: f64, fy_n: f64| volts(&sensor, [fx_n, fy_n, -3.0], 0.0);
            assert!(sheared(0.0, 0.0)[P1] - sheared(2.0, 0.0)[P1] > 0.2, "3.3.3: P1 stays relatively constant");
            assert!(
                [P1, P5, P7].iter().all(|&p| sheared(0.0, 2.0)[p] < sheared(0.0, 0.0)[p]),
                "3.3.4: all in phase with Fy"
            );
            let bent = |deg: f64| volts(&sensor, [0.0; 3], deg);
            assert!(bent(-10.0)[P1] < bent(0.0)[P1], "3.3.5: P1 rises with extension");
        }
    }
}
