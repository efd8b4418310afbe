//! Why a transient was not solved.

use super::trajectory::Trajectory;
use crate::parameters::Site;
use crate::state::StateFault;

/// Why a transient was not solved.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum SolveFault {
    #[error("the start can't be used: {0}")]
    Start(#[from] StateFault),
    #[error("no times are asked for; at least one is needed")]
    NoTimes,
    #[error("the times asked for have to be finite and must not fall: {time_s} s (row {row}) comes after {before_s} s")]
    Times {
        /// The row, from 1.
        row: usize,
        time_s: f64,
        before_s: f64,
    },
    #[error("the tolerance is {rtol}; it has to be between 1e-13 and 1e-1")]
    Tolerance { rtol: f64 },
    #[error("{what} is {value} s; it has to be a finite time, and a step longer than 0")]
    Option { what: &'static str, value: f64 },
    #[error("the load {load} is {value} at {time_s} s; it has to be a finite pressure at every time of the run")]
    Load { load: &'static str, time_s: f64, value: f64 },
    #[error(
        "{site} closes at {time_s} s; the model ends there, unless walls are given contact (collapse policy \
         `contact`, --collapse contact)"
    )]
    Collapsed {
        site: Site,
        /// When, s: to 1e-9 s where the lumen falls through zero by 1e-4 / s or faster, else to about 1e-13 over that
        /// rate. A vessel that exactly balances its load (`P_F1 = P_H + k D / A_s` of the vein) thins out for ever, and
        /// the time is that of its rounding.
        time_s: f64,
        before: Box<Trajectory>,
    },
    #[error("{evaluations} evaluations were spent by {time_s} s; allow more of them, or a larger tolerance")]
    Work { evaluations: u64, time_s: f64, before: Box<Trajectory> },
    #[error(
        "no step from {time_s} s on came through, down to {step_s:e} s: {}",
        .site.map_or_else(|| "the equations can't be solved there".to_owned(), |site| format!("{site} closes in it"))
    )]
    Stuck {
        time_s: f64,
        step_s: f64,
        /// The vessel that closed in it, if it was that.
        site: Option<Site>,
        before: Box<Trajectory>,
    },
}
