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
#[allow(missing_docs, reason = "the messages say it")]
pub enum LeastSquaresFault {
    #[error("{design} rows of the design, {targets} of the targets")]
    Rows { design: usize, targets: usize },
    #[error("there are no rows")]
    NoRows,
    #[error(
        "column {column} of the {} is not finite in row {row}; leave the row out",
        if *.target { "targets" } else { "design" }
    )]
    NotFinite {
        /// Of the targets, else of the design.
        target: bool,
        row: usize,
        column: usize,
    },
    #[error("{columns} terms need at least {} rows; there are {rows}", .columns + 1)]
    TooFewRows { rows: usize, columns: usize },
    #[error(
        "the columns depend on each other: constant {constant:?}, following from others {dependent:?}; leave them \
         out, or ask for minimum norm, dropping or ridge"
    )]
    Deficient { constant: Vec<usize>, dependent: Vec<Dependent> },
    #[error("a ridge of {0}: it must be above 0 and finite")]
    Ridge(f64),
    #[error("the normal equations can't be inverted; use the orthogonal solver")]
    Singular,
    #[error(
        "the coefficient of column {column} for target {target} is beyond 1e308 or below 1e-308; scale the column or \
         the target"
    )]
    Range { column: usize, target: usize },
}
