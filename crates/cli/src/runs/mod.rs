//! The commands of pipelines: run, merge, init.

pub(crate) mod init;
pub(crate) mod memory;
pub(crate) mod merge;
pub(crate) mod run;
