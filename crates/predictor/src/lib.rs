//! Touch force and finger posture from the photodiodes of a fingernail sensor: chapter 5 of S. Mascaro's thesis.
//!
//! In: a [`Dataset`], voltages of photodiodes with the forces or the joint angle measured at the same time. Out: a
//! [`Model`] that estimates forces or angle from voltages, with its known accuracy.
//!
//! Conventions: a row is a moment; arrays are rows x inputs or rows x targets. Voltages are volts, forces newtons and
//! those of the finger on the surface (pressing is a negative `Fz_N`), angles degrees, positive in flexion. What is not
//! known is missing (`None`, NaN), never zero.
//!
//! No pictures, no files but the model's own, no command line.

mod algebra;
mod contact;
mod data;
mod evaluate;
mod fit;
mod least_squares;
mod model;
mod network;
mod predictor;
mod subsets;
mod trajectory;

pub use algebra::svd::{Modes, modes};
pub use contact::friction::{FrictionCone, FrictionFault};
pub use contact::gate::{Contact, Gate, GateFault, GateState};
pub use data::dataset::{Dataset, DatasetFault, Recording};
pub use data::lags::{LagFault, LagStream, Lagged, Lags};
pub use evaluate::{
    Bin, By, ByMagnitude, Coverage, CrossCoverage, CrossFault, CrossValidation, Effect, EffectFault, Flattery, Fold,
    FoldResult, FoldSpread, IntervalFault, Intervals, LearningFault, LearningPoint, MagnitudeFault, Scores, SplitFault,
    TargetScore, by_magnitude, calibrate, coverage, cross_coverage, cross_validate, dataset_hash, folds,
    friction_effect, lag_effect, learn_by_recordings, learn_by_share, magnitude_edges, nested_coverage,
    recording_hashes, row_hashes, score, shared_rows,
};
pub use fit::{FitFault, FitReport, Printed, fit_linear, fit_quadratic, linear_f0, quadratic_printed};
pub use least_squares::{
    Deficient, Dependent, LeastSquares, LeastSquaresFault, LeastSquaresOptions, Solver, least_squares,
};
pub use model::{Linear, Model, ModelFault, Network, Quadratic, quadratic_terms};
pub use network::{Restart, Stopped, TrainFault, TrainOptions, TrainReport, train_network};
pub use predictor::file::{FileFault, Opened};
pub use predictor::recipe::{FORCES, Fitted, Kind, Recipe, RecipeFault, Report, predict, stopping_rows, with_lags};
pub use predictor::{Channel, Predictor, TrainedOn, Training, unit_of};
pub use subsets::{
    MOST_INPUTS, Subset, SubsetErrors, SubsetFault, Subsets, WithoutOne, backward_elimination, every_subset,
};
pub use trajectory::{
    Bending, CONE_CELLS, ConeCoverage, Density, Evenness, ForceSpace, ForceSpaceFault, Hole, RELEASE_S, RandomBending,
    RandomForce, RateLimits, Spiral, Wave, circling_limit_hz, cone_coverage, percent_error, rate_limit_per_s,
    rate_limits,
};

/// The example of the README, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
