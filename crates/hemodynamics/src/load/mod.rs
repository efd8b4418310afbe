//! Loads on the fingertip and the blood's own pressures over time, with the times at which they break.
//!
//! A [`Load`] is a pressure over time, made of smooth pieces. Where two pieces meet, the load jumps or bends: a
//! breakpoint, on which a solver has to end its step, or it steps over a short pulse and never knows. At a breakpoint
//! the load has the value of the piece that begins there. [`Loads`] are the four inputs `u = [P_H P_L P_F1 P_F2]` of
//! equation 2; a [`Segment`] is all four between two breakpoints.

mod parse;
mod segment;

use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

use segment::Piece;
pub use segment::{Inputs, Loads, Segment};

/// A pressure over time, Pa over s.
#[derive(Clone)]
pub struct Load {
    kind: Kind,
    breakpoints: Vec<f64>,
}

/// Pressure (Pa) over time (s) as a function.
type Function = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

#[derive(Clone)]
enum Kind {
    Constant(f64),
    /// Level between two times, 0 outside.
    Step(f64),
    /// From one level to another between two times, held outside.
    Ramp(f64, f64),
    /// Mean, amplitude, frequency (Hz).
    Sine(f64, f64, f64),
    /// Values at the breakpoints, straight between them, held outside.
    Table(Vec<f64>),
    Function(Function),
}

/// What is wrong with a load.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum LoadFault {
    #[error("{what} of the load is {value}; it has to be a finite number")]
    NotFinite { what: String, value: f64 },
    #[error("the load's times have to grow: {time} s (row {row}) comes after {before} s")]
    Order {
        /// The row of the later time, from 1.
        row: usize,
        time: f64,
        before: f64,
    },
    #[error("the load's table has {times} times and {values} values; it needs a value for each of at least one time")]
    Rows { times: usize, values: usize },
    #[error(
        "{0:?} is not a load: write 0, step:5000@0..2, ramp:0..10000@0..5 or sine:5000+1000@0.05 (pascals, seconds, \
         hertz)"
    )]
    Text(String),
}

impl Load {
    /// The same pressure at all times, Pa.
    pub fn constant(value_pa: f64) -> Result<Load, LoadFault> {
        finite(&[("the value", value_pa)])?;
        Ok(Load { kind: Kind::Constant(value_pa), breakpoints: vec![] })
    }

    /// `height_pa` from `from_s` until just before `to_s`, 0 outside. A negative height sucks.
    pub fn step(height_pa: f64, from_s: f64, to_s: f64) -> Result<Load, LoadFault> {
        finite(&[("the height", height_pa), ("the start", from_s), ("the end", to_s)])?;
        Load::between(Kind::Step(height_pa), from_s, to_s)
    }

    /// Straight from `first_pa` at `from_s` to `last_pa` at `to_s`; `first_pa` before and `last_pa` after.
    pub fn ramp(first_pa: f64, last_pa: f64, from_s: f64, to_s: f64) -> Result<Load, LoadFault> {
        finite(&[
            ("the first value", first_pa),
            ("the last value", last_pa),
            ("the start", from_s),
            ("the end", to_s),
        ])?;
        finite(&[("the rise", last_pa - first_pa), ("the time from start to end", to_s - from_s)])?;
        Load::between(Kind::Ramp(first_pa, last_pa), from_s, to_s)
    }

    /// `mean + amplitude sin(2 pi frequency t)`, Pa; `frequency_hz` in 1/s; a negative one begins downwards, 0 is the
    /// mean alone.
    pub fn sine(mean_pa: f64, amplitude_pa: f64, frequency_hz: f64) -> Result<Load, LoadFault> {
        finite(&[("the mean", mean_pa), ("the amplitude", amplitude_pa), ("the frequency", TAU * frequency_hz)])?;
        if amplitude_pa == 0.0 || frequency_hz == 0.0 {
            return Load::constant(mean_pa);
        }
        Ok(Load { kind: Kind::Sine(mean_pa, amplitude_pa, frequency_hz), breakpoints: vec![] })
    }

    /// How often a sine repeats, 1/s; none of other loads.
    #[must_use]
    pub fn frequency_hz(&self) -> Option<f64> {
        if let Kind::Sine(.., frequency_hz) = self.kind { Some(frequency_hz) } else { None }
    }

