//! The line between a device's clock and the host's.
//!
//! In: for each row the device's time and that of its arrival. Out: host time less device time, the drift between the
//! clocks, and how well both are known.
//!
//! A row arrives late, never early: all points (device time, arrival less device time) lie above the true line, and
//! the few that were hardly delayed lie on it. The line is therefore the highest one that lies below all points in
//! the middle of the window, an edge of their lower convex hull (Moon, Skelly and Towsley 1999,
//! doi:10.1109/INFCOM.1999.749287). At the mean of the window it is never below the true line; how far it may be above
//! it is taken from the lowest points of 16 to 32 pieces of the window. A delay that every row has can't be seen: it
//! belongs to the offset.
//!
//! The window is between [`WINDOW_S`] and twice as long. Nothing is allocated after the start.

use serde::Serialize;

/// The shortest full window, seconds: a crystal's frequency follows the room's temperature over minutes (*assumed*).
const WINDOW_S: f64 = 300.0;

/// The most corners of a hull: a random one has about ten, and a drift that bends makes it grow.
const CORNERS: usize = 1024;

/// Pieces of the window, at most.
const PIECES: usize = 32;

/// Standard errors in units of the pieces' mean height above the line over their number (of the drift: and over the
/// window's length): *measured*, over 200 windows of exponential and of uniform delays, whose errors are 0.9 to 1.04
/// times these.
const OFFSET_ERROR: f64 = 2.5;
const DRIFT_ERROR: f64 = 8.0;

/// The line between two clocks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ClockFit {
    /// The device's time in the middle of the window, seconds.
    pub device_s: f64,
    /// Host time less device time there, seconds.
    pub offset_s: f64,
    /// The least that it may be; the most is `offset_s` itself.
    pub offset_low_s: f64,
    /// Standard error of `offset_s`, seconds.
    pub offset_se_s: f64,
    /// By how much the host's clock is faster than the device's, millionths.
    pub drift_ppm: f64,
    /// Standard error of `drift_ppm`.
    pub drift_se_ppm: f64,
    /// How many rows the line is made of.
    pub rows: u64,
    /// The length of the window, seconds.
    pub window_s: f64,
}

impl ClockFit {
    /// Host time of a device's time, both seconds.
    #[must_use]
    pub fn host_s(&self, device_s: f64) -> f64 {
        device_s + self.offset_s + (device_s - self.device_s) * self.drift_ppm / 1e6
    }
}

/// The lower envelope of arrivals.
#[derive(Debug, Clone)]
pub struct Envelope {
    /// The one that is asked, and a younger one that takes its place.
    hulls: [Hull; 2],
}

impl Default for Envelope {
    fn default() -> Self {
        Self { hulls: [Hull::new(), Hull::new()] }
    }
}

impl Envelope {
    /// Adds a row: its device time and that of its arrival, seconds. Device times ascend; NaN is passed over.
    pub fn push(&mut self, device_s: f64, host_s: f64) {
        if !(device_s.is_finite() && host_s.is_finite()) {
            return;
        }
        if self.hulls[0].length_s() >= WINDOW_S {
            self.hulls[1].push(device_s, host_s);
        }
        self.hulls[0].push(device_s, host_s);
        if self.hulls[1].length_s() >= WINDOW_S || self.hulls[0].is_full() {
            self.hulls.swap(0, 1);
            self.hulls[1].clear();
        }
    }

    /// Forgets all rows: the device's clock was set.
    pub fn clear(&mut self) {
        self.hulls.iter_mut().for_each(Hull::clear);
    }

    /// The line; none before there are enough rows for an error to be known.
    #[must_use]
    pub fn fit(&self) -> Option<ClockFit> {
        self.hulls[0].fit()
    }
}

/// A point below which no other lies: seconds of the device, and host less device.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Corner {
    x: f64,
    y: f64,
}

#[derive(Debug, Clone)]
struct Hull {
    /// Device and host time of the first row, from which all others are counted.
    first_s: Option<[f64; 2]>,
    last_x: f64,
    corners: Vec<Corner>,
    rows: u64,
    sum_x: f64,
    pieces: Pieces,
}

impl Hull {
    fn new() -> Self {
        Self {
            first_s: None,
            last_x: 0.0,
            corners: Vec::with_capacity(CORNERS + 1),
            rows: 0,
            sum_x: 0.0,
            pieces: Pieces::default(),
        }
    }

    fn clear(&mut self) {
        self.first_s = None;
        self.corners.clear();
        (self.last_x, self.rows, self.sum_x) = (0.0, 0, 0.0);
        self.pieces = Pieces::default();
    }

