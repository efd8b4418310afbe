//! How a marker looks in the video's own planes, and where its chroma samples lie.

pub(in crate::posture) mod learn;
pub(in crate::posture) mod look;
pub(in crate::posture) mod siting;
