//! Figures of merit: RMSE, bias and R2 of each target, and the table of them.

pub(in crate::predictor) mod doubts;
pub(in crate::predictor) mod figures;
pub(in crate::predictor) mod table;
