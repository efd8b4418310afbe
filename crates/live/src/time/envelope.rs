//! A device's clock against the host's, by the rows that came fastest.
//!
//! In: for each row the device's time and the host's at its arrival. A row is late by what the link, the driver and the
//! machine add, never early: arrival = offset + (1 + drift) device + delay, delay >= 0. Out: the line below all arrivals
//! that is nearest to them: the edge of their lower convex hull above the middle of the time (Moon, Skelly, Towsley
//! 1999, DOI 10.1109/INFCOM.1999.749287). What delay every row has is part of the offset and can't be known from here.
//!
//! Of each bucket of time the fastest row is kept; where there are more than [`BUCKETS`] the buckets get twice as long.
//! Nothing is allocated after the start.

use serde::Serialize;

/// Buckets that are kept, and how long they are at first, seconds.
const BUCKETS: usize = 512;
const BUCKET_S: f64 = 0.25;

/// Fewer say little.
const LEAST: usize = 8;

/// The fastest row of a bucket: the device's time, arrival less it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Fastest {
    device_s: f64,
    ahead_s: f64,
}

/// A line below arrivals, as it grows.
#[derive(Debug, Clone)]
pub struct Envelope {
    buckets: Vec<Fastest>,
    bucket_s: f64,
    /// Where the last bucket ends.
    until_s: f64,
    /// Room for a hull.
    hull: Vec<Fastest>,
}

/// How a device's clock runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ClockFit {
    /// The device's time at which the offset holds: the middle of what was seen, seconds.
    pub at_s: f64,
    /// The host's time less the device's then, seconds.
    pub offset_s: f64,
    /// Its standard error, seconds.
    pub offset_se_s: f64,
    /// How much longer the host's second is than the device's, millionths: above 0 the device's clock is slow.
    pub drift_ppm: f64,
    /// Its standard error.
    pub drift_se_ppm: f64,
}

impl Default for Envelope {
    fn default() -> Self {
        let room = || Vec::with_capacity(BUCKETS);
        Self { buckets: room(), bucket_s: BUCKET_S, until_s: f64::NEG_INFINITY, hull: room() }
    }
}

impl Envelope {
    /// A row's device time and arrival, seconds; device times ascend.
    pub fn push(&mut self, device_s: f64, host_s: f64) {
        if !(device_s.is_finite() && host_s.is_finite()) {
            return;
        }
        let row = Fastest { device_s, ahead_s: host_s - device_s };
        match self.buckets.last_mut() {
            Some(last) if device_s < self.until_s => {
                if row.ahead_s < last.ahead_s {
                    *last = row;
                }
            }
            _ => {
                if self.buckets.len() == BUCKETS {
                    self.halve();
                }
                self.until_s = device_s + self.bucket_s;
                self.buckets.push(row);
            }
        }
    }

    /// Another clock begins.
    pub fn forget(&mut self) {
        self.buckets.clear();
        (self.bucket_s, self.until_s) = (BUCKET_S, f64::NEG_INFINITY);
    }

    /// Two buckets become one.
    fn halve(&mut self) {
        for k in 0..BUCKETS / 2 {
            let (a, b) = (self.buckets[2 * k], self.buckets[2 * k + 1]);
            self.buckets[k] = if a.ahead_s <= b.ahead_s { a } else { b };
        }
        self.buckets.truncate(BUCKETS / 2);
        self.bucket_s *= 2.0;
    }

    /// The line without its errors, and without allocating: the host's time less the device's at a device's time 0, and
    /// how much it grows a second.
    pub fn line(&mut self) -> Option<[f64; 2]> {
        if self.buckets.len() < LEAST {
            return None;
        }
        let line = below(&self.buckets, &mut self.hull)?;
        Some([line.at(0.0), line.slope])
    }

