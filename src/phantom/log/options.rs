//! What log is wanted.

use clap::{ArgAction, Args};
use serde::Serialize;

use crate::job;
use crate::nail::Positions;
use crate::phantom::motion::contacts::Contacts;
use crate::phantom::motion::force::ForceTrajectory;
use crate::phantom::motion::trajectory::Trajectory;
use crate::phantom::request::{parse_gap, parse_percent, parse_set_clock};
use crate::phantom::scene::place::is_default;
use crate::phantom::screen::Jump;
use crate::phantom::sensor::{Ambient, CHANNELS, DisturbanceSizes, Disturbances, Dynamics, Wander};

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
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum SensorModel {
    /// Formulae of each photodiode's own, after the words of section 3.3
    #[default]
    Formulae,
    /// The colour of the nail's zones below it, as photographs and videos of the nail show them (4.2)
    Nail,
}

/// A log to be made: what the command line gives as it is, and what [`LogRequest`](crate::phantom::request::LogRequest)
/// makes of the rest.
#[derive(Debug, Clone, PartialEq, Args, Serialize)]
pub struct LogOptions {
    /// Everything random follows from it, but for the person and the session.
    #[arg(skip = 1_u64)]
    pub seed: u64,
    /// Whose finger it is.
    #[arg(skip = 1_u32)]
    pub subject: u32,
    /// How the sensor sits that day.
    #[arg(skip = 1_u32)]
    pub session: u32,
    /// What the volts come from.
    #[arg(skip = SensorModel::Formulae)]
    #[serde(skip_serializing_if = "is_default")]
    pub sensor: SensorModel,
    /// Where the photodiodes are, of [`SensorModel::Nail`]; none: [`Positions::thesis`].
    #[arg(skip)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub positions: Option<Positions>,
    /// How the joints move.
    #[arg(skip = Trajectory::Eq27 { hz: 0.1 })]
    pub trajectory: Trajectory,
    /// How the fingertip presses.
    #[arg(skip = ForceTrajectory::None)]
    pub force: ForceTrajectory,
    /// Until then the finger bends and touches nothing, from then on it presses, straight, the force's own time 0 being
    /// there, seconds; none: it does both all along.
    #[arg(skip)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub touch_from_s: Option<f64>,
    /// How well the finger follows: the standard deviation of its error as a share; 0: it does exactly what is
    /// prompted, without a lag.
    #[arg(skip)]
    #[serde(skip_serializing_if = "is_default")]
    pub follow: f64,
    /// How far off straight it touches or rests at most, radians.
    #[arg(skip)]
    #[serde(skip_serializing_if = "is_default")]
    pub posture_shift_rad: f64,
    /// From the video's first frame on.
    #[arg(skip = 10.0)]
    pub seconds: f64,
    /// The log begins so long before the video
    #[arg(long = "lead", value_name = "SECONDS", default_value_t = 1.0, allow_negative_numbers = true)]
    pub lead_s: f64,
    /// It goes on so long after the video
    #[arg(long = "trail", value_name = "SECONDS", default_value_t = 1.0, allow_negative_numbers = true)]
    pub trail_s: f64,
    /// Samples a second, lit and unlit ones together
    #[arg(long = "rate", value_name = "HZ", default_value_t = 25.0)]
    pub rate_hz: f64,
    /// What the log's clock says at the video's first frame; as the video's --clock-offset
    #[arg(long = "clock-offset", value_name = "SECONDS", default_value_t = 60.0, allow_negative_numbers = true)]
    pub clock_offset_s: f64,
    /// How much faster than the video's time the log's clock runs, millionths; as the video's
    #[arg(long, value_name = "PPM", default_value_t = 0.0, allow_negative_numbers = true)]
    pub clock_drift_ppm: f64,
    /// The log's clock is set so many seconds forward at this time of the video, as 5+3.5 or 5-3.5
    #[arg(long, value_name = "TIME+SECONDS", value_parser = parse_set_clock)]
    pub clock_jump: Option<Jump>,
    /// How rows say their time; for dates, the log's clock is the time of day
    #[arg(long, value_enum, default_value = "seconds")]
    pub stamps: Stamps,
    /// Stamps err by up to so much either way
    #[arg(long = "jitter", value_name = "SECONDS", default_value_t = 0.0)]
    pub jitter_s: f64,
    /// Stamps are cut to whole steps of so much, so that some repeat
    #[arg(long = "stamp-step", value_name = "SECONDS", default_value_t = 0.0)]
    pub stamp_step_s: f64,
    /// This share of the rows is lost
    #[arg(long = "drop", value_name = "SHARE", default_value_t = 0.0)]
    pub dropped: f64,
    /// All rows are lost from this time of the video on, for so many seconds; again for more
    #[arg(long = "gap", value_name = "FROM+LENGTH", value_parser = parse_gap)]
    pub gaps_s: Vec<[f64; 2]>,

    /// The LED is always on, and there is no column for it
    // True unless the option is given.
    #[arg(long = "no-led", action = ArgAction::SetFalse)]
    pub led: bool,
    /// Standard deviation of a reading
    #[arg(long = "noise", value_name = "VOLTS", default_value_t = 0.0005)]
    pub noise_sd_v: f64,
    /// Light that is not the LED's
    #[arg(long = "ambient", value_name = "VOLTS", default_value_t = 0.5)]
    pub ambient_v: f64,
    /// It goes up and down by so much, most of it slowly, a quarter of it with the lamps' hum
    #[arg(long, value_name = "PERCENT", default_value = "10", value_parser = parse_percent)]
    pub ambient_swing: f64,
    /// The lamps' hum
    #[arg(long = "hum", value_name = "HZ", default_value_t = 100.0)]
    pub hum_hz: f64,
    /// Photodiodes drift by about so much within minutes
    #[arg(long = "wander", value_name = "VOLTS", default_value_t = 0.01)]
    pub wander_v: f64,
    /// Lags and hysteresis as shares of the sensor's.
    #[command(flatten)]
    pub dynamics: Dynamics,
    /// What a day's wear adds.
    #[arg(skip = DisturbanceSizes::NONE)]
    #[serde(skip_serializing_if = "DisturbanceSizes::is_none")]
    pub disturbances: DisturbanceSizes,
    /// The log has the columns of the force transducer.
    #[arg(skip = true)]
    #[serde(skip_serializing_if = "is_true")]
    pub forces: bool,
    /// The log has a column `contact`, as of an ideal switch under the finger.
    #[arg(skip)]
    #[serde(skip_serializing_if = "is_default")]
    pub contact: bool,
    /// P2 and P3 are amplified so much that a fifth of what they should read is over 10 V.
    #[arg(skip)]
    pub saturate: bool,
    /// Photodiodes that read nothing, 1 for P1.
    #[arg(skip)]
    pub dead: Vec<usize>,
}

fn is_true(value: &bool) -> bool {
    *value
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

    /// The light that is not the LED's.
    pub(super) fn ambient(&self) -> Ambient {
        Ambient::new(self.seed, self.ambient_v, self.ambient_swing, self.hum_hz)
    }

    /// The drift within the log.
    pub(super) fn wander(&self) -> Wander {
        Wander::new(self.seed, self.wander_v)
    }

    /// The pulse, bumps, raised hands and the drift over hours, where there are any.
    pub(super) fn disturbances(&self) -> Option<Disturbances> {
        (!self.disturbances.is_none()).then(|| Disturbances::new(self.seed, self.disturbances))
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
        job::defaults()
    }
}
