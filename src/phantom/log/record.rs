//! A log's rows: when samples are taken, what they read, and what is true then.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::doing::{Doing, shift_rad};
use super::{Faults, LogOptions};
use crate::phantom::nail::numbers;
use crate::phantom::sensor::{Ambient, CHANNELS, Response, Sensor, Touch, Wander};

const KIND_ROWS: u32 = 26;
/// The converter: 16 bits over 0 to 10 V (3.2.3).
const FULL_V: f64 = 10.0;
const CODES: f64 = 65_536.0;
/// Resolution of the force transducer for Fx, Fy, Fz (3.2.3), and the standard deviation of its readings (assumed),
/// newtons.
const FORCE_STEP_N: [f64; 3] = [0.8e-3, 0.8e-3, 1.6e-3];
const FORCE_SD_N: f64 = 1e-3;
/// How long before the first sample the sensor has followed the movement, seconds.
const BEFORE_S: f64 = 10.0;
/// With saturation: the photodiodes, and the share of what they should read that is below full scale.
const SATURATED: [usize; 2] = [1, 2];
const BELOW_FULL: f64 = 0.8;

/// A row of a log, with its truth.
#[derive(Debug, Clone, PartialEq)]
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

/// A log, settled.
#[derive(Debug)]
pub struct LogScene {
    options: LogOptions,
    sensor: Sensor,
    ambient: Ambient,
    wander: Wander,
    rows: Vec<Row>,
}

impl LogScene {
    /// Takes all samples.
    ///
    /// # Errors
    /// [`Faults`]: all that is wrong with the options.
    pub fn new(options: LogOptions) -> Result<Self, Faults> {
        options.check()?;
        let mut sensor = Sensor::new(options.subject, options.session);
        let ambient = Ambient::new(options.seed, options.ambient_v, options.ambient_swing, options.hum_hz);
        let wander = Wander::new(options.seed, options.wander_v);
        let mut rows = moments(&options);
        follow(&options, &sensor, &ambient, &wander, &mut rows);
        if options.saturate {
            amplify(&mut sensor, &mut rows);
        }
        read(&options, &mut rows);
        Ok(Self { options, sensor, ambient, wander, rows })
    }

    /// What was asked for.
    #[must_use]
    pub fn options(&self) -> &LogOptions {
        &self.options
    }

    /// The sensor on the person's nail that day.
    #[must_use]
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// The light that is not the LED's.
    #[must_use]
    pub fn ambient(&self) -> &Ambient {
        &self.ambient
    }

    /// The drift within the log.
    #[must_use]
    pub fn wander(&self) -> &Wander {
        &self.wander
    }

    /// How far J1, J2, J3 are off straight while the finger touches or rests, radians.
    #[must_use]
    pub fn posture_shift_rad(&self) -> [f64; 3] {
        shift_rad(&self.options)
    }

    /// The rows that are not lost, in order.
    #[must_use]
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }
}

/// All samples' times; the rest of the rows is empty yet.
fn moments(options: &LogOptions) -> Vec<Row> {
    let rate = 1.0 + 1e-6 * options.clock_drift_ppm;
    let mut rng = numbers(options.seed, KIND_ROWS, 0);
    let phase: f64 = rng.random_range(0.0..1.0);
    let first_s = options.clock_offset_s - rate * options.lead_s + phase / options.rate_hz;
    let end_s = options.clock_offset_s + rate * (options.seconds + options.trail_s);
    let count = ((end_s - first_s) * options.rate_hz).ceil().max(0.0) as usize;
    let row = |sample: usize| {
        let log_s = first_s + sample as f64 / options.rate_hz;
        let scene_s = (log_s - options.clock_offset_s) / rate;
        let jump_s = options.clock_jump.filter(|jump| scene_s >= jump.at_s).map_or(0.0, |jump| jump.by_s);
        let late_s = options.jitter_s * rng.random_range(-1.0..=1.0);
        let mut stamp_s = log_s + jump_s + late_s;
        if options.stamp_step_s > 0.0 {
            stamp_s = (stamp_s / options.stamp_step_s).floor() * options.stamp_step_s;
        }
        let lost = rng.random_bool(options.dropped);
        let in_gap = options.gaps_s.iter().any(|&[from_s, length_s]| (from_s..from_s + length_s).contains(&scene_s));
        let row = Row {
            sample,
            scene_s,
            log_s,
            stamp_s,
            lit: !options.led || sample.is_multiple_of(2),
            touch: Touch { forces_n: [0.0; 3], angles_rad: [0.0; 3] },
            forces_read_n: [0.0; 3],
            read_v: [0.0; CHANNELS],
            led_v: [0.0; CHANNELS],
            static_v: [0.0; CHANNELS],
            unlit_v: [0.0; CHANNELS],
        };
        (!lost && !in_gap).then_some(row)
    };
    (0..count).filter_map(row).collect()
}

/// What is true at each row.
fn follow(options: &LogOptions, sensor: &Sensor, ambient: &Ambient, wander: &Wander, rows: &mut [Row]) {
    let doing = Doing::new(options);
    let touch = |t_s: f64| doing.touch(t_s);
    // The whole log, lost rows or not: what is lost changes nothing of the rest.
    let mut response = Response::new(sensor, options.dynamics, &touch, -options.lead_s - BEFORE_S);
    for row in rows {
        row.touch = touch(row.scene_s);
        row.static_v = sensor.static_v(&row.touch);
        let (followed, drift) = (response.at(row.scene_s), wander.at(row.scene_s));
        row.led_v = std::array::from_fn(|k| followed[k] + drift[k]);
        let light = ambient.at(row.scene_s);
        row.unlit_v = sensor.photodiodes.map(|one| one.dark_v + one.ambient * light);
    }
}

/// Amplifies two photodiodes until a part of what they should read is over full scale.
fn amplify(sensor: &mut Sensor, rows: &mut [Row]) {
    for k in SATURATED {
        let mut lit_v: Vec<f64> = rows.iter().filter(|row| row.lit).map(|row| row.led_v[k] + row.unlit_v[k]).collect();
        lit_v.sort_by(f64::total_cmp);
        let Some(high_v) = lit_v.get((BELOW_FULL * lit_v.len() as f64) as usize) else { continue };
        let factor = FULL_V / high_v;
        for row in rows.iter_mut() {
            row.led_v[k] *= factor;
            row.static_v[k] *= factor;
            row.unlit_v[k] *= factor;
        }
        let one = &mut sensor.photodiodes[k];
        one.rest_v *= factor;
        one.gain *= factor;
        one.ambient *= factor;
        one.dark_v *= factor;
    }
}

/// What each row reads.
fn read(options: &LogOptions, rows: &mut [Row]) {
    for row in rows {
        let mut rng = numbers(options.seed, KIND_ROWS, 1 + row.sample as u32);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        row.forces_read_n = std::array::from_fn(|k| {
            let read_n = row.touch.forces_n[k] + FORCE_SD_N * normal();
            (read_n / FORCE_STEP_N[k]).round() * FORCE_STEP_N[k]
        });
        row.read_v = std::array::from_fn(|k| {
            let light_v = row.unlit_v[k] + if row.lit { row.led_v[k] } else { 0.0 };
            let code = ((light_v + options.noise_sd_v * normal()) * CODES / FULL_V).round().clamp(0.0, CODES - 1.0);
            if options.dead.contains(&(k + 1)) { 0.0 } else { code * FULL_V / CODES }
        });
    }
}
