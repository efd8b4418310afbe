//! The rows of a log: cells, time stamps, their order, faults of the sensor.

pub(in crate::log) mod cell;
pub(in crate::log) mod order;
pub(in crate::log) mod rows;
pub(in crate::log) mod stamps;
pub(in crate::log) mod status;
