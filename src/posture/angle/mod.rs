//! From centres to joint angles: lens, picture as shown, joints, smoothing, and whether a finger can have such angles.

mod cut;
mod frozen;
pub(super) mod joints;
mod lengths;
pub(super) mod lens;
mod metric;
mod plane;
pub(super) mod readout;
pub(super) mod smooth;
pub(super) mod view;
