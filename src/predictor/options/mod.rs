//! What the predictors are asked for: the options of the commands and of pipelines' stages, and their choices.

pub(in crate::predictor) mod choices;
pub(in crate::predictor) mod commands;
pub(in crate::predictor) mod target;