    /// The line; none of fewer than 8 buckets (2 s).
    #[must_use]
    pub fn fit(&self) -> Option<ClockFit> {
        if self.buckets.len() < LEAST {
            return None;
        }
        let mut hull = Vec::new();
        let whole = below(&self.buckets, &mut hull)?;
        let (first, last) = (self.buckets.first()?.device_s, self.buckets.last()?.device_s);
        let at_s = 0.5 * (first + last);
        // Blocks left out in turn: the jackknife.
        const BLOCKS: usize = 8;
        let mut without = Vec::with_capacity(BLOCKS);
        for block in 0..BLOCKS {
            let kept = self.buckets.iter().enumerate().filter(|(k, _)| k * BLOCKS / self.buckets.len() != block);
            let kept: Vec<Fastest> = kept.map(|(_, one)| *one).collect();
            let line = below(&kept, &mut hull)?;
            without.push([line.at(at_s), line.slope]);
        }
        let error = |which: usize, value: f64| {
            let n = BLOCKS as f64;
            let mean = without.iter().map(|one| one[which]).sum::<f64>() / n;
            let spread: f64 = without.iter().map(|one| (one[which] - mean).powi(2)).sum();
            // Where a line rests on one block its own removal moves it: how far is the least that is not known.
            let moved = without.iter().map(|one| (one[which] - value).abs()).fold(0.0, f64::max);
            ((n - 1.0) / n * spread).sqrt().max(moved)
        };
        Some(ClockFit {
            at_s,
            offset_s: whole.at(at_s),
            offset_se_s: error(0, whole.at(at_s)),
            drift_ppm: 1e6 * whole.slope,
            drift_se_ppm: 1e6 * error(1, whole.slope),
        })
    }
}

struct Line {
    from: Fastest,
    slope: f64,
}

impl Line {
    fn at(&self, device_s: f64) -> f64 {
        self.from.ahead_s + self.slope * (device_s - self.from.device_s)
    }
}

/// The edge of the lower hull above the middle of the points' times.
fn below(points: &[Fastest], hull: &mut Vec<Fastest>) -> Option<Line> {
    hull.clear();
    for &point in points {
        while let [.., a, b] = hull[..] {
            let turn = (b.device_s - a.device_s) * (point.ahead_s - a.ahead_s)
                - (b.ahead_s - a.ahead_s) * (point.device_s - a.device_s);
            if turn > 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(point);
    }
    let middle = points.iter().map(|point| point.device_s).sum::<f64>() / points.len() as f64;
    let edge = hull.windows(2).find(|edge| edge[1].device_s >= middle)?;
    let slope = (edge[1].ahead_s - edge[0].ahead_s) / (edge[1].device_s - edge[0].device_s);
    slope.is_finite().then_some(Line { from: edge[0], slope })
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// A minute at 1 kHz, 40 ppm slow, 5 ms of delay at most or exponential with that mean.
    fn fit(seed: u64, seconds: f64, exponential: bool) -> ClockFit {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut envelope = Envelope::default();
        for k in 0..(1000.0 * seconds) as u64 {
            let device_s = k as f64 * 1e-3;
            let unit: f64 = rng.random_range(0.0..1.0);
            let delay_s = 5e-3 * if exponential { -(1.0 - unit).ln() } else { unit };
            envelope.push(device_s, 100.0 + (1.0 + 40e-6) * device_s + delay_s);
        }
        envelope.fit().unwrap()
    }

    #[test]
    fn the_clock_is_known_within_its_error_in_every_seed() {
        let mut worst: f64 = 0.0;
        for seed in 0..50 {
            for exponential in [false, true] {
                let fit = fit(seed, 60.0, exponential);
                let truth_s = 100.0 + 40e-6 * fit.at_s;
                let off_s = fit.offset_s - truth_s;
                assert!(off_s >= -1e-9 && off_s <= 3.0 * fit.offset_se_s + 20e-6, "{seed}: {off_s} {fit:?}");
                worst = worst.max((fit.drift_ppm - 40.0).abs());
                assert!((fit.drift_ppm - 40.0).abs() <= 3.0 * fit.drift_se_ppm + 0.5, "{seed}: {fit:?}");
            }
        }
        println!("drift within {worst:.2} ppm after 60 s");
        assert!(worst <= 5.0, "{worst}");
    }

    #[test]
    fn a_day_takes_no_more_room_than_a_minute() {
        let mut envelope = Envelope::default();
        for k in 0..86_400 {
            envelope.push(f64::from(k), 7.0 + f64::from(k) * (1.0 - 10e-6) + 1e-3 * f64::from(k % 7));
        }
        assert!(envelope.buckets.capacity() == BUCKETS && envelope.buckets.len() <= BUCKETS);
        let fit = envelope.fit().unwrap();
        assert!((fit.drift_ppm + 10.0).abs() <= 0.01, "{fit:?}");
        envelope.forget();
        assert_eq!(envelope.fit(), None);
    }
}
