//! A long series thinned for a picture: bins of equal numbers of rows that keep the extremes, at most [`MOST_BINS`] of them.
//!
//! Rows are fed one after the other. When the bins are full, neighbours are joined and a bin holds twice the rows; so memory
//! does not grow with the series, and no peak is lost.

use crate::posture::Angle;

/// More bins than a picture has columns.
pub(super) const MOST_BINS: usize = 2048;

/// A row's angle with its time, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    pub(super) time_s: f64,
    pub(super) deg: f64,
    pub(super) sd_deg: f64,
}

/// What the rows of a bin hold of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Summary {
    pub(super) lowest: Sample,
    pub(super) highest: Sample,
    /// Of the bands of plus or minus a standard error.
    pub(super) band: [f64; 2],
    pub(super) largest_sd_deg: f64,
}

impl Summary {
    fn of(sample: Sample) -> Self {
        let band = [sample.deg - sample.sd_deg, sample.deg + sample.sd_deg];
        Self { lowest: sample, highest: sample, band, largest_sd_deg: sample.sd_deg }
    }

    fn joined(self, other: Self) -> Self {
        Self {
            lowest: if other.lowest.deg < self.lowest.deg { other.lowest } else { self.lowest },
            highest: if other.highest.deg > self.highest.deg { other.highest } else { self.highest },
            band: [self.band[0].min(other.band[0]), self.band[1].max(other.band[1])],
            largest_sd_deg: self.largest_sd_deg.max(other.largest_sd_deg),
        }
    }
}

/// Neighbouring rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bin {
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    rows: usize,
    /// Rows in which an angle is missing.
    pub(super) lacking: usize,
    pub(super) joints: Vec<Option<Summary>>,
}

impl Bin {
    /// Takes the rows after its own; those of a bin without a time of its own are counted to it.
    fn join(&mut self, next: Self) {
        self.to_s = next.to_s;
        self.rows += next.rows;
        self.lacking += next.lacking;
        for (own, next) in self.joints.iter_mut().zip(next.joints) {
            *own = match (*own, next) {
                (Some(a), Some(b)) => Some(a.joined(b)),
                (a, b) => a.or(b),
            };
        }
    }
}

/// The bins of a series.
#[derive(Debug, Clone)]
pub(super) struct Thinned {
    bins: Vec<Bin>,
    rows_a_bin: usize,
}

impl Thinned {
    pub(super) fn new() -> Self {
        Self { bins: Vec::new(), rows_a_bin: 1 }
    }

    pub(super) fn push(&mut self, time_s: f64, angles: &[Option<Angle>]) {
        let sample = |a: &Angle| Sample { time_s, deg: a.rad.to_degrees(), sd_deg: a.sd_rad.to_degrees() };
        let bin = Bin {
            from_s: time_s,
            to_s: time_s,
            rows: 1,
            lacking: usize::from(angles.iter().any(Option::is_none)),
            joints: angles.iter().map(|a| a.as_ref().map(|a| Summary::of(sample(a)))).collect(),
        };
        match self.bins.last_mut() {
            Some(last) if last.rows < self.rows_a_bin => last.join(bin),
            _ => self.bins.push(bin),
        }
        if self.bins.len() > MOST_BINS {
            self.rows_a_bin *= 2;
            let mut joined: Vec<Bin> = Vec::with_capacity(MOST_BINS);
            for bin in self.bins.drain(..) {
                match joined.last_mut() {
                    Some(last) if last.rows + bin.rows <= self.rows_a_bin => last.join(bin),
                    _ => joined.push(bin),
                }
            }
            self.bins = joined;
        }
    }

    pub(super) fn bins(&self) -> &[Bin] {
        &self.bins
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle(deg: f64) -> Option<Angle> {
        Some(Angle { rad: deg.to_radians(), sd_rad: 0.1_f64.to_radians() })
    }

    #[test]
    fn a_short_series_is_kept_row_by_row() {
        let mut thinned = Thinned::new();
        for k in 0..MOST_BINS {
            thinned.push(k as f64, &[if k == 5 { None } else { angle(k as f64) }]);
        }
        assert_eq!(thinned.bins().len(), MOST_BINS);
        assert_eq!((thinned.bins()[5].joints[0], thinned.bins()[5].lacking), (None, 1));
        assert!((thinned.bins()[7].joints[0].unwrap().highest.deg - 7.0).abs() < 1e-12);
    }

    #[test]
    fn a_long_series_keeps_its_extremes_in_few_bins() {
        let mut thinned = Thinned::new();
        let rows = 100_003;
        for k in 0..rows {
            let deg = if k == 77_777 {
                500.0
            } else if k == 3 {
                -400.0
            } else {
                (k % 100) as f64
            };
            thinned.push(k as f64, &[angle(deg), if k % 1000 == 0 { None } else { angle(1.0) }]);
        }
        let bins = thinned.bins();
        assert!(bins.len() <= MOST_BINS && bins.len() > MOST_BINS / 2 - 2, "{}", bins.len());
        let highest = bins.iter().filter_map(|b| b.joints[0]).map(|s| s.highest.deg).fold(f64::MIN, f64::max);
        let lowest = bins.iter().filter_map(|b| b.joints[0]).map(|s| s.lowest.deg).fold(f64::MAX, f64::min);
        assert!((highest - 500.0).abs() < 1e-9 && (lowest + 400.0).abs() < 1e-9);
        assert_eq!(bins.iter().map(|b| b.rows).sum::<usize>(), rows);
        assert_eq!(bins.iter().map(|b| b.lacking).sum::<usize>(), 101);
        assert!(bins.windows(2).all(|w| w[0].to_s < w[1].from_s));
    }
}
