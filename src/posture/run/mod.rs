//! The job: its plan, its run, its results, and what a pipeline has to know of it.

pub(in crate::posture) mod filmed_clock;
pub(in crate::posture) mod job;
pub(in crate::posture) mod kind;
pub(in crate::posture) mod plan;
pub(in crate::posture) mod report;
pub(in crate::posture) mod results;
