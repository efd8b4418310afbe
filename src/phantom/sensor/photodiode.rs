//! What each photodiode makes of forces and of bending, without hysteresis and lag; the formulae stand in [`super`].

use rand::RngExt;
use serde::Serialize;

use super::Touch;
use crate::phantom::nail::numbers;

/// How many photodiodes.
pub const CHANNELS: usize = 8;

/// People and sessions are the same whatever the scene's seed.
pub(super) const PEOPLE: u64 = 0;
const KIND_PERSON: u32 = 22;
pub(super) const KIND_SESSION: u32 = 23;

/// A photodiode on a nail, with the blood below it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Photodiode {
    /// V0: the light that comes back from the nail of a straight finger that touches nothing, less bending's part,
    /// volts.
    pub rest_v: f64,
    /// G: the amplifier's and the LED's gain, about 1.
    pub gain: f64,
    /// w: whitening by pressing, volts.
    pub whitening_v: f64,
    /// r: reddening by pressing, volts.
    pub reddening_v: f64,
    /// e: whitening that encroaches at greater pressing, volts.
    pub encroaching_v: f64,
    /// o: lateral shear, opposite to opposite sides, volts.
    pub lateral_odd_v: f64,
    /// s: lateral shear, the same to both sides, volts.
    pub lateral_even_v: f64,
    /// l: longitudinal shear, volts a newton at great Fy.
    pub longitudinal_v_per_n: f64,
    /// d: distal whitening with negative Fy, volts.
    pub distal_v: f64,
    /// c: bending, from fully extended to flat, volts.
    pub bending_v: f64,
    /// theta_flat: the J2 beyond which nothing changes, degrees.
    pub flat_deg: f64,
    /// How slowly blood leaves while the pressing grows, seconds.
    pub loading_s: f64,
    /// How slowly it comes back while the pressing falls, seconds.
    pub unloading_s: f64,
    /// How slowly it follows bending, seconds.
    pub bending_s: f64,
    /// Its share of the ambient light.
    pub ambient: f64,
    /// What it reads in the dark, volts.
    pub dark_v: f64,
}

/// The eight photodiodes of a sensor on a person's nail, P1 first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Sensor {
    /// P1 to P8.
    pub photodiodes: [Photodiode; CHANNELS],
}

/// Rest, whitening, reddening, encroaching, odd, even, longitudinal, distal, bending of the usual person.
const USUAL: [[f64; 9]; CHANNELS] = [
    [3.2, 0.50, 0.00, 0.00, 0.00, 0.00, 0.10, 0.08, 0.25],
    [3.0, 0.60, 0.00, 0.00, 0.00, 0.12, 0.14, 0.10, 0.55],
    [2.7, 0.00, 0.40, 0.22, 0.00, 0.18, 0.16, 0.00, 0.50],
    [2.6, 0.00, 0.35, 0.20, 0.00, 0.15, 0.15, 0.00, 0.30],
    [2.8, 0.20, 0.00, 0.00, -0.30, 0.00, 0.08, 0.00, 0.20],
    [2.4, 0.00, 0.20, 0.05, -0.12, 0.00, 0.07, 0.00, 0.15],
    [2.9, 0.22, 0.00, 0.00, 0.30, 0.00, 0.09, 0.00, 0.20],
    [2.5, 0.00, 0.18, 0.05, 0.12, 0.00, 0.07, 0.00, 0.15],
];
/// Loading and unloading, seconds, as measured in 4.3: over distal blood (P1, P2, P5, P7) and over proximal (the
/// others).
pub(super) const DISTAL_S: (f64, f64) = (0.18, 0.36);
pub(super) const PROXIMAL_S: (f64, f64) = (0.16, 0.12);
const DISTAL: [bool; CHANNELS] = [true, true, false, false, true, false, true, false];
/// Of bending; assumed, so short since hardly any hysteresis is seen at 0.1 Hz (Figure 34).
pub(super) const BENDING_S: f64 = 0.04;

/// How far people differ: of the logarithm of each effect, of the rest's and the lags' size.
const PERSON: (f64, f64, f64) = (0.20, 0.10, 0.15);
/// How far sessions differ: of the gain's size, of the rest's, of a person's effects.
pub(super) const SESSION: (f64, f64, f64) = (0.04, 0.03, 0.02);

