//! A log's rows one after the other: when samples are taken, what they read, and what is true then.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::doing::{Doing, Prompting};
use super::{LogOptions, SensorModel};
use crate::phantom::nail::numbers;
use crate::phantom::sensor::{Ambient, CHANNELS, Disturbances, Response, Sensor, Touch, Wander, WornSensor};

const KIND_ROWS: u32 = 26;
/// The converter: 16 bits over 0 to 10 V (3.2.3).
pub(super) const FULL_V: f64 = 10.0;
const CODES: f64 = 65_536.0;
/// Resolution of the force transducer for Fx, Fy, Fz (3.2.3), and the standard deviation of its readings (assumed),
/// newtons.
const FORCE_STEP_N: [f64; 3] = [0.8e-3, 0.8e-3, 1.6e-3];
const FORCE_SD_N: f64 = 1e-3;
/// How long before the first sample the sensor has followed the movement, seconds.
pub(in crate::phantom) const BEFORE_S: f64 = 10.0;

/// A row of a log, with its truth.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Row {
    /// Which sample it is, from 0; lost ones are counted.
    pub sample: usize,
    /// The video's time.
    pub scene_s: f64,
    /// The log's clock, without jitter, coarse stamps and jumps.
    pub log_s: f64,
    /// What the row says of its time, on the log's clock.
    pub stamp_s: f64,
    /// Whether the LED is on.
    pub lit: bool,
    /// What the finger does.
    pub touch: Touch,
    /// Whether it presses: the exact pressing is above 0, and the finger is not about a near miss.
    pub contact: bool,
    /// What the force transducer reads.
    pub forces_read_n: [f64; 3],
    /// What the photodiodes read.
    pub read_v: [f64; CHANNELS],
    /// What the LED adds when it is on, with hysteresis, lag and drift.
    pub led_v: [f64; CHANNELS],
    /// What the LED adds by the static map alone.
    pub static_v: [f64; CHANNELS],
    /// Ambient light and darkness.
    pub unlit_v: [f64; CHANNELS],
}

/// Volts at a time, of times that ascend; volts of what the finger does.
type Followed = Box<dyn FnMut(f64) -> [f64; CHANNELS] + Send>;
type Still = Box<dyn Fn(&Touch) -> [f64; CHANNELS] + Send>;

/// What a sensor sees, as light of the LED.
struct Seen {
    /// As blood follows, at a time.
    followed: Followed,
    /// By the static map alone.
    still: Still,
}

impl Seen {
    fn new(options: &LogOptions, sensor: &Sensor, doing: &Doing) -> Self {
        let mut followed = doing.clone();
        let movement = move |t_s| followed.touch(t_s);
        // The whole log, lost rows or not: what is lost changes nothing of the rest.
        let start_s = -options.lead_s - BEFORE_S;
        match options.sensor {
            SensorModel::Formulae => {
                let sensor = *sensor;
                let mut response = Response::new(&sensor, options.dynamics, movement, start_s);
                Self {
                    followed: Box::new(move |t_s| response.at(t_s)),
                    still: Box::new(move |touch| sensor.static_v(touch)),
                }
            }
            SensorModel::Nail => {
                let worn = WornSensor::new(options.subject, options.session, &options.places());
                let mut colour = Response::new(&worn.blood(), options.dynamics, movement, start_s);
                let still = worn.clone();
                Self {
                    followed: Box::new(move |t_s| worn.volts(&colour.at(t_s))),
                    still: Box::new(move |touch| still.static_v(touch)),
                }
            }
        }
    }
}

/// Takes a log's samples, in memory that does not grow with their number.
pub(super) struct Samples {
    options: LogOptions,
    sensor: Sensor,
    ambient: Ambient,
    wander: Wander,
    disturbances: Option<Disturbances>,
    /// By how much each photodiode is amplified.
    gains: [f64; CHANNELS],
    rng: ChaCha8Rng,
    doing: Doing,
    seen: Seen,
    /// The log's clock at the first sample, seconds.
    first_s: f64,
    next: usize,
    count: usize,
}

