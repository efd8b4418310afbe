//! Which column of a log is what: named by the user, by its header, or guessed.

pub(in crate::log) mod columns;
pub(in crate::log) mod groups;
pub(in crate::log) mod guess;
pub(in crate::log) mod header;
pub(in crate::log) mod role;
