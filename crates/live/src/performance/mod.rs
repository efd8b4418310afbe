//! Time per decision and how it is learned (thesis, appendix C).
//!
//! In: how long operators took for a course, trial by trial, with one method of control or another. Out: time per
//! decision ([`Course`]), learning curves ([`Curve`]), and methods held against each other by the same operators
//! ([`Paired`]). Times are seconds, trials are counted from 1.

mod course;
mod curve;
mod filled;
mod paired;

pub use course::Course;
pub use curve::{Curve, FEWEST_TRIALS, LEVEL, Law, LevelAt, Measured, NoCurve, Point};
pub use filled::filled_means;
pub use paired::Paired;
