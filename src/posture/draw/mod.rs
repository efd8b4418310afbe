//! Pictures of the angles, and the overlay on the video.

pub(in crate::posture) mod figures;
pub(in crate::posture) mod overlay;
