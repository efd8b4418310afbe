//! The job: its plan, its run, and what a pipeline has to know of it.

pub(in crate::camera) mod job;
pub(in crate::camera) mod kind;
pub(in crate::camera) mod plan;
