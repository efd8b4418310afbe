//! Why a transient was not solved.

use super::trajectory::Trajectory;
use crate::parameters::Site;
use crate::state::StateFault;

/// Why a transient was not solved.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
pub enum SolveFault {
    /// The state to start from.
    #[error("the start can't be used: {0}")]
    Start(#[from] StateFault),
    /// No time asked for.
    #[error("no times are asked for; at least one is needed")]
    NoTimes,
    /// A time that is not a number, or is before the one that it follows.
    #[error("the times asked for have to be finite and must not fall: {time_s} s (row {row}) comes after {before_s} s")]
    Times {
        /// The row, from 1.
        row: usize,
        /// The time.
        time_s: f64,
        /// The time before it, or the start of the run.
        before_s: f64,
    },
    /// A tolerance that can't be held.
    #[error("the tolerance is {rtol}; it has to be between 1e-13 and 1e-1")]
    Tolerance {
        /// The tolerance.
        rtol: f64,
    },
    /// Another option that has no meaning.
    #[error("{what} is {value} s; it has to be a finite time, and a step longer than 0")]
    Option {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A load that is not a number.
    #[error("the load {load} is {value} at {time_s} s; it has to be a finite pressure at every time of the run")]
    Load {
        /// `P_H`, `P_L`, `P_F1` or `P_F2`.
        load: &'static str,
        /// When, s.
        time_s: f64,
        /// Its value.
        value: f64,
    },
    /// A vessel closed.
    #[error(
        "{site} closes at {time_s} s; the model ends there, unless walls are given contact (collapse policy `contact`)"
    )]
    Collapsed {
        /// Which.
        site: Site,
        /// When, s: to 1e-9 s where the lumen falls through zero by 1e-4 / s or faster, else to about 1e-13 over that
        /// rate. A vessel that exactly balances its load (`P_F1 = P_H + k D / A_s` of the vein) thins out for ever, and
        /// the time is that of its rounding.
        time_s: f64,
        /// The run before.
        before: Box<Trajectory>,
    },
    /// The evaluations allowed were spent.
    #[error("{evaluations} evaluations were spent by {time_s} s; allow more of them, or a larger tolerance")]
    Work {
        /// How many.
        evaluations: u64,
        /// How far the run came, s.
        time_s: f64,
        /// The run before.
        before: Box<Trajectory>,
    },
    /// No step came through.
    #[error(
        "no step from {time_s} s on came through, down to {step_s:e} s: {}",
        .site.map_or_else(|| "the equations can't be solved there".to_owned(), |site| format!("{site} closes in it"))
    )]
    Stuck {
        /// Where, s.
        time_s: f64,
        /// The smallest step tried, s.
        step_s: f64,
        /// The vessel that closed in it, if it was that.
        site: Option<Site>,
        /// The run before.
        before: Box<Trajectory>,
    },
}
