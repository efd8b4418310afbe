//! Radau IIA collocation with 3, 5 and 7 stages (orders 5, 9, 13) for walls that meet in one pressure.
//!
//! In: a [`Model`], the state at a step's start, the inputs at its stages, a step size. Out: the collocation polynomial
//! of lumens and rates over the step, an estimate of its error, or why there is none ([`Attempt`]).
//!
//! The methods are L-stable and stiffly accurate (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II,
//! 1996, IV.5 and IV.8; doi:10.1007/978-3-642-05221-7). The unknowns are the increments of the rates over the step, in
//! coordinates along the eigenvectors of `A^-1`; those of the lumens follow from `l' = w` without an equation of their
//! own. The Newton matrices are then `n + 1` numbers on a diagonal and a product of two vectors ([`factors`]), so that
//! a Jacobian and its factors cost less than an iteration and are computed again for every step, in its middle.
//!
//! [`Model`]: crate::Model

#![allow(clippy::needless_range_loop, reason = "lanes and walls of several arrays are indexed alike")]

mod estimate;
mod factors;
mod first;
mod newton;
mod root;
mod step;
mod table;
mod tables;

pub(crate) use root::{root, rough_root};
pub(crate) use step::{Attempt, Bounds, Stepper};
pub(crate) use table::Table;
pub(crate) use tables::{RADAU5, RADAU9, RADAU13};
