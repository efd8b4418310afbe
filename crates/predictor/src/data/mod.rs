//! Measured rows, and voltages of earlier rows as further inputs.

pub(crate) mod dataset;
pub(crate) mod lags;
