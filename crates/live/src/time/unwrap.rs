//! Clocks that begin again: 2^32 microseconds are 71.58 minutes, 2^32 milliseconds 49.7 days.

use crate::time::resolution::Resolution;

/// A leap over the end of 32 bits of at most so many seconds is one, seconds, beyond twice what the host saw pass: a
/// device that starts again reads nearly zero, whatever it read before (*assumed*).
const LEAP_S: f64 = 10.0;

/// A leap over the end of 8 or 16 bits of at most so many periods is one where the host saw nothing (*assumed*).
const LEAP_PERIODS: f64 = 16.0;

/// What a stamp is, after those before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reading {
    /// Not before the latest; unwrapped, in the clock's unit.
    On(f64),
    /// Before the latest, and no wrap: so many units.
    Back(f64),
}

/// What else is known of the step to a stamp.
#[derive(Debug, Clone, Copy, Default)]
pub struct Expected {
    /// Seconds that passed on the host; none where rows do not come live.
    pub host_s: Option<f64>,
    /// The mean step, seconds.
    pub period_s: Option<f64>,
}

/// Unwraps stamps of a clock of 8, 16 or 32 bits, whole numbers all; others never wrap.
#[derive(Debug, Clone)]
pub struct Unwrap {
    per_second: f64,
    /// The latest stamp as it was read.
    pub(crate) last: Option<f64>,
    /// What is added to stamps: so many units were wrapped away.
    base: f64,
    whole: bool,
    bits: Option<u32>,
    resolution: Resolution,
    /// How often it wrapped.
    pub(crate) wraps: u64,
}

impl Unwrap {
    /// A clock with so many units in a second.
    #[must_use]
    pub fn new(per_second: f64) -> Self {
        Self { per_second, last: None, base: 0.0, whole: true, bits: None, resolution: Resolution::default(), wraps: 0 }
    }

    /// Reads a stamp; one that is [`Reading::Back`] changes nothing.
    pub fn read(&mut self, stamp: f64, expected: Expected) -> Reading {
        self.whole &= stamp.fract() == 0.0 && stamp >= 0.0;
        let Some(last) = self.last else {
            self.set(stamp);
            return Reading::On(stamp);
        };
        if stamp < last {
            let Some(bits) = self.wrapped(stamp, last, expected) else { return Reading::Back(last - stamp) };
            self.base += f64::from(bits).exp2();
            self.bits = Some(bits);
            self.wraps += 1;
        }
        self.last = Some(stamp);
        self.resolution.read(stamp);
        Reading::On(stamp + self.base)
    }

    /// The clock was set: what it counts begins at a stamp.
    pub fn set(&mut self, stamp: f64) {
        (self.last, self.base) = (Some(stamp), 0.0);
        self.resolution.read(stamp);
    }

    /// The clock's resolution, by the stamps so far; in its unit.
    #[must_use]
    pub fn resolution(&self) -> f64 {
        self.resolution.unit()
    }

    /// The bits over whose end the step from `last` to `stamp` leads.
    fn wrapped(&self, stamp: f64, last: f64, expected: Expected) -> Option<u32> {
        if !self.whole {
            return None;
        }
        let widths = self.bits.map_or([8, 16, 32], |bits| [bits; 3]);
        widths.into_iter().find(|&bits| {
            let leap = stamp + f64::from(bits).exp2() - last;
            let leap_s = leap / self.per_second;
            let least = f64::from(bits).exp2() / 4.0;
            let most_s = match (bits, expected.host_s, expected.period_s) {
                (32, host_s, _) => LEAP_S + 2.0 * host_s.unwrap_or(0.0),
                (_, Some(host_s), Some(period_s)) => 1.5 * host_s + LEAP_PERIODS * period_s,
                (_, None, Some(period_s)) => LEAP_PERIODS * period_s,
                _ => 0.0,
            };
            last < f64::from(bits).exp2() && leap <= least && leap_s <= most_s
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TURN: u64 = 1 << 32;

    #[test]
    fn microseconds_go_on_over_their_end_again_and_again() {
        let mut unwrap = Unwrap::new(1e6);
        // Three and a half hours at 100 Hz.
        for row in 0..1_260_000_u64 {
            let true_us = TURN - 25_000_000 + row * 10_000;
            let stamp = (true_us % TURN) as f64;
            let read = unwrap.read(stamp, Expected { host_s: Some(0.01), period_s: Some(0.01) });
            assert_eq!(read, Reading::On(true_us as f64), "row {row}");
        }
        assert_eq!(unwrap.wraps, 3);
    }

    #[test]
    fn clocks_of_16_and_8_bits_wrap_where_the_step_fits() {
        for (bits, step, per_second) in [(16, 40_u64, 1e3), (16, 1000, 1e6), (8, 10, 1e3)] {
            let mut unwrap = Unwrap::new(per_second);
            let expected = Expected { host_s: None, period_s: Some(step as f64 / per_second) };
            for row in 0..20_000 {
                let stamp = (row * step) % (1 << bits);
                assert_eq!(unwrap.read(stamp as f64, expected), Reading::On((row * step) as f64), "{bits} {row}");
            }
        }
    }

    #[test]
    fn a_device_that_starts_again_is_no_wrap() {
        for (last, stamp, per_second) in
            [(3.0e9, 20_000.0, 1e6), (4.2e9, 1_000.0, 1e6), (1.5, 0.5, 1.0), (65_000.0, 100.0, 1e3), (200.5, 3.5, 1e3)]
        {
            let mut unwrap = Unwrap::new(per_second);
            assert_eq!(unwrap.read(last, Expected::default()), Reading::On(last));
            let expected = Expected { host_s: Some(0.001), period_s: Some(0.001) };
            assert_eq!(unwrap.read(stamp, expected), Reading::Back(last - stamp), "{last} {stamp}");
            unwrap.set(stamp);
            assert_eq!(unwrap.read(stamp + 1.0, expected), Reading::On(stamp + 1.0));
        }
    }
}
