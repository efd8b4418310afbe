//! The commands of a sensor at work: `lunula live`, `record`, `switch`.

pub(crate) mod session;
pub(crate) mod switch;