impl Sensor {
    /// The sensor on the nail of person `subject` as it sits in `session`.
    #[must_use]
    pub fn new(subject: u32, session: u32) -> Self {
        let mut person = numbers(PEOPLE, KIND_PERSON, subject);
        let mut day = numbers(u64::from(subject), KIND_SESSION, session);
        let photodiodes = std::array::from_fn(|k| {
            let mut about = |size: f64| person.random_range(-size..=size);
            let [rest_v, whitening_v, reddening_v, encroaching_v, odd, even, longitudinal, distal_v, bending_v] =
                USUAL[k];
            let (loading_s, unloading_s) = if DISTAL[k] { DISTAL_S } else { PROXIMAL_S };
            let rest_v = rest_v * (1.0 + about(PERSON.1));
            let press = about(PERSON.0).exp();
            let lateral = about(PERSON.0).exp();
            let along = about(PERSON.0).exp();
            let bend = about(PERSON.0).exp();
            let lag = 1.0 + about(PERSON.2);
            let flat_deg = 27.5 + about(2.5);
            let ambient = 1.0 + about(0.3);
            let mut about = |size: f64| 1.0 + day.random_range(-size..=size);
            Photodiode {
                rest_v: rest_v * about(SESSION.1),
                gain: about(SESSION.0),
                whitening_v: whitening_v * press * about(SESSION.2),
                reddening_v: reddening_v * press,
                encroaching_v: encroaching_v * press,
                lateral_odd_v: odd * lateral * about(SESSION.2),
                lateral_even_v: even * lateral,
                longitudinal_v_per_n: longitudinal * along * about(SESSION.2),
                distal_v: distal_v * along,
                bending_v: bending_v * bend * about(SESSION.2),
                flat_deg,
                loading_s: loading_s * lag,
                unloading_s: unloading_s * lag,
                bending_s: BENDING_S * lag,
                ambient: ambient * about(SESSION.0),
                dark_v: 0.002 * about(1.0),
            }
        });
        Self { photodiodes }
    }

    /// What each photodiode adds when the LED is on, volts, without hysteresis and lag.
    #[must_use]
    pub fn static_v(&self, touch: &Touch) -> [f64; CHANNELS] {
        self.photodiodes
            .map(|one| one.rest_v + one.gain * (one.touch_v(touch.forces_n) + one.bend_v(touch.angles_rad[1])))
    }
}

impl Photodiode {
    /// n + x + y: the forces' part, volts before the gain.
    #[must_use]
    pub fn touch_v(&self, [fx_n, fy_n, fz_n]: [f64; 3]) -> f64 {
        let pressing_n = (-fz_n).max(0.0);
        let risen = |x: f64| 1.0 - (-x).exp();
        let pressed = self.whitening_v * risen(pressing_n / 1.2) - self.reddening_v * risen(pressing_n / 0.45)
            + self.encroaching_v * risen((pressing_n / 2.5).powi(2));
        let lateral = self.lateral_odd_v * (fx_n / 1.5).tanh() + self.lateral_even_v * risen((fx_n / 1.2).powi(2));
        const SOFT_N: f64 = 0.8;
        let along_n = SOFT_N * ((fy_n / SOFT_N).exp().ln_1p() - std::f64::consts::LN_2);
        let longitudinal = self.longitudinal_v_per_n * along_n + self.distal_v * risen(fy_n.min(0.0).powi(2));
        pressed + lateral + longitudinal
    }