    fn length_s(&self) -> f64 {
        self.last_x
    }

    fn is_full(&self) -> bool {
        self.corners.len() > CORNERS
    }

    fn push(&mut self, device_s: f64, host_s: f64) {
        let [device_0, host_0] = *self.first_s.get_or_insert([device_s, host_s]);
        let x = device_s - device_0;
        let new = Corner { x, y: (host_s - host_0) - x };
        if x < self.last_x {
            return;
        }
        self.last_x = x;
        self.rows += 1;
        self.sum_x += x;
        while let [.., last] = self.corners[..]
            && last.x == x
        {
            if last.y <= new.y {
                return;
            }
            self.corners.pop();
        }
        while let [.., before, last] = self.corners[..]
            && (last.x - before.x) * (new.y - before.y) <= (last.y - before.y) * (new.x - before.x)
        {
            self.corners.pop();
        }
        self.corners.push(new);
        let slope = self.edge().map_or(0.0, |[a, b]| (b.y - a.y) / (b.x - a.x));
        self.pieces.push(new, slope);
    }

    /// The edge above or below which the mean of the window lies.
    fn edge(&self) -> Option<[Corner; 2]> {
        let mean = self.sum_x / self.rows as f64;
        let after = self.corners.partition_point(|corner| corner.x <= mean);
        let after = after.clamp(1, self.corners.len().checked_sub(1).filter(|last| *last > 0)?);
        Some([self.corners[after - 1], self.corners[after]])
    }

    fn fit(&self) -> Option<ClockFit> {
        let [device_0, host_0] = self.first_s?;
        let [a, b] = self.edge()?;
        let slope = (b.y - a.y) / (b.x - a.x);
        let mean = self.sum_x / self.rows as f64;
        let line = |x: f64| a.y + (x - a.x) * slope;
        let (pieces, height_s) = self.pieces.height_above(line)?;
        let offset_s = (host_0 - device_0) + line(mean);
        Some(ClockFit {
            device_s: device_0 + mean,
            offset_s,
            offset_low_s: offset_s - height_s,
            offset_se_s: OFFSET_ERROR * height_s / pieces,
            drift_ppm: slope * 1e6,
            drift_se_ppm: DRIFT_ERROR * height_s / pieces / self.last_x * 1e6,
            rows: self.rows,
            window_s: self.last_x,
        })
    }
}

/// The lowest point of each piece of the window; pieces grow with it.
#[derive(Debug, Clone)]
struct Pieces {
    length_s: f64,
    lowest: [Option<Corner>; PIECES],
}

impl Default for Pieces {
    fn default() -> Self {
        Self { length_s: 1.0 / 32.0, lowest: [None; PIECES] }
    }
}

impl Pieces {
    fn push(&mut self, new: Corner, slope: f64) {
        let lower = |a: Option<Corner>, b: Option<Corner>| match (a, b) {
            (Some(a), Some(b)) if b.y - a.y < slope * (b.x - a.x) => Some(b),
            (a, b) => a.or(b),
        };
        while new.x >= self.length_s * PIECES as f64 {
            for at in 0..PIECES {
                let pair = [2 * at, 2 * at + 1].map(|k| self.lowest.get(k).copied().flatten());
                self.lowest[at] = lower(pair[0], pair[1]);
            }
            self.length_s *= 2.0;
        }
        let at = (new.x / self.length_s) as usize;
        if let Some(piece) = self.lowest.get_mut(at) {
            *piece = lower(*piece, Some(new));
        }
    }

    /// How many pieces there are, and their mean height above a line, seconds; none of fewer than eight, which the
    /// line would pass through.
    fn height_above(&self, line: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
        const LEAST: usize = 8;
        let count = self.lowest.iter().flatten().count();
        let sum: f64 = self.lowest.iter().flatten().map(|point| (point.y - line(point.x)).max(0.0)).sum();
        (count >= LEAST).then(|| (count as f64, sum / count as f64))
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    const OFFSET_S: f64 = 1234.5;

    /// The fit after so many seconds at 1 kHz, and the true offset at its middle.
    fn fitted(seed: u64, seconds: f64, drift_ppm: f64, delay_s: impl Fn(f64) -> f64) -> (ClockFit, f64) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut envelope = Envelope::default();
        for row in 0..(seconds * 1000.0) as u64 {
            let device_s = row as f64 * 1e-3;
            let host_s = device_s * (1.0 + drift_ppm * 1e-6) + OFFSET_S;
            envelope.push(device_s, host_s + delay_s(random.random::<f64>()));
        }
        let fit = envelope.fit().unwrap();
        (fit, OFFSET_S + fit.device_s * drift_ppm * 1e-6)
    }

