//! What a job is asked for, by a word, and what it does where it is not asked.

use lunula_predictor::{By, Kind, OnScores};

use crate::words::Words;

/// Hidden nodes of a network.
pub const HIDDEN: u16 = 8;
/// The share of rows that prediction intervals are to hold.
pub const LEVEL: f64 = 0.9;
/// Parts of shuffled rows.
pub const FOLDS: u16 = 10;
/// The pressing from which on the finger touches, newtons.
pub const F_MIN_N: f64 = 0.5;

/// Which model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[allow(missing_docs, reason = "their words say it")]
pub enum ModelChoice {
    #[default]
    Linear,
    Quadratic,
    Network,
    Eigennails,
}

impl ModelChoice {
    /// The model; `hidden`: a network's nodes.
    #[must_use]
    pub fn kind(self, hidden: u16) -> Kind {
        match self {
            Self::Linear => Kind::Linear,
            Self::Quadratic => Kind::Quadratic,
            Self::Network => Kind::Network { hidden: usize::from(hidden) },
            Self::Eigennails => Kind::Eigennails { on_scores: OnScores::Ridge, modes: None },
        }
    }
}

impl Words for ModelChoice {
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Linear, "linear", "Equation 9"),
        (Self::Quadratic, "quadratic", "Equation 16"),
        (Self::Network, "network", "Equations 17 and 18"),
        (Self::Eigennails, "eigennails", "Modes of the nail's picture, of cells C_00_00, C_00_01, .."),
    ];
}

impl Words for OnScores {
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(Self::Ridge, "ridge", "Linear, shrunk"), (Self::Process, "process", "A Gaussian process, with its own SD")];
}

/// What is held out in turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "their words say it")]
pub enum ByChoice {
    Trajectory,
    Path,
    Session,
    Subject,
    Rows,
}

impl ByChoice {
    /// What is held out; `folds` and `seed`: of shuffled rows, in how many parts, and which shuffle.
    #[must_use]
    pub fn by(self, folds: u16, seed: u64) -> By {
        match self {
            Self::Trajectory => By::Trajectory,
            Self::Path => By::Path,
            Self::Session => By::Session,
            Self::Subject => By::Subject,
            Self::Rows => By::Rows { folds: usize::from(folds), seed },
        }
    }
}

impl Words for ByChoice {
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Trajectory, "trajectory", "Each recording"),
        (Self::Path, "path", "All recordings that follow one prompted path"),
        (Self::Session, "session", "All recordings of a subject's session"),
        (Self::Subject, "subject", "All recordings of a subject"),
        (Self::Rows, "rows", "Shuffled rows, which flatters"),
    ];
}

/// A share of rows.
///
/// # Errors
/// What is none, in words.
pub fn share(level: f64) -> Result<f64, String> {
    if level > 0.0 && level < 1.0 { Ok(level) } else { Err("is a share between 0 and 1, as 0.9".to_owned()) }
}
