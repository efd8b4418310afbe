//! What log is wanted.

use serde::Serialize;

use crate::nail::Positions;
use crate::phantom::motion::contacts::Contacts;
use crate::phantom::motion::force::ForceTrajectory;
use crate::phantom::motion::trajectory::Trajectory;
use crate::phantom::screen::{Clock, Jump};
use crate::phantom::sensor::{CHANNELS, DisturbanceSizes, Dynamics};

/// How rows say their time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Stamps {
    /// `time_s`: the log's clock, seconds.
    Seconds,
    /// `time_s`: seconds since 1970 began; the log's clock is the time of day.
    Epoch,
    /// `time`: dates with times of day, as 2026-03-14T09:26:53.589793.
    Datetime,
}

/// What a photodiode's volts come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum SensorModel {
    /// Formulae of each photodiode's own, after the words of section 3.3
    Formulae,
    /// The colour of the nail's zones below it, as photographs and videos of the nail show them (4.2)
    Nail,
}

/// A log to be made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LogOptions {
    /// Everything random follows from it, but for the person and the session.
    pub seed: u64,
    /// Whose finger it is.
    pub subject: u32,
    /// How the sensor sits that day.
    pub session: u32,
    /// What the volts come from.
    #[serde(skip_serializing_if = "is_formulae")]
    pub sensor: SensorModel,
    /// Where the photodiodes are, of [`SensorModel::Nail`]; none: [`Positions::thesis`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub positions: Option<Positions>,
    /// How the joints move.
    pub trajectory: Trajectory,
    /// How the fingertip presses.
    pub force: ForceTrajectory,
    /// Until then the finger bends and touches nothing, from then on it presses, straight, the force's own time 0 being
    /// there, seconds; none: it does both all along.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub touch_from_s: Option<f64>,
    /// How well the finger follows: the standard deviation of its error as a share; 0: it does exactly what is
    /// prompted, without a lag.
    #[serde(skip_serializing_if = "is_zero")]
    pub follow: f64,
    /// How far off straight it touches or rests at most, radians.
    #[serde(skip_serializing_if = "is_zero")]
    pub posture_shift_rad: f64,
    /// From the video's first frame on.
    pub seconds: f64,
    /// How long the log goes on before the video begins; less than 0: it begins later.
    pub lead_s: f64,
    /// How long it goes on after the video ends.
    pub trail_s: f64,
    /// Samples a second of the log's clock, lit and unlit ones together.
    pub rate_hz: f64,
    /// What the log's clock says at the video's time 0, seconds.
    pub clock_offset_s: f64,
    /// How much faster than the video's time it runs, millionths.
    pub clock_drift_ppm: f64,
    /// The log's clock is set: from a time of the video on, its stamps say more or less.
    pub clock_jump: Option<Jump>,
    /// How rows say their time.
    pub stamps: Stamps,
    /// Stamps err by up to so much either way, seconds.
    pub jitter_s: f64,
    /// Stamps are cut to whole steps of so many seconds; 0: not.
    pub stamp_step_s: f64,
    /// The share of rows that are lost.
    pub dropped: f64,
    /// All rows are lost from a time of the video on, for so many seconds.
    pub gaps_s: Vec<[f64; 2]>,
    /// The LED goes on and off in turn, and a column says so; otherwise it is always on.
    pub led: bool,
    /// Standard deviation of a reading, volts.
    pub noise_sd_v: f64,
    /// The ambient light's mean, volts.
    pub ambient_v: f64,
    /// How far it goes up and down, as a share.
    pub ambient_swing: f64,
    /// Of the lamps' light, hertz.
    pub hum_hz: f64,
    /// About how far photodiodes drift within the log, volts.
    pub wander_v: f64,
    /// Lags and hysteresis as shares of the sensor's.
    pub dynamics: Dynamics,
    /// What a day's wear adds.
    #[serde(skip_serializing_if = "DisturbanceSizes::is_none")]
    pub disturbances: DisturbanceSizes,
    /// The log has the columns of the force transducer.
    #[serde(skip_serializing_if = "is_true")]
    pub forces: bool,
    /// The log has a column `contact`, as of an ideal switch under the finger.
    #[serde(skip_serializing_if = "is_false")]
    pub contact: bool,
    /// P2 and P3 are amplified so much that a fifth of what they should read is over 10 V.
    pub saturate: bool,
    /// Photodiodes that read nothing, 1 for P1.
    pub dead: Vec<usize>,
}

/// Columns that are absent need no settings.
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn is_formulae(value: &SensorModel) -> bool {
    *value == SensorModel::Formulae
}

fn is_true(value: &bool) -> bool {
    *value
}

fn is_false(value: &bool) -> bool {
    !*value
}

impl LogOptions {
    /// The date of stamps: year, month, day.
    pub const DATE: (i16, i8, i8) = (2026, 3, 14);
    /// Seconds from 1970's beginning to that day's midnight (UTC).
    pub const MIDNIGHT_S: i64 = 20_526 * 86_400;

    /// What the log's clock says at the scene's time `scene_s`, without jumps, seconds.
    #[must_use]
    pub fn log_s(&self, scene_s: f64) -> f64 {
        self.clock_offset_s + (1.0 + 1e-6 * self.clock_drift_ppm) * scene_s
    }

    /// Where the photodiodes are, of [`SensorModel::Nail`].
    #[must_use]
    pub fn places(&self) -> Positions {
        self.positions.clone().unwrap_or_else(Positions::thesis)
    }

    /// The photodiodes' names, in the order of their columns.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        match &self.positions {
            Some(positions) => positions.photodiodes.iter().map(|place| place.name.clone()).collect(),
            None => (1..=CHANNELS).map(|k| format!("P{k}")).collect(),
        }
    }

    /// How many photodiodes there are, at most [`CHANNELS`].
    #[must_use]
    pub fn channels(&self) -> usize {
        self.positions.as_ref().map_or(CHANNELS, |positions| positions.photodiodes.len().min(CHANNELS))
    }

    /// The contacts that the finger makes of its own accord, if it does.
    pub(super) fn contacts(&self) -> Option<&Contacts> {
        match &self.force {
            ForceTrajectory::Contacts(contacts) => Some(contacts),
            _ => None,
        }
    }
}

impl Default for LogOptions {
    fn default() -> Self {
        let clock = Clock::default();
        Self {
            seed: 1,
            subject: 1,
            session: 1,
            sensor: SensorModel::Formulae,
            positions: None,
            trajectory: Trajectory::Eq27 { hz: 0.1 },
            force: ForceTrajectory::None,
            touch_from_s: None,
            follow: 0.0,
            posture_shift_rad: 0.0,
            seconds: 10.0,
            lead_s: 1.0,
            trail_s: 1.0,
            rate_hz: 25.0,
            clock_offset_s: clock.offset_s,
            clock_drift_ppm: clock.drift_ppm,
            clock_jump: None,
            stamps: Stamps::Seconds,
            jitter_s: 0.0,
            stamp_step_s: 0.0,
            dropped: 0.0,
            gaps_s: Vec::new(),
            led: true,
            noise_sd_v: 0.0005,
            ambient_v: 0.5,
            ambient_swing: 0.1,
            hum_hz: 100.0,
            wander_v: 0.01,
            dynamics: Dynamics::default(),
            disturbances: DisturbanceSizes::NONE,
            forces: true,
            contact: false,
            saturate: false,
            dead: Vec::new(),
        }
    }
}