    type Delay = (&'static str, fn(f64) -> f64);
    const DELAYS: [Delay; 2] = [("exponential", |u| -5e-3 * (1.0 - u).ln()), ("uniform", |u| 5e-3 * u)];

    #[test]
    fn the_interval_holds_the_truth_and_the_drift_is_known() {
        for (name, delay_s) in DELAYS {
            let (mut worst_ppm, mut widest_s) = (0.0_f64, 0.0_f64);
            for seed in 0..50 {
                let drift_ppm = seed as f64 * 4.0 - 100.0;
                let (fit, offset_s) = fitted(seed, 60.0, drift_ppm, delay_s);
                assert!(fit.offset_low_s <= offset_s && offset_s <= fit.offset_s + 1e-9, "{name} {seed}: {fit:?}");
                worst_ppm = worst_ppm.max((fit.drift_ppm - drift_ppm).abs());
                widest_s = widest_s.max(fit.offset_s - fit.offset_low_s);
            }
            // Measured: 0.038 ppm and 3.9 us, for both.
            println!("{name}: drift within {worst_ppm:.3} ppm, offset within {:.1} us", widest_s * 1e6);
            assert!(worst_ppm <= 0.2 && widest_s <= 3e-5, "{name}: {worst_ppm} ppm, {widest_s} s");
        }
    }

    #[test]
    fn standard_errors_are_those_of_many_seeds() {
        for (name, delay_s) in DELAYS {
            let (mut offsets, mut drifts) = (0.0, 0.0);
            const SEEDS: u64 = 200;
            for seed in 0..SEEDS {
                let (fit, offset_s) = fitted(1000 + seed, 10.0, 30.0, delay_s);
                offsets += ((fit.offset_s - offset_s) / fit.offset_se_s).powi(2) / SEEDS as f64;
                drifts += ((fit.drift_ppm - 30.0) / fit.drift_se_ppm).powi(2) / SEEDS as f64;
            }
            let (offset, drift) = (offsets.sqrt(), drifts.sqrt());
            println!("{name}: error over standard error: offset {offset:.2}, drift {drift:.2}");
            assert!((0.5..=1.5).contains(&offset) && (0.5..=1.5).contains(&drift), "{name} {offset} {drift}");
        }
    }

    #[test]
    fn a_line_without_delays_is_exact() {
        let (fit, offset_s) = fitted(0, 20.0, -40.0, |_| 0.0);
        assert!((fit.offset_s - offset_s).abs() <= 1e-12 * OFFSET_S && (fit.drift_ppm + 40.0).abs() <= 1e-6, "{fit:?}");
        assert!((fit.host_s(7.0) - (7.0 * (1.0 - 40e-6) + OFFSET_S)).abs() <= 1e-9);
    }

    #[test]
    fn old_rows_leave_the_window_and_nothing_is_allocated() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut envelope = Envelope::default();
        let counted = allocation_counter::measure(|| {
            for row in 0..2_000_000_u64 {
                let device_s = row as f64 * 1e-3;
                // From 1000 s on the host's clock runs faster.
                let drift_s = 20e-6 * device_s + 30e-6 * (device_s - 1000.0).max(0.0);
                envelope.push(device_s, device_s + drift_s + 5e-3 * random.random::<f64>());
            }
        });
        let fit = envelope.fit().unwrap();
        assert_eq!(counted.count_total, 0);
        assert!((fit.drift_ppm - 50.0).abs() <= 0.05, "{fit:?}");
        assert!((WINDOW_S..=2.0 * WINDOW_S).contains(&fit.window_s), "{fit:?}");
    }

    #[test]
    fn few_rows_or_odd_ones_say_nothing() {
        let mut envelope = Envelope::default();
        for (device_s, host_s) in [(f64::NAN, 1.0), (1.0, f64::INFINITY), (1.0, 2.0), (1.0, 1.5), (0.5, 3.0)] {
            envelope.push(device_s, host_s);
        }
        assert_eq!(envelope.fit(), None);
        // A drift that bends upwards: each row is a corner.
        for row in 0..20_000 {
            let device_s = 2.0 + f64::from(row) * 1e-3;
            envelope.push(device_s, device_s + 1e-3 * device_s * device_s);
        }
        assert!(envelope.fit().is_some());
    }
}
