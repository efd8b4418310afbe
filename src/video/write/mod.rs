//! Pictures with given times to a file.

pub(in crate::video) mod codec;
pub(in crate::video) mod encode;
mod mp4;
