//! How a finger's joints move (section 3.3.5, equation 27).
//!
//! In: the time. Out: J1, J2, J3, radians, positive in flexion. Equation 27 gives J2. Figure 33 gives J3 over J2 as a
//! drawing only, "roughly linear": [`J3_PER_J2`] is assumed here, with a small wander about the line.
//! [`Trajectory::Free`] are the six cycles of 3.3.5, [`Trajectory::Sway`] is a finger that rests as people do.

use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::sync::Arc;

use lunula_predictor::{Bending, RandomBending};
use serde::Serialize;

use crate::phantom::motion::follow::Follow;
use crate::phantom::motion::wave::random_wave;
use crate::table::{Table, TableError};

/// Slope of J3 over J2 in free bending.
pub const J3_PER_J2: f64 = 2.0 / 3.0;

const KIND_TRAJECTORY: u32 = 11;
const KIND_SWAY: u32 = 30;
/// The wander of J3 about its line, radians and hertz.
const J3_WANDER: (f64, f64) = (2.0 * PI / 180.0, 0.23);
/// J2 of free bending, fully flexed and fully extended, and the J1 that is held, degrees (3.3.5; Fig. 34 goes from -10
/// on; the rest assumed).
const FREE_DEG: [f64; 2] = [75.0, -10.0];
const J1_HELD_DEG: f64 = 15.0;
/// How far a resting finger sways, degrees: J1, J2 within seconds, J2 within minutes (assumed), and the rates of both,
/// hertz.
const SWAY_DEG: [f64; 3] = [3.0, 1.5, 2.0];
const SWAY_HZ: f64 = 0.05;
const SETTLE_HZ: f64 = 0.003;
/// Middle, half range and rate over the bending's of the slow J1.
const J1_SLOW: (f64, f64, f64) = (15.0 * PI / 180.0, 6.0 * PI / 180.0, 0.47);

/// How the joints move.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Trajectory {
    /// Equation 27: J2 = 35 - 40 cos(2 pi f t) degrees, J3 about its line, J1 slow of its own.
    Eq27 {
        /// f.
        hz: f64,
    },
    /// Free bending from fully flexed to fully extended and back: J2 from 75 to -10 degrees, J3 about its line, J1
    /// held.
    Free {
        /// How often a second.
        hz: f64,
    },
    /// What a finger does that is prompted to another movement: later, and with errors, as a log's with
    /// [`follow`](crate::phantom::log::LogOptions::follow).
    Followed {
        /// What it is prompted to.
        prompted: Box<Trajectory>,
        /// The standard deviation of its error as a share.
        share: f64,
        /// Where the random numbers come from: a log's seed.
        seed: u64,
    },
    /// Smooth and band-limited: each joint a sum of three sinusoids of random rates and phases.
    Random {
        /// Rates lie between 0.4 and 4 times this.
        hz: f64,
        /// Where the random numbers come from.
        seed: u64,
    },
    /// Random within equation 27's range, which it covers about evenly; J3 about its line, J1 slow of its own.
    Even {
        /// Rates lie between 0.4 and 4 times this.
        hz: f64,
        /// Where the random numbers come from.
        seed: u64,
    },
    /// Straight and still: all angles 0, as while touching (5.2.4).
    Rest,
    /// Straight but for what people do: J1 sways by up to 3 degrees and J2 by up to 1.5 at 0.02 to 0.2 Hz, J2 by up to
    /// 2 more at 0.0012 to 0.012 Hz, J3 by two thirds of J2 (assumed).
    Sway {
        /// Where the random numbers come from.
        seed: u64,
    },
    /// Given at times, a straight line in between.
    Given {
        /// Time in seconds, then J1, J2, J3 in degrees; times ascending.
        rows: Vec<[f64; 4]>,
    },
}

