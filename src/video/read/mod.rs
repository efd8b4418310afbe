//! Frames of a file with their own time, and what of the file is missing.

pub(in crate::video) mod ahead;
pub(in crate::video) mod decode;
pub(in crate::video) mod extent;
pub(in crate::video) mod header;
pub(in crate::video) mod hidden;
pub(in crate::video) mod order;
pub(in crate::video) mod reader;
pub(in crate::video) mod source;