    /// b: bending's part, volts before the gain.
    #[must_use]
    pub fn bend_v(&self, j2_rad: f64) -> f64 {
        const EXTENDED_DEG: f64 = -10.0;
        let share = ((j2_rad.to_degrees() - EXTENDED_DEG) / (self.flat_deg - EXTENDED_DEG)).clamp(0.0, 1.0);
        self.bending_v * (1.0 - share).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The static volts of P1..P8 at forces and a J2 in degrees.
    fn volts(sensor: &Sensor, forces_n: [f64; 3], j2_deg: f64) -> [f64; CHANNELS] {
        sensor.static_v(&Touch { forces_n, angles_rad: [0.0, j2_deg.to_radians(), 0.0] })
    }

    /// Every person in two sessions.
    fn all() -> impl Iterator<Item = Sensor> {
        (0..16).flat_map(|subject| [Sensor::new(subject, 0), Sensor::new(subject, 3)])
    }

    #[test]
    fn pressing_raises_1_and_2_and_lowers_3_and_4_before_they_rise_a_little() {
        for sensor in all() {
            let at: Vec<_> = (0..=40).map(|k| volts(&sensor, [0.0, 0.0, -0.1 * f64::from(k)], 0.0)).collect();
            for p in [0, 1] {
                assert!(at.windows(2).all(|pair| pair[1][p] > pair[0][p]));
            }
            for p in [2, 3] {
                let lowest = (0..at.len()).min_by(|&a, &b| at[a][p].total_cmp(&at[b][p])).unwrap();
                assert!((5..=20).contains(&lowest), "lowest at {lowest} tenths of a newton");
                let (fall, rise) = (at[0][p] - at[lowest][p], at[40][p] - at[lowest][p]);
                assert!(rise > 0.01 && rise < fall, "{fall} {rise}");
            }
        }
    }

    #[test]
    fn lateral_shear_is_seen_left_and_right_in_opposite_phase() {
        for sensor in all() {
            let at = |fx_n: f64| volts(&sensor, [fx_n, 0.0, -3.0], 0.0);
            let (left, none, right) = (at(-2.0), at(0.0), at(2.0));
            assert!(left[6] < none[6] && none[6] < right[6] && left[4] > none[4] && none[4] > right[4]);
            assert!(left[0] == none[0] && none[0] == right[0]);
            assert!([1, 2, 3].iter().all(|&p| left[p] == right[p] && right[p] > none[p]));
        }
    }

    #[test]
    fn longitudinal_shear_is_in_phase_and_more_sensitive_when_positive() {
        for sensor in all() {
            let at = |fy_n: f64| volts(&sensor, [0.0, fy_n, -3.0], 0.0);
            let (back, none, forth) = (at(-2.0), at(0.0), at(2.0));
            assert!((0..8).all(|p| forth[p] > none[p] && forth[p] - none[p] > 2.0 * (none[p] - back[p]).abs()));
            assert!([0, 1].iter().all(|&p| back[p] > none[p]) && (2..8).all(|p| back[p] < none[p]));
        }
    }

    #[test]
    fn bending_lowers_all_and_beyond_30_degrees_nothing_changes() {
        for sensor in all() {
            let at: Vec<_> = (-10..=80).map(|deg| volts(&sensor, [0.0; 3], f64::from(deg))).collect();
            for p in 0..8 {
                assert!(at[..35].windows(2).all(|pair| pair[1][p] < pair[0][p]));
                assert!(at[40..].iter().all(|v| v[p] == at[40][p]));
            }
            let sense = |p: usize| at[0][p] - at[40][p];
            assert!([0, 3, 4, 5, 6, 7].iter().all(|&p| sense(1) > sense(p) && sense(2) > sense(p)));
            let straight = Touch { forces_n: [0.0; 3], angles_rad: [0.0, 0.1, 0.0] };
            let knuckle = Touch { angles_rad: [0.7, 0.1, 0.4], ..straight };
            assert_eq!(sensor.static_v(&straight), sensor.static_v(&knuckle));
        }
    }

    #[test]
    fn people_differ_and_sessions_differ_less() {
        let (one, other) = (Sensor::new(1, 1), Sensor::new(2, 1));
        let later = Sensor::new(1, 2);
        let rest = |sensor: &Sensor| volts(sensor, [0.0; 3], 40.0);
        let moved = |a: &Sensor, b: &Sensor| (0..8).map(|p| (rest(a)[p] / rest(b)[p] - 1.0).abs()).sum::<f64>() / 8.0;
        assert!(moved(&one, &later) > 0.002 && moved(&one, &later) < 0.03 && moved(&one, &other) > moved(&one, &later));
        assert_eq!(one, Sensor::new(1, 1));
    }
}
