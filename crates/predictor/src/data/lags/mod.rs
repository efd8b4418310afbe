//! Lag features: what the photodiodes said a moment ago, as further inputs.
//!
//! In: rows with their time, and lags in seconds. Out: the same rows with the inputs at t - lag beside those at t,
//! named `P1@-0.1s`, for the linear, quadratic or network model to use (blood takes 0.1 to 0.3 s to come and go, 4.3).
//! Between two rows of one recording voltages are interpolated linearly, but only where the two are no farther apart
//! than `longest_gap_s`: twice the median step of the rows that a model was trained on. A row without that much
//! history is left out and counted. Moments without targets are history all the same, as they are where targets are
//! predicted: with forces in each tenth row only, errors of 0.32 N were said to be 0.14 without them.
//!
//! A set is expanded by the very code that expands a stream, so both give the same bits. Conventions: a moment within a
//! hundred-thousandth of the longest gap of a row's time is that row's (seconds since 1970 hold no more digits); time
//! that goes back begins a new recording; a second row of the same time is answered, and the first stays the history; a
//! row whose time or voltages are not finite is left out of the history.

mod stream;

use ndarray::Array2;
use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use self::stream::LagStream;
use crate::{Dataset, DatasetFault, Recording};

/// Which lags, and how large a gap may be interpolated over.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Raw")]
pub struct Lags {
    lags_s: Vec<f64>,
    /// The longest gap between two rows that is interpolated over.
    longest_gap_s: f64,
}

/// As it is read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    lags_s: Vec<f64>,
    longest_gap_s: f64,
}

impl TryFrom<Raw> for Lags {
    type Error = LagFault;

    fn try_from(raw: Raw) -> Result<Self, LagFault> {
        Self::new(raw.lags_s, raw.longest_gap_s)
    }
}

/// A set with lags.
#[derive(Debug, Clone, PartialEq)]
pub struct Lagged {
    /// The rows with enough history.
    pub data: Dataset,
    /// How many had not.
    pub dropped: usize,
    /// Which rows of the set before were kept, ascending.
    pub kept: Vec<usize>,
}

/// Why there are no lags.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum LagFault {
    #[error("a lag of {0} s; lags must be finite, above 0 and different from each other")]
    Lag(f64),
    #[error("no lags are given")]
    None,
    #[error("a longest gap of {0} s; it must be finite and above 0")]
    Gap(f64),
    #[error(
        "no two rows of a recording follow each other in time, so their step is not known; rows need a time_s that \
         ascends"
    )]
    Step,
    #[error("no row has a time, and lags of {longest_s} s need one; give the rows a column time_s in seconds")]
    NoTime { longest_s: f64 },
    #[error("none of {rows} rows has a history of {longest_s} s without a gap above {gap_s} s; take shorter lags")]
    History { rows: usize, longest_s: f64, gap_s: f64 },
    #[error(transparent)]
    Dataset(#[from] DatasetFault),
}

impl Lags {
    /// Lags in seconds, in the order in which the inputs shall come, and the longest gap between two rows that is
    /// interpolated over.
    pub fn new(lags_s: Vec<f64>, longest_gap_s: f64) -> Result<Self, LagFault> {
        let repeated = |k: usize| lags_s[..k].contains(&lags_s[k]);
        let bad = |k: &usize| !(lags_s[*k].is_finite() && lags_s[*k] > 0.0) || repeated(*k);
        if lags_s.is_empty() {
            return Err(LagFault::None);
        }
        if let Some(k) = (0..lags_s.len()).find(bad) {
            return Err(LagFault::Lag(lags_s[k]));
        }
        if !(longest_gap_s.is_finite() && longest_gap_s > 0.0) {
            return Err(LagFault::Gap(longest_gap_s));
        }
        Ok(Self { lags_s, longest_gap_s })
    }

    /// Lags over gaps of at most twice the median step of a set's rows.
    pub fn of(lags_s: Vec<f64>, data: &Dataset) -> Result<Self, LagFault> {
        let mut steps = Vec::new();
        for one in data.recordings() {
            let times = || data.moments(one).map(|(_, time_s, _)| time_s);
            steps.extend(times().zip(times().skip(1)).map(|(a, b)| b - a));
        }
        steps.retain(|step| step.is_finite() && *step > 0.0);
        steps.sort_by(f64::total_cmp);
        let median = steps.get(steps.len() / 2).ok_or(LagFault::Step)?;
        Self::new(lags_s, 2.0 * median)
    }

    /// The lags, seconds.
    #[must_use]
    pub fn lags_s(&self) -> &[f64] {
        &self.lags_s
    }

    /// The names of all inputs: those given, then those of each lag.
    #[must_use]
    pub fn names(&self, inputs: &[String]) -> Vec<String> {
        let of = |lag: &f64| inputs.iter().map(|name| format!("{name}@-{lag}s")).collect::<Vec<_>>();
        inputs.iter().cloned().chain(self.lags_s.iter().flat_map(of)).collect()
    }

    /// A set with the lags' inputs.
    ///
    /// # Errors
    /// [`LagFault::History`] where no row has enough, [`LagFault::Dataset`] where a name would come twice.
    pub fn expand(&self, data: &Dataset) -> Result<Lagged, LagFault> {
        let inputs = data.inputs().len();
        let width = inputs * (1 + self.lags_s.len());
        let (mut wide, mut kept, mut recordings) = (Vec::new(), Vec::new(), Vec::new());
        let mut out = vec![0.0; width];
        for one in data.recordings() {
            let mut stream = self.stream(inputs);
            let start = kept.len();
            for (row, time_s, x) in data.moments(one) {
                let has_history = stream.push(time_s, x, &mut out);
                if let Some(row) = row.filter(|_| has_history) {
                    wide.extend_from_slice(&out);
                    kept.push(row);
                }
            }
            if kept.len() > start {
                recordings.push(Recording { rows: start..kept.len(), ..one.clone() });
            }
        }
        if kept.is_empty() {
            let longest_s = self.longest_s();
            if data.time_s().iter().all(|time| time.is_nan()) {
                return Err(LagFault::NoTime { longest_s });
            }
            return Err(LagFault::History { rows: data.rows(), longest_s, gap_s: self.longest_gap_s });
        }
        let x = Array2::from_shape_vec((kept.len(), width), wide).expect("a whole row was added each time");
        let rows = data.only_rows(&kept);
        let time = rows.time_s().to_vec();
        let names = self.names(data.inputs());
        let wide = Dataset::new(names, data.targets().to_vec(), time, x, rows.y().clone(), recordings)?;
        Ok(Lagged { dropped: data.rows() - kept.len(), data: wide, kept })
    }

    /// The same for rows that come one by one, of so many photodiodes.
    #[must_use]
    pub fn stream(&self, inputs: usize) -> LagStream {
        LagStream::new(self.clone(), inputs)
    }

    fn longest_s(&self) -> f64 {
        self.lags_s.iter().copied().fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests;
