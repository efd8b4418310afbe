//! What is measured: scenes, rows of the table, times in turns.

pub(in crate::tradeoff) mod plan;
pub(in crate::tradeoff) mod rows;
pub(in crate::tradeoff) mod scenes;
pub(in crate::tradeoff) mod timing;