impl Trajectory {
    /// A given trajectory from a table `time_s,J1_deg,J2_deg,J3_deg`, its first row at time 0; and how long it goes on,
    /// seconds.
    ///
    /// # Errors
    /// A table that can't be read, lacks a column, a cell or rows, or whose times do not ascend.
    pub fn read(path: &Path) -> Result<(Self, f64), TableError> {
        const NAMES: [&str; 4] = ["time_s", "J1_deg", "J2_deg", "J3_deg"];
        let table = Table::read(path)?;
        let mut rows = vec![[0.0; 4]; table.rows()];
        for (column, name) in NAMES.into_iter().enumerate() {
            for (row, cell) in table.numbers(name)?.into_iter().enumerate() {
                let missing = || table.cell(row, name, "is empty; a trajectory has no gaps".to_owned());
                rows[row][column] = cell.ok_or_else(missing)?;
            }
        }
        let start_s = rows.first().map(|row| row[0]);
        let start_s =
            start_s.ok_or_else(|| TableError::Read { path: path.to_owned(), what: "has no rows".to_owned() })?;
        if let Some(before) = rows.windows(2).position(|pair| pair[1][0] <= pair[0][0]) {
            return Err(table.cell(before + 1, NAMES[0], "does not ascend; sort the rows by time".to_owned()));
        }
        rows.iter_mut().for_each(|row| row[0] -= start_s);
        let span_s = rows[rows.len() - 1][0];
        Ok((Self::Given { rows }, span_s))
    }

    /// J1, J2, J3 at `t_s`, radians; a given trajectory stays at its ends outside of its times.
    #[must_use]
    pub fn angles_rad(&self, t_s: f64) -> [f64; 3] {
        match self {
            Self::Given { rows } => given_rad(rows, t_s),
            other => other.movement()(t_s),
        }
    }

    /// What is wrong with it, with the command line's word for it, if anything.
    pub(in crate::phantom) fn fault(&self) -> Option<String> {
        match self {
            Self::Eq27 { hz } | Self::Free { hz } | Self::Random { hz, .. } | Self::Even { hz, .. } => {
                (!(0.0..=100.0).contains(hz)).then(|| format!("--bend-hz {hz}: choose 0 to 100 Hz"))
            }
            Self::Followed { prompted, share, .. } => prompted.fault().or_else(|| {
                let holds = (0.0..=0.4).contains(share);
                (!holds).then(|| format!("--follow {share}: choose 0 to 0.4, the standard deviation as a share"))
            }),
            Self::Rest | Self::Sway { .. } => None,
            Self::Given { rows } => {
                let finite = rows.iter().flatten().all(|value| value.is_finite());
                let ascend = rows.windows(2).all(|pair| pair[1][0] > pair[0][0]);
                let holds = !rows.is_empty() && finite && ascend;
                (!holds).then(|| "--trajectory: rows with ascending times and angles in each are needed".to_owned())
            }
        }
    }

    /// Ready to be asked often.
    pub(in crate::phantom) fn movement(&self) -> Movement {
        match self.clone() {
            Self::Eq27 { hz } => {
                let bending = Bending { hz };
                Arc::new(move |t_s| coupled(bending.j2_deg(t_s).to_radians(), hz, t_s))
            }
            Self::Free { hz } => Arc::new(move |t_s| {
                let [flexed, extended] = FREE_DEG;
                let j2_deg = 0.5 * (flexed + extended) + 0.5 * (flexed - extended) * (TAU * hz * t_s).cos();
                [J1_HELD_DEG.to_radians(), j2_deg.to_radians(), j3(j2_deg.to_radians(), t_s)]
            }),
            Self::Followed { prompted, share, seed } => {
                let prompted = prompted.movement();
                match Follow::new(share, seed) {
                    None => prompted,
                    Some(follow) => Arc::new(move |t_s| follow.angles_rad(prompted(t_s - follow.late_s(t_s)), t_s)),
                }
            }
            Self::Random { hz, seed } => {
                let wave = |joint: u32| random_wave(hz, 0.4..4.0, seed, KIND_TRAJECTORY, joint);
                // Of J1, J2, and J3 about its line.
                let [first, second, third] = [0, 1, 2].map(wave);
                Arc::new(move |t_s| {
                    let j2 = (40.0 + 45.0 * second.at(t_s)).to_radians();
                    let j1 = (20.0 + 25.0 * first.at(t_s)).to_radians();
                    [j1, j2, J3_PER_J2 * j2 + 5f64.to_radians() * third.at(t_s)]
                })
            }
            Self::Even { hz, seed } => {
                let bending = RandomBending::new(hz, 0.0, seed);
                Arc::new(move |t_s| coupled(bending.j2_deg(t_s).to_radians(), hz, t_s))
            }
            Self::Rest => Arc::new(|_| [0.0; 3]),
            Self::Sway { seed } => {
                let wave = |hz: f64, index: u32| random_wave(hz, 0.4..4.0, seed, KIND_SWAY, index);
                // Of J1 and J2 within seconds, of J2 within minutes.
                let (first, second, slow) = (wave(SWAY_HZ, 0), wave(SWAY_HZ, 1), wave(SETTLE_HZ, 2));
                Arc::new(move |t_s| {
                    let j2 = SWAY_DEG[1] * second.at(t_s) + SWAY_DEG[2] * slow.at(t_s);
                    [SWAY_DEG[0] * first.at(t_s), j2, J3_PER_J2 * j2].map(f64::to_radians)
                })
            }
            Self::Given { rows } => Arc::new(move |t_s| given_rad(&rows, t_s)),
        }
    }
}

