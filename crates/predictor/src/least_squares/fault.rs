//! Why there is no fit.

use thiserror::Error;

/// A column that follows from others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dependent {
    /// From 0.
    pub column: usize,
    /// From which, ascending; one means that both read alike up to offset and scale.
    pub with: Vec<usize>,
}

/// Why there is no fit. Columns and rows count from 0.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LeastSquaresFault {
    /// Design and targets do not agree.
    #[error("{design} rows of the design, {targets} of the targets")]
    Rows {
        /// Rows of the design.
        design: usize,
        /// Rows of the targets.
        targets: usize,
    },
    /// Nothing to fit to.
    #[error("there are no rows")]
    NoRows,
    /// A value is NaN or infinite.
    #[error(
        "column {column} of the {} is not finite in row {row}; leave the row out",
        if *.target { "targets" } else { "design" }
    )]
    NotFinite {
        /// Of the targets, else of the design.
        target: bool,
        /// From 0.
        row: usize,
        /// From 0.
        column: usize,
    },
    /// Fewer rows than unknowns.
    #[error("{columns} terms need at least {} rows; there are {rows}", .columns + 1)]
    TooFewRows {
        /// How many there are.
        rows: usize,
        /// Columns of the design.
        columns: usize,
    },
    /// Columns depend on each other.
    #[error(
        "the columns depend on each other: constant {constant:?}, following from others {dependent:?}; leave them \
         out, or ask for minimum norm, dropping or ridge"
    )]
    Deficient {
        /// Columns that are constant.
        constant: Vec<usize>,
        /// Columns that follow from others.
        dependent: Vec<Dependent>,
    },
    /// A ridge that is none.
    #[error("a ridge of {0}: it must be above 0 and finite")]
    Ridge(f64),
    /// The normal equations have no inverse.
    #[error("the normal equations can't be inverted; use the orthogonal solver")]
    Singular,
    /// A result is beyond what a number can hold.
    #[error(
        "the coefficient of column {column} for target {target} is beyond 1e308 or below 1e-308; scale the column or \
         the target"
    )]
    Range {
        /// From 0.
        column: usize,
        /// From 0.
        target: usize,
    },
}
