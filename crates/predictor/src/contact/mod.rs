//! Whether the finger touches, and which forces friction allows while it does.

pub(crate) mod friction;
pub(crate) mod gate;
