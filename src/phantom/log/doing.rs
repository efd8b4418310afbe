//! What the finger does in a log: prompted to bend and to touch, it follows as people do.
//!
//! With [`LogOptions::touch_from_s`] it bends first and touches nothing; in the second before that time it straightens;
//! from then on it presses from rest, the force's own time 0 being there (5.2.4, 5.3.1).
//!
//! **Following** ([`LogOptions::follow`]): it lags and errs as [`Follow`] says.
//!
//! **Posture** ([`LogOptions::posture_shift_rad`], assumed): 5.4.1 takes "the finger having a slightly different
//! posture on the force measurement platform" for what changes between repetitions. While it touches, or rests, J2 is
//! off straight by a share of it from -1 to 1 that is the seed's, and J3 by two thirds of that.
//!
//! **Contacts** ([`ForceTrajectory::Contacts`](crate::phantom::motion::force::ForceTrajectory::Contacts)): a finger
//! that makes them of its own accord bends for them as well.

use std::sync::Arc;

use rand::RngExt;

use super::LogOptions;
use crate::phantom::motion::contacts::{Contact, Sequence};
use crate::phantom::motion::follow::{Follow, KIND_FOLLOW};
use crate::phantom::motion::force::{Press, Spiral};
use crate::phantom::motion::trajectory::{J3_PER_J2, Movement, Trajectory};
use crate::phantom::nail::numbers;
use crate::phantom::sensor::Touch;

/// How long a finger takes to straighten, seconds.
const STRAIGHTEN_S: f64 = 1.0;

/// Whoever prompts a finger: what it is to do at a time of the log's clock, seconds.
pub type Prompting = Arc<dyn Fn(f64) -> Touch + Send + Sync>;

/// All that a finger does, ready to be asked often.
#[derive(Clone)]
pub(in crate::phantom) struct Doing {
    movement: Movement,
    press: Press,
    contacts: Option<Sequence>,
    touch_from_s: Option<f64>,
    rests: bool,
    mu: f64,
    shift_rad: [f64; 3],
    follow: Option<Follow>,
    prompting: Option<Prompting>,
}

impl Doing {
    /// Contacts that would go on after `until_s` are left out, infinity: there are always more. Somebody may prompt the
    /// finger, in place of what the options say of its movement.
    pub(super) fn until(options: &LogOptions, until_s: f64, prompting: Option<Prompting>) -> Self {
        let usual = Spiral::default();
        Self {
            movement: options.trajectory.movement(),
            press: options.force.press(options.touch_from_s.map(|_| usual.soft_s)),
            contacts: options.contacts().map(|contacts| Sequence::new(contacts, until_s)),
            touch_from_s: options.touch_from_s,
            rests: matches!(options.trajectory, Trajectory::Rest | Trajectory::Sway { .. }),
            mu: usual.mu,
            shift_rad: shift_rad(options),
            follow: Follow::new(options.follow, options.seed),
            prompting,
        }
    }

    /// Of a log that ends.
    pub(in crate::phantom) fn new(options: &LogOptions) -> Self {
        Self::until(options, options.seconds, None)
    }

    pub(in crate::phantom) fn touch(&mut self, t_s: f64) -> Touch {
        let late_s = self.follow.as_ref().map_or(0.0, |follow| follow.late_s(t_s));
        let (mut touch, straight) = self.prompted(t_s - late_s);
        if let Some(follow) = &self.follow {
            touch.forces_n = follow.forces_n(touch.forces_n, t_s, self.mu);
            touch.angles_rad = follow.angles_rad(touch.angles_rad, t_s);
        }
        for (angle, shift) in touch.angles_rad.iter_mut().zip(self.shift_rad) {
            *angle += straight * shift;
        }
        if let Some(contact) = self.contact(t_s) {
            let bend_rad = contact.bend_rad(t_s);
            touch.forces_n = contact.forces_n(t_s);
            (0..3).for_each(|joint| touch.angles_rad[joint] += bend_rad[joint]);
        }
        touch
    }

    /// Its own contact or near miss that is under way at `t_s`.
    pub(super) fn contact(&mut self, t_s: f64) -> Option<&Contact> {
        self.contacts.as_mut()?.at(t_s)
    }

    /// What it is prompted to do, and how far it is straight for touching, from 0 to 1.
    fn prompted(&self, t_s: f64) -> (Touch, f64) {
        if let Some(prompt) = &self.prompting {
            let touch = prompt(t_s);
            let straight = if touch.angles_rad == [0.0; 3] { 1.0 } else { 0.0 };
            return (touch, straight);
        }
        let Some(from_s) = self.touch_from_s else {
            let touch = Touch { forces_n: (self.press)(t_s), angles_rad: (self.movement)(t_s) };
            return (touch, if self.rests { 1.0 } else { 0.0 });
        };
        let x = ((t_s - from_s) / STRAIGHTEN_S + 1.0).clamp(0.0, 1.0);
        let straight = x * x * (3.0 - 2.0 * x);
        let angles_rad =
            if straight < 1.0 { (self.movement)(t_s).map(|angle| (1.0 - straight) * angle) } else { [0.0; 3] };
        let forces_n = if t_s > from_s { (self.press)(t_s - from_s) } else { [0.0; 3] };
        (Touch { forces_n, angles_rad }, straight)
    }
}

