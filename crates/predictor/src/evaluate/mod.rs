//! How good a model is on rows that it has not seen.
//!
//! In: predictions and measurements, or a set with how to fit and how to predict (two closures: any model will do).
//! Out: figures with their units, all of which can be written as JSON. Up to down: [`split`] what is held out,
//! [`cross`] what comes of it, [`score`] how far off, [`magnitude`] where, [`interval`] and [`coverage`] how sure,
//! [`learning`] with how much data, [`splits`] what shuffled rows and repeated
//! paths flatter, [`rows`] whether rows were seen after all.

mod coverage;
mod cross;
#[cfg(test)]
pub(crate) mod fixture;
mod interval;
mod learning;
mod magnitude;
mod rows;
mod score;
mod split;
mod splits;
pub(crate) mod sum;

pub use coverage::{Coverage, CrossCoverage, coverage, cross_coverage, nested_coverage};
pub use cross::{CrossFault, CrossValidation, Flattery, FoldResult, cross_validate};
pub use interval::{IntervalFault, Intervals, calibrate};
pub use learning::{LearningFault, LearningPoint, learn_by_recordings, learn_by_share};
pub use magnitude::{Bin, ByMagnitude, MagnitudeFault, by_magnitude, magnitude_edges};
pub(crate) use rows::hex;
pub use rows::{recording_hashes, row_hashes, shared_rows};
pub use score::{Scores, TargetScore, score};
pub use split::{By, Fold, SplitFault, folds};
pub use splits::{
    FEWEST_UNITS, Fit, Leak, Method, MethodScore, Predict, Split, SplitTarget, compare_splits, flatteries, leaks,
};
