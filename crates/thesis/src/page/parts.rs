//! The parts of a study: the title, numbers and tables of each.

use std::path::Path;

use anyhow::anyhow;

use crate::coloration::coloration_numbers;
use crate::numbers::Numbers;
use crate::predictors::{compare_numbers, evaluation_numbers, modes_numbers};

/// A part of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Responses to normal force (3.3.2).
    Normal,
    /// Responses to lateral shear (3.3.3).
    Lateral,
    /// Responses to longitudinal shear (3.3.4).
    Longitudinal,
    /// Responses to bending (3.3.5).
    Bending,
    /// One subject's coloration (Fig. 51, 52).
    Typical,
    /// Average coloration (4.2.2).
    Photos,
    /// The hemodynamic model simulated (4.3.3).
    Section,
    /// Slow and quick presses (4.3.4).
    Presses,
    /// The calibration trajectory (5.2).
    Calibration,
    /// The touch model on what it was trained on (5.3.1).
    TouchTraining,
    /// The touch model on the third repetition.
    TouchValidation,
    /// The touch model on random touching.
    TouchTest,
    /// The touch model's modes (Fig. 98).
    Modes,
    /// The posture model on what it was trained on (5.3.2).
    PostureTraining,
    /// The posture model on new data.
    PostureValidation,
    /// Models compared over subjects (5.4, 5.5).
    Compare,
}

impl Part {
    /// All, in the thesis' order.
    pub const ALL: [Self; 16] = [
        Self::Normal,
        Self::Lateral,
        Self::Longitudinal,
        Self::Bending,
        Self::Typical,
        Self::Photos,
        Self::Section,
        Self::Presses,
        Self::Calibration,
        Self::TouchTraining,
        Self::TouchValidation,
        Self::TouchTest,
        Self::Modes,
        Self::PostureTraining,
        Self::PostureValidation,
        Self::Compare,
    ];

    /// Its name in pipeline files, and before its numbers' names.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::Lateral => "lateral",
            Self::Longitudinal => "longitudinal",
            Self::Bending => "bending",
            Self::Typical => "typical",
            Self::Photos => "photos",
            Self::Section => "section",
            Self::Presses => "presses",
            Self::Calibration => "calibration",
            Self::TouchTraining => "touch_training",
            Self::TouchValidation => "touch_validation",
            Self::TouchTest => "touch_test",
            Self::Modes => "modes",
            Self::PostureTraining => "posture_training",
            Self::PostureValidation => "posture_validation",
            Self::Compare => "compare",
        }
    }

    /// Its tables, which the page links to.
    #[must_use]
    pub fn tables(self) -> &'static [&'static str] {
        match self {
            Self::Normal | Self::Lateral | Self::Longitudinal | Self::Bending => &["responses.csv"],
            Self::Photos => &["nails.csv"],
            Self::Section => &["section.md"],
            Self::Presses => &["presses.md"],
            Self::TouchTraining
            | Self::TouchValidation
            | Self::TouchTest
            | Self::PostureTraining
            | Self::PostureValidation => &["merit.csv"],
            Self::Modes => &["modes.csv"],
            Self::Compare => &["comparisons.csv"],
            Self::Calibration => &["trajectory.csv"],
            Self::Typical => &[],
        }
    }

    /// The numbers of its folder.
    ///
    /// # Errors
    /// A file that can't be read.
    pub fn numbers(self, folder: &Path) -> anyhow::Result<Numbers> {
        match self {
            Self::Typical | Self::Calibration => Ok(Numbers::default()),
            Self::Photos => coloration_numbers(folder),
            Self::Modes => Ok(modes_numbers(folder)?),
            Self::Compare => Ok(compare_numbers(folder)?),
            Self::TouchValidation | Self::TouchTraining | Self::TouchTest => Ok(evaluation_numbers(folder)?),
            Self::PostureTraining | Self::PostureValidation => Ok(evaluation_numbers(folder)?),
            _ => Numbers::read(&folder.join("numbers.json")).map_err(|why| anyhow!(why)),
        }
    }
}