    /// Straight between the rows of a table, its first and last value held outside. Every time is a breakpoint.
    pub fn table(times_s: &[f64], values_pa: &[f64]) -> Result<Load, LoadFault> {
        if times_s.is_empty() || times_s.len() != values_pa.len() {
            return Err(LoadFault::Rows { times: times_s.len(), values: values_pa.len() });
        }
        for (row, (&time, &value)) in times_s.iter().zip(values_pa).enumerate() {
            let row = row + 1;
            for (what, value) in [("time", time), ("value", value)] {
                if !value.is_finite() {
                    return Err(LoadFault::NotFinite { what: format!("the {what} in row {row}"), value });
                }
            }
        }
        for (row, pair) in times_s.windows(2).enumerate() {
            if pair[1] <= pair[0] {
                return Err(LoadFault::Order { row: row + 2, time: pair[1], before: pair[0] });
            }
            let rise = values_pa[row + 1] - values_pa[row];
            finite(&[
                (&format!("the rise to row {}", row + 2), rise),
                (&format!("the time to row {}", row + 2), pair[1] - pair[0]),
            ])?;
        }
        Ok(Load { kind: Kind::Table(values_pa.to_vec()), breakpoints: times_s.to_vec() })
    }

    /// Any function of time (Pa over s), smooth between the breakpoints. At a breakpoint it is evaluated just
    /// before it for the piece that ends there.
    pub fn function(
        pressure_pa: impl Fn(f64) -> f64 + Send + Sync + 'static,
        breakpoints_s: &[f64],
    ) -> Result<Load, LoadFault> {
        for (row, &time) in breakpoints_s.iter().enumerate() {
            finite(&[(&format!("breakpoint {}", row + 1), time)])?;
            if row > 0 && time <= breakpoints_s[row - 1] {
                return Err(LoadFault::Order { row: row + 1, time, before: breakpoints_s[row - 1] });
            }
        }
        Ok(Load { kind: Kind::Function(Arc::new(pressure_pa)), breakpoints: breakpoints_s.to_vec() })
    }

    /// The times at which the load jumps or bends, s, growing.
    pub fn breakpoints(&self) -> &[f64] {
        &self.breakpoints
    }

    /// The pressure at a time, Pa; at a breakpoint that of the piece that begins there.
    pub fn at(&self, time_s: f64) -> f64 {
        self.piece(self.breakpoints.partition_point(|&at| at <= time_s)).at(time_s)
    }

    /// The pressure just before a time, Pa.
    pub fn before(&self, time_s: f64) -> f64 {
        self.piece(self.breakpoints.partition_point(|&at| at < time_s)).at(time_s)
    }

    fn between(kind: Kind, from_s: f64, to_s: f64) -> Result<Load, LoadFault> {
        if to_s <= from_s {
            return Err(LoadFault::Order { row: 2, time: to_s, before: from_s });
        }
        Ok(Load { kind, breakpoints: vec![from_s, to_s] })
    }

    /// The piece after `passed` breakpoints.
    fn piece(&self, passed: usize) -> Piece {
        let line = |from: [f64; 2], to: [f64; 2]| {
            if from[1] == to[1] { Piece::Constant(from[1]) } else { Piece::Line { from, to } }
        };
        let times = &self.breakpoints;
        match &self.kind {
            Kind::Constant(value) => Piece::Constant(*value),
            Kind::Step(height) => Piece::Constant(if passed == 1 { *height } else { 0.0 }),
            Kind::Ramp(first, last) => match passed {
                0 => Piece::Constant(*first),
                1 => line([times[0], *first], [times[1], *last]),
                _ => Piece::Constant(*last),
            },
            Kind::Sine(mean, amplitude, frequency) => {
                Piece::Sine { mean: *mean, amplitude: *amplitude, angular: TAU * frequency }
            }
            Kind::Table(values) => match passed {
                0 => Piece::Constant(values[0]),
                k if k == values.len() => Piece::Constant(values[k - 1]),
                k => line([times[k - 1], values[k - 1]], [times[k], values[k]]),
            },
            Kind::Function(function) => {
                let until = times.get(passed).copied();
                Piece::Function { function: Arc::clone(function), until }
            }
        }
    }
}

impl fmt::Debug for Load {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind: &dyn fmt::Debug = match &self.kind {
            Kind::Constant(value) => &("constant", *value),
            Kind::Step(height) => &("step", *height),
            Kind::Ramp(first, last) => &("ramp", *first, *last),
            Kind::Sine(mean, amplitude, frequency) => &("sine", *mean, *amplitude, *frequency),
            Kind::Table(values) => &("table", values.clone()),
            Kind::Function(_) => &"function",
        };
        f.debug_struct("Load").field("kind", kind).field("breakpoints", &self.breakpoints).finish()
    }
}

fn finite(numbers: &[(&str, f64)]) -> Result<(), LoadFault> {
    match numbers.iter().find(|(_, value)| !value.is_finite()) {
        Some((what, value)) => Err(LoadFault::NotFinite { what: (*what).to_owned(), value: *value }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
