//! Touch force and finger posture from the photodiodes of a fingernail sensor: chapter 5 of S. Mascaro's thesis.
//!
//! In: a [`Dataset`], voltages of photodiodes (or cells of the nail's picture) with the forces or the joint angle
//! measured at the same time. Out: a [`Model`] that estimates forces or angle from voltages, with its known accuracy.
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
pub use data::dataset::{Dataset, DatasetFault, Past, Recording};
pub use data::delay::{Delay, delays};
pub use data::lags::{LagFault, LagStream, Lagged, Lags};
pub use data::mismatch::{Apart, Difference, Mismatch, Parts, beside_model};
pub use data::path::{paths, repeated_paths};
pub use data::shared::{shared, shared_within};
pub use evaluate::{
    Bin, By, ByMagnitude, Coverage, CrossCoverage, CrossFault, CrossValidation, FEWEST_UNITS, Fit, Flattery, Fold,
    FoldResult, IntervalFault, Intervals, Leak, LearningFault, LearningPoint, MagnitudeFault, Method, MethodScore,
    Predict, Scores, Split, SplitFault, SplitTarget, TargetScore, by_magnitude, calibrate, compare_splits, coverage,
    cross_coverage, cross_validate, flatteries, folds, leaks, learn_by_recordings, learn_by_share, magnitude_edges,
    nested_coverage, recording_hashes, row_hashes, score, shared_rows,
};
pub use fit::{
    Directions, EigennailsReport, FitFault, FitReport, OnScores, Printed, fit_eigennails, fit_linear, fit_quadratic,
    linear_f0, quadratic_printed,
};
pub use least_squares::{
    Deficient, Dependent, LeastSquares, LeastSquaresFault, LeastSquaresOptions, Solver, least_squares,
};
pub use model::{
    Basis, Covariance, Eigennails, Linear, Model, ModelFault, Network, Process, Projection, Quadratic, Regression,
    Ridge, quadratic_terms,
};
pub use network::{Restart, Stopped, TrainFault, TrainOptions, TrainReport, train_network};
pub use predictor::file::{FileFault, Opened};
pub use predictor::recipe::{FORCES, Fitted, Kind, Recipe, RecipeFault, Report, predict, stopping_rows, with_lags};
pub use predictor::{Channel, Predictor, TrainedOn, Training, unit_of};
pub use subsets::{
    Candidate, Choice, Criterion, LayoutFault, LayoutProblem, MOST_CANDIDATES, Moments, Proof, Rules, Starts,
    determinant, pivoted, prove, search,
};
pub use subsets::{
    MOST_INPUTS, Subset, SubsetErrors, SubsetFault, Subsets, WithoutOne, backward_elimination, every_subset,
};
pub use trajectory::{
    Bending, CONE_CELLS, ConeCoverage, Density, Evenness, ForceSpace, ForceSpaceFault, Hole, RELEASE_S, RandomBending,
    RandomForce, RateLimits, Spiral, Wave, cell_middle_n, circling_limit_hz, cone_cell, cone_coverage,
    rate_limit_per_s, rate_limits, smooth,
};

/// The example of the README, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
