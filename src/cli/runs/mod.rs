//! The commands of pipelines: run, merge, init.

pub(in crate::cli) mod init;
pub(in crate::cli) mod memory;
pub(in crate::cli) mod merge;
pub(in crate::cli) mod run;
