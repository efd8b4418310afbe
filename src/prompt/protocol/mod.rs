//! The protocol of a session (5.2.4) as a file: which steps, in which order, what is said and checked before each.
//!
//! In: TOML, `[[step]]` one after the other; out: a [`Protocol`], or every fault of the file with its line. The thesis
//! prompts force before bending in 5.2.1 and 5.2.4, and bending before force in Fig. 94 and the random test: the order
//! is the file's.

mod motion;
mod read;

use std::path::Path as FilePath;

use lunula_predictor::ForceSpace;

pub use motion::{Gauge, GaugeAxis, Motion, Path, Prompted};
pub use read::ProtocolError;

use crate::words::Words;

/// The protocol of 5.2.4, as a file.
pub const THESIS: &str = include_str!("thesis.toml");

/// A session's steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Protocol {
    /// The cone that is to be covered.
    pub space: ForceSpace,
    /// In their order, at least one.
    pub steps: Vec<Step>,
}

/// A step.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Its name, in the recording's column `trajectory`.
    pub name: String,
    /// What is said of it.
    pub text: String,
    /// What happens.
    pub kind: StepKind,
    /// Whether its rows are recorded.
    pub collects: bool,
    /// Whether it begins when the person says so, or by itself after the one before.
    pub waits: bool,
    /// The recording's column `session`.
    pub session: u32,
    /// What has to hold: before the next step where nothing moves, else during the movement.
    pub checks: Vec<Check>,
}

/// What happens in a step.
#[derive(Debug, Clone, PartialEq)]
pub enum StepKind {
    /// Something is said, and the person says when it is done.
    Ask,
    /// Checks; the next step has to wait for them.
    Check,
    /// The prompt moves.
    Move(Motion),
}

/// A check of the set-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Check {
    /// Each photodiode changes, and none is at an end of its range.
    Photodiodes,
    /// The force is zero while the finger is lifted.
    Tare,
    /// Pressing down is a negative Fz.
    Sign,
    /// No photodiode jumps while the finger bends: the sensor sticks.
    Adhesion,
}

impl Words for Check {
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Photodiodes, "photodiodes", ""),
        (Self::Tare, "tare", ""),
        (Self::Sign, "sign", ""),
        (Self::Adhesion, "adhesion", ""),
    ];
}

impl Protocol {
    /// The protocol of 5.2.4.
    ///
    /// # Panics
    /// Never: a test reads it.
    #[must_use]
    pub fn thesis() -> Self {
        match Self::parse(THESIS, FilePath::new("thesis.toml")) {
            Ok(protocol) => protocol,
            Err(why) => panic!("{why}"),
        }
    }

    /// The largest pressing that any step prompts, or the cone's, newtons: what the colours go up to.
    #[must_use]
    pub fn scale_n(&self) -> f64 {
        let fz_max_n = self.space.fz_max_n();
        let moves = self.steps.iter().filter_map(Step::motion);
        moves.map(|motion| motion.largest_n(fz_max_n)).fold(fz_max_n, f64::max)
    }
}

impl Step {
    /// How it moves, if it does.
    #[must_use]
    pub fn motion(&self) -> Option<&Motion> {
        match &self.kind {
            StepKind::Move(motion) => Some(motion),
            StepKind::Ask | StepKind::Check => None,
        }
    }
}

#[cfg(test)]
mod tests;
