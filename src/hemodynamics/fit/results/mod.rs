//! The files of a fit beside its result: a table of estimates, parameters to simulate with, a picture.

pub(super) mod estimates;
pub(super) mod figure;
pub(super) mod parameter_files;
