//! The job: its plan, its run, its results, and what a pipeline has to know of it.

pub(in crate::align) mod job;
pub(in crate::align) mod kind;
pub(in crate::align) mod plan;
pub(in crate::align) mod report;
pub(in crate::align) mod results;
