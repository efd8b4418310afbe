//! A log that is settled: its sensor, and the rows that are taken of it.

use super::samples::{FULL_V, Row, Samples};
use super::{Faults, LogOptions};
use crate::phantom::sensor::{CHANNELS, Sensor};

/// With saturation: the photodiodes, and the share of what they should read that is below full scale.
const SATURATED: [usize; 2] = [1, 2];
const BELOW_FULL: f64 = 0.8;

/// A log, settled.
#[derive(Debug)]
pub struct LogScene {
    options: LogOptions,
    sensor: Sensor,
    /// By how much each photodiode is amplified.
    gains: [f64; CHANNELS],
}

impl LogScene {
    /// Settles what the rows will be.
    ///
    /// # Errors
    /// [`Faults`]: all that is wrong with the options.
    pub fn new(options: LogOptions) -> Result<Self, Faults> {
        options.check()?;
        let mut sensor = Sensor::new(options.subject, options.session);
        let gains = if options.saturate { saturating(&options) } else { [1.0; CHANNELS] };
        for (one, gain) in sensor.photodiodes.iter_mut().zip(gains) {
            one.rest_v *= gain;
            one.gain *= gain;
            one.ambient *= gain;
            one.dark_v *= gain;
        }
        Ok(Self { options, sensor, gains })
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

    /// Takes the samples one after the other: the rows that are not lost, in order.
    pub fn samples(&self) -> impl Iterator<Item = Row> {
        Samples::new(&self.options, self.gains, false, None)
    }

    /// The rows that are not lost, in order, all in memory.
    #[must_use]
    pub fn rows(&self) -> Vec<Row> {
        self.samples().collect()
    }
}

/// Amplifies two photodiodes until a part of what they should read is over full scale.
fn saturating(options: &LogOptions) -> [f64; CHANNELS] {
    let mut lit_v = SATURATED.map(|_| Vec::new());
    for row in Samples::new(options, [1.0; CHANNELS], false, None).filter(|row| row.lit) {
        for (values, k) in lit_v.iter_mut().zip(SATURATED) {
            values.push(row.led_v[k] + row.unlit_v[k]);
        }
    }
    let mut gains = [1.0; CHANNELS];
    for (mut values, k) in lit_v.into_iter().zip(SATURATED) {
        values.sort_by(f64::total_cmp);
        if let Some(high_v) = values.get((BELOW_FULL * values.len() as f64) as usize) {
            gains[k] = FULL_V / high_v;
        }
    }
    gains
}
