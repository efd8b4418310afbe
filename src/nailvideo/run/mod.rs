//! The job: its plan, its run, its results, and what a pipeline has to know of it.

mod draw;
pub(in crate::nailvideo) mod job;
pub(in crate::nailvideo) mod kind;
pub(in crate::nailvideo) mod plan;
pub(in crate::nailvideo) mod report;
mod results;
mod tint;
mod traces;
