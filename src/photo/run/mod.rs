//! The job: its plan, its run, its report, and what a pipeline has to know of it.

pub(in crate::photo) mod doubts;
pub(in crate::photo) mod job;
pub(in crate::photo) mod kind;
pub(in crate::photo) mod plan;
pub(in crate::photo) mod report;
