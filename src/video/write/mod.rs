//! Pictures with given times to a file.

pub(in crate::video) mod encode;
pub(in crate::video) mod upright;
