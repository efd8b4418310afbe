//! Which way flexion turns a segment of the finger on the picture, and which angles a finger can have.

mod plausible;

pub(crate) use plausible::{Plausibility, doubts};

/// Which way flexion turns a segment on the shown picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Flexion {
    /// Clockwise.
    Clockwise,
    /// Counterclockwise.
    Counterclockwise,
}

impl Flexion {
    /// 1 where an angle that grows clockwise is flexion, else -1.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Clockwise => 1.0,
            Self::Counterclockwise => -1.0,
        }
    }

    /// Its name in a marker file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Clockwise => "clockwise",
            Self::Counterclockwise => "counterclockwise",
        }
    }
}