/// A [`Trajectory`] that is ready to be asked often: J1, J2, J3 at a time, radians.
pub(in crate::phantom) type Movement = Arc<dyn Fn(f64) -> [f64; 3] + Send + Sync>;

/// J1, J2, J3 of a given trajectory, degrees in `rows` after the time.
fn given_rad(rows: &[[f64; 4]], t_s: f64) -> [f64; 3] {
    let after = rows.partition_point(|row| row[0] <= t_s);
    let at = |k: usize| [rows[k][1], rows[k][2], rows[k][3]];
    let degrees = match after {
        0 => at(0),
        k if k == rows.len() => at(k - 1),
        k => {
            let share = (t_s - rows[k - 1][0]) / (rows[k][0] - rows[k - 1][0]);
            let (before, next) = (at(k - 1), at(k));
            std::array::from_fn(|j| before[j] + share * (next[j] - before[j]))
        }
    };
    degrees.map(f64::to_radians)
}

/// J1, J2, J3 of bending whose J2 is given: J3 about its line, J1 slow of its own.
fn coupled(j2: f64, hz: f64, t_s: f64) -> [f64; 3] {
    let (middle, half, rate) = J1_SLOW;
    let j1 = middle + half * (TAU * rate * hz.min(0.2) * t_s + 1.0).sin();
    [j1, j2, j3(j2, t_s)]
}

/// J3 about its line.
fn j3(j2: f64, t_s: f64) -> f64 {
    let (wander, wander_hz) = J3_WANDER;
    J3_PER_J2 * j2 + wander * (TAU * wander_hz * t_s + 0.5).sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_bending_extends_and_flexes_fully_and_holds_the_knuckle() {
        let free = Trajectory::Free { hz: 0.1 };
        let at = |t_s: f64| free.angles_rad(t_s).map(f64::to_degrees);
        assert!(
            (at(0.0)[1] - 75.0).abs() < 1e-9 && (at(5.0)[1] + 10.0).abs() < 1e-9 && (at(60.0)[1] - 75.0).abs() < 1e-9
        );
        for k in 0..600 {
            let [j1, j2, j3] = at(0.1 * f64::from(k));
            assert!((j1 - 15.0).abs() < 1e-9 && (-10.0 - 1e-9..=75.0 + 1e-9).contains(&j2));
            assert!((j3 - J3_PER_J2 * j2).abs() <= 2.0 + 1e-9);
        }
    }

    #[test]
    fn random_movement_is_the_seeds_and_stays_within_its_range() {
        let one = Trajectory::Random { hz: 0.1, seed: 3 };
        let other = Trajectory::Random { hz: 0.1, seed: 4 };
        assert_ne!(one.angles_rad(1.0), other.angles_rad(1.0));
        for k in 0..2000 {
            let t_s = f64::from(k) * 0.05;
            let [j1, j2, j3] = one.angles_rad(t_s).map(f64::to_degrees);
            assert!((-5.0..=45.0).contains(&j1) && (-5.0..=85.0).contains(&j2));
            assert!((j3 - J3_PER_J2 * j2).abs() <= 5.0);
        }
    }

    #[test]
    fn a_given_movement_is_a_straight_line_between_its_times() {
        let given = Trajectory::Given { rows: vec![[0.0, 0.0, 10.0, 20.0], [2.0, 4.0, 20.0, -20.0]] };
        let degrees = |t_s| given.angles_rad(t_s).map(|angle| angle.to_degrees().round());
        assert_eq!(degrees(1.0), [2.0, 15.0, 0.0]);
        assert_eq!((degrees(-1.0), degrees(9.0)), ([0.0, 10.0, 20.0], [4.0, 20.0, -20.0]));
    }
}
