//! The sessions of a person who wears the sensor: which there are, and the recording of each (3.3, 5.2.4, 5.3).
//!
//! Whatever is filmed is filmed with the clock of the log's computer in the picture; that clock is ahead of the video's
//! time by some minutes and runs a little faster or slower.

use rand::RngExt;

use super::{Recording, StudyOptions};
use lunula::phantom::log::{LogOptions, Protocol};
use lunula::phantom::nail::numbers;
use lunula::phantom::screen::Clock;
use lunula::phantom::trajectory::Trajectory;
use lunula::phantom::video::VideoOptions;

/// A session of somebody.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Session {
    /// Its name among the person's.
    pub(super) name: &'static str,
    /// What is done; repetitions have the same.
    pub(super) kind: &'static str,
    /// Which of its kind.
    pub(super) repetition: u32,
    protocol: Protocol,
    /// Whether there is a video of it.
    pub(super) filmed: bool,
    /// How the sensor sits.
    day: u32,
}

const fn session(name: &'static str, kind: &'static str, repetition: u32, protocol: Protocol) -> Session {
    Session { name, kind, repetition, protocol, filmed: false, day: 1 }
}

const fn filmed(name: &'static str, protocol: Protocol) -> Session {
    Session { filmed: true, ..session(name, name, 1, protocol) }
}

/// Of everybody: the calibration (5.2.4) and its tests (5.3).
const CALIBRATION: [Session; 6] = [
    session("touch-1", "touch", 1, Protocol::Touch),
    session("touch-2", "touch", 2, Protocol::Touch),
    session("touch-3", "touch", 3, Protocol::Touch),
    session("random", "random", 1, Protocol::TouchRandom),
    filmed("bending", Protocol::Bending),
    filmed("bending-random", Protocol::BendingRandom),
];
/// Of one: the preliminary experiments (3.3), on another day.
const PRELIMINARY: [Session; 4] = [
    Session { day: 2, ..session("normal", "normal", 1, Protocol::Normal) },
    Session { day: 2, ..session("lateral", "lateral", 1, Protocol::Lateral) },
    Session { day: 2, ..session("longitudinal", "longitudinal", 1, Protocol::Longitudinal) },
    Session { day: 2, ..filmed("free-bending", Protocol::FreeBending) },
];

/// The sessions of the person `subject`, from 0; the first has the preliminary experiments.
pub(super) fn sessions(subject: u32) -> impl Iterator<Item = (u64, Session)> {
    let preliminary = if subject == 0 { &PRELIMINARY[..] } else { &[] };
    (1..).zip(CALIBRATION.iter().chain(preliminary).copied())
}

const KIND_STUDY: u32 = 41;
/// What the log's clock says when the video begins, seconds, and how fast it runs, millionths either way.
const OFFSET_S: std::ops::Range<f64> = 30.0..600.0;
const DRIFT_PPM: f64 = 60.0;
/// Refreshes of the clock's screen a second.
const REFRESH_HZ: f64 = 60.0;
/// Whose subjects are whose: no two studies of different seeds have the same people, up to so many.
const APART: u64 = 1_000_000;

/// The number of a study's person, from 0, among all people.
pub(super) fn person(options: &StudyOptions, subject: u32) -> u32 {
    // Of seed 1, those that `lunula phantom log --subject 1` and on knows.
    (options.seed.wrapping_sub(1).wrapping_mul(u64::from(StudyOptions::MOST) + 1) as u32).wrapping_add(subject + 1)
}

impl Session {
    /// What is recorded of the person `subject`, from 0; `number` is the session's among the person's.
    pub(super) fn recording(&self, options: &StudyOptions, subject: u32, number: u64) -> Recording {
        let seed = options.seed.wrapping_mul(APART).wrapping_add(100 * u64::from(subject + 1) + number);
        let mut rng = numbers(seed, KIND_STUDY, 0);
        // To the millisecond and the hundredth of a millionth: readable in the truth.
        let clock_offset_s = (1e3 * rng.random_range(OFFSET_S)).round() / 1e3;
        let clock_drift_ppm = (1e2 * rng.random_range(-DRIFT_PPM..DRIFT_PPM)).round() / 1e2;
        let usual = LogOptions::of(self.protocol, seed);
        let seconds = if self.filmed { options.seconds } else { usual.seconds };
        let log = LogOptions {
            subject: person(options, subject),
            session: self.day,
            seconds,
            clock_offset_s,
            clock_drift_ppm,
            ..usual
        };
        if !self.filmed {
            return Recording::Log(Box::new(log));
        }
        let trajectory = Trajectory::Followed { prompted: Box::new(log.trajectory.clone()), share: log.follow, seed };
        let clock = Clock {
            offset_s: clock_offset_s,
            drift_ppm: clock_drift_ppm,
            refresh_hz: Some(REFRESH_HZ),
            ..Clock::default()
        };
        let video = VideoOptions {
            seed,
            fps: options.fps,
            seconds,
            trajectory,
            clock: Some(clock),
            crf: 20,
            preset: "veryfast",
            ..VideoOptions::sized(options.width, options.height)
        };
        Recording::Filmed { video: Box::new(video), log: Box::new(log) }
    }
}
