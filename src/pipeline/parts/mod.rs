//! Runs cut into parts, each in a folder of its own, and the parts brought together.

pub(in crate::pipeline) mod merge;
pub(in crate::pipeline) mod shard;
