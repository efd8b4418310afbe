//! What a shell wants of the program: completions, manual pages.

pub(in crate::cli) mod completions;
pub(in crate::cli) mod man;
