//! The formats of logs: text, Parquet, XDF.

pub(in crate::log) mod parquet;
mod preamble;
pub(in crate::log) mod raw;
pub(in crate::log) mod split;
pub(in crate::log) mod text;
#[cfg(feature = "xdf")]
pub(in crate::log) mod xdf;
