//! Measured rows, voltages of earlier rows as further inputs, which recordings follow one path or are parts of one
//! another, whether their columns are on one clock, and whether their parts agree on which column is which.

pub(crate) mod dataset;
pub(crate) mod delay;
pub(crate) mod lags;
pub(crate) mod mismatch;
pub(crate) mod path;
pub(crate) mod shared;
