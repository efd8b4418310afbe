//! A digit's cell: where it is, what it looks like, and which digit that is.

pub(super) mod bank;
pub(super) mod cells;
pub(super) mod half;
pub(super) mod judge;
pub(super) mod look;
pub(super) mod names;