impl Samples {
    /// Of a log that has passed its check; without end, it goes on after its seconds. Its finger may be one that
    /// somebody prompts.
    pub(super) fn new(
        options: &LogOptions,
        gains: [f64; CHANNELS],
        endless: bool,
        prompting: Option<Prompting>,
    ) -> Self {
        let rate = clock_rate(options);
        let mut rng = numbers(options.seed, KIND_ROWS, 0);
        let phase: f64 = rng.random_range(0.0..1.0);
        let first_s = options.clock_offset_s - rate * options.lead_s + phase / options.rate_hz;
        let end_s = options.clock_offset_s + rate * (options.seconds + options.trail_s);
        let count = if endless { usize::MAX } else { ((end_s - first_s) * options.rate_hz).ceil().max(0.0) as usize };
        let sensor = Sensor::new(options.subject, options.session);
        let doing = Doing::until(options, if endless { f64::INFINITY } else { options.seconds }, prompting);
        let seen = Seen::new(options, &sensor, &doing);
        Self {
            options: options.clone(),
            sensor,
            ambient: options.ambient(),
            wander: options.wander(),
            disturbances: options.disturbances(),
            gains,
            rng,
            doing,
            seen,
            first_s,
            next: 0,
            count,
        }
    }

    /// The time of sample `sample`, and what its row says of it; none where it is lost.
    fn moment(&mut self, sample: usize) -> Option<Row> {
        let options = &self.options;
        let log_s = self.first_s + sample as f64 / options.rate_hz;
        let scene_s = (log_s - options.clock_offset_s) / clock_rate(options);
        let jump_s = options.clock_jump.filter(|jump| scene_s >= jump.at_s).map_or(0.0, |jump| jump.by_s);
        let late_s = options.jitter_s * self.rng.random_range(-1.0..=1.0);
        let mut stamp_s = log_s + jump_s + late_s;
        if options.stamp_step_s > 0.0 {
            stamp_s = (stamp_s / options.stamp_step_s).floor() * options.stamp_step_s;
        }
        let lost = self.rng.random_bool(options.dropped);
        let in_gap = options.gaps_s.iter().any(|&[from_s, length_s]| (from_s..from_s + length_s).contains(&scene_s));
        let row =
            Row { sample, scene_s, log_s, stamp_s, lit: !options.led || sample.is_multiple_of(2), ..Row::default() };
        (!lost && !in_gap).then_some(row)
    }

    /// What is true at a row.
    fn follow(&mut self, row: &mut Row) {
        row.touch = self.doing.touch(row.scene_s);
        let near_miss = self.doing.contact(row.scene_s).is_some_and(|contact| !contact.kind.presses());
        row.contact = row.touch.forces_n[2] < 0.0 && !near_miss;
        let (followed, drift) = ((self.seen.followed)(row.scene_s), self.wander.at(row.scene_s));
        let disturbed = self.disturbances.map_or([0.0; CHANNELS], |disturbances| disturbances.at(row.scene_s));
        let light = self.ambient.at(row.scene_s);
        let still = (self.seen.still)(&row.touch);
        for (k, one) in self.sensor.photodiodes.iter().enumerate() {
            row.led_v[k] = (followed[k] + drift[k] + disturbed[k]) * self.gains[k];
            row.static_v[k] = still[k] * self.gains[k];
            row.unlit_v[k] = (one.dark_v + one.ambient * light) * self.gains[k];
        }
    }

    fn read(&self, row: &mut Row) {
        let mut rng = numbers(self.options.seed, KIND_ROWS, 1 + row.sample as u32);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        row.forces_read_n = std::array::from_fn(|k| {
            let read_n = row.touch.forces_n[k] + FORCE_SD_N * normal();
            (read_n / FORCE_STEP_N[k]).round() * FORCE_STEP_N[k]
        });
        row.read_v = std::array::from_fn(|k| {
            let light_v = row.unlit_v[k] + if row.lit { row.led_v[k] } else { 0.0 };
            let noisy_v = light_v + self.options.noise_sd_v * normal();
            let code = (noisy_v * CODES / FULL_V).round().clamp(0.0, CODES - 1.0);
            if self.options.dead.contains(&(k + 1)) { 0.0 } else { code * FULL_V / CODES }
        });
    }
}

impl Iterator for Samples {
    type Item = Row;

    fn next(&mut self) -> Option<Row> {
        while self.next < self.count {
            let sample = self.next;
            self.next += 1;
            if let Some(mut row) = self.moment(sample) {
                self.follow(&mut row);
                self.read(&mut row);
                return Some(row);
            }
        }
        None
    }
}

/// Seconds of the log's clock in a second of the scene.
fn clock_rate(options: &LogOptions) -> f64 {
    1.0 + 1e-6 * options.clock_drift_ppm
}
