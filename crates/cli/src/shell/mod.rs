//! What a shell wants of the program: completions, manual pages.

pub(crate) mod completions;
pub(crate) mod man;
