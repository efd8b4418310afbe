//! The jobs of the predictors, and what pipelines have to know of them.

pub(in crate::predictor) mod analyse;
pub(in crate::predictor) mod answer;
pub(in crate::predictor) mod evaluate;
pub(in crate::predictor) mod kinds;
pub(in crate::predictor) mod learning;
pub(in crate::predictor) mod predict;
pub(in crate::predictor) mod prune;
pub(in crate::predictor) mod train;
