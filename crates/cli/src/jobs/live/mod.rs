//! The commands of a sensor at work, and of what is made of its recordings: `lunula live`, `record`, `switch`, `skill`,
//! `performance`.

pub(crate) mod performance;
pub(crate) mod prompt;
pub(crate) mod session;
pub(crate) mod skill;
pub(crate) mod switch;
