//! The job: its plan, its run, and what a pipeline has to know of it.

pub(in crate::layout) mod job;
pub(in crate::layout) mod kind;
pub(in crate::layout) mod plan;
pub(in crate::layout) mod report;
mod results;