/// How far the joints of a log's finger are off straight while it touches or rests.
pub(super) fn shift_rad(options: &LogOptions) -> [f64; 3] {
    if options.posture_shift_rad == 0.0 {
        return [0.0; 3];
    }
    let j2 = options.posture_shift_rad * numbers(options.seed, KIND_FOLLOW, 0).random_range(-1.0..=1.0);
    [0.0, j2, J3_PER_J2 * j2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phantom::log::Protocol;
    use crate::phantom::motion::follow::LATE_S;
    use crate::phantom::motion::wave::Wave;

    /// A protocol's log whose finger does exactly what is prompted.
    fn exact(protocol: Protocol) -> LogOptions {
        LogOptions { follow: 0.0, posture_shift_rad: 0.0, ..LogOptions::of(protocol, 1) }
    }

    #[test]
    fn the_touch_protocol_bends_for_a_minute_and_then_spirals_straight() {
        let options = exact(Protocol::Touch);
        let (mut doing, spiral) = (Doing::new(&options), Spiral::default());
        assert_eq!(options.seconds, 240.0);
        for k in 0..2400 {
            let t_s = 0.1 * f64::from(k);
            let touch = doing.touch(t_s);
            if t_s < 59.0 {
                let j2_deg = 35.0 - 40.0 * (std::f64::consts::TAU * 0.1 * t_s).cos();
                assert!(
                    (touch.angles_rad[1].to_degrees() - j2_deg).abs() <= 1e-9 && touch.forces_n == [0.0; 3],
                    "{t_s}"
                );
            }
            if t_s >= 60.0 {
                assert_eq!((touch.angles_rad, touch.forces_n), ([0.0; 3], spiral.forces_n(t_s - 60.0)), "{t_s}");
            }
        }
        assert!((doing.touch(240.0).forces_n[2] + 3.0).abs() <= 1e-9);
    }

    #[test]
    fn random_touching_begins_at_rest_after_the_bending() {
        let options = exact(Protocol::TouchRandom);
        let mut doing = Doing::new(&options);
        assert_eq!((options.seconds, options.touch_from_s), (120.0, Some(20.0)));
        let mut pressing = |t_s: f64| -doing.touch(t_s).forces_n[2];
        assert!((0..200).all(|k| pressing(0.1 * f64::from(k)) == 0.0) && pressing(20.01) < 1e-3);
        let random = options.force.press(None);
        assert_eq!(doing.touch(50.0).forces_n, random(30.0));
    }

    #[test]
    fn a_finger_follows_late_and_a_few_per_cent_off_and_never_leaves_the_cone() {
        let prompted = exact(Protocol::Touch);
        let followed = LogOptions { follow: 0.06, ..prompted.clone() };
        let (mut prompted, mut followed) = (Doing::new(&prompted), Doing::new(&followed));
        let (mut square, mut worst_late) = (0.0, 0.0f64);
        let times = (0..5000).map(|k| 80.0 + 0.03 * f64::from(k));
        for t_s in times.clone() {
            let [fx, fy, fz] = followed.touch(t_s).forces_n;
            assert!(fx.hypot(fy) <= -0.75 * fz + 1e-12, "{t_s}");
            let off = fz / prompted.touch(t_s - LATE_S).forces_n[2] - 1.0;
            square += off * off / 5000.0;
            worst_late = worst_late.max(off.abs());
        }
        // Over 150 s of a few swings the figure is not sharp; the most is the size over the wave's RMS and the lag's
        // own swing.
        assert!(
            (square.sqrt() / 0.06 - 1.0).abs() <= 0.15 && worst_late <= 0.06 / Wave::RMS + 0.01,
            "{}",
            square.sqrt()
        );
        // The lag that makes bending fit best is the one that was put in.
        let mut misfit = |late_s: f64| -> f64 {
            (0..1000)
                .map(|k| 5.0 + 0.05 * f64::from(k))
                .map(|t_s| (followed.touch(t_s).angles_rad[1] - prompted.touch(t_s - late_s).angles_rad[1]).powi(2))
                .sum()
        };
        let best = (0..=60).map(|k| 0.01 * f64::from(k)).min_by(|a, b| misfit(*a).total_cmp(&misfit(*b))).unwrap();
        assert!((best - LATE_S).abs() <= 0.1, "{best}");
    }

    #[test]
    fn a_postures_shift_is_the_seeds_and_only_while_touching() {
        let shifted = |seed: u64| {
            let options = LogOptions { follow: 0.0, ..LogOptions::of(Protocol::Touch, seed) };
            let mut doing = Doing::new(&options);
            let bending = doing.touch(10.0).angles_rad;
            assert_eq!(bending, Doing::new(&exact(Protocol::Touch)).touch(10.0).angles_rad);
            doing.touch(100.0).angles_rad
        };
        let all: Vec<f64> = (1..=20).map(|seed| shifted(seed)[1].to_degrees()).collect();
        assert!(all.iter().all(|j2| j2.abs() <= 3.0) && all.windows(2).all(|pair| pair[0] != pair[1]), "{all:?}");
        assert!(all.iter().any(|j2| *j2 > 1.0) && all.iter().any(|j2| *j2 < -1.0));
        assert_eq!(shifted(3), shifted(3));
    }
}
