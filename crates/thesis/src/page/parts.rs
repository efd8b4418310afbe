//! The parts of a study: the title, numbers and tables of each.

use std::path::Path;

use anyhow::anyhow;

use crate::coloration::coloration_numbers;
use crate::numbers::Numbers;
use crate::predictors::{compare_numbers, evaluation_numbers, modes_numbers, performance_numbers};

/// A part of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// One nail under rising force (Fig. 5).
    Rising,
    /// A sensor and a camera on one nail, the camera's green.
    FilmGreen,
    /// The same, the camera's green over red.
    FilmRatio,
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
    /// The posture model on the half that it was trained on (5.3.2).
    PostureTraining,
    /// The posture model on the second half.
    PostureValidation,
    /// Models compared over subjects (5.4, 5.5).
    Compare,
    /// Trials of two methods of control (appendix C).
    Performance,
}

impl Part {
    /// All, in the thesis' order.
    pub const ALL: [Self; 20] = [
        Self::Rising,
        Self::FilmGreen,
        Self::FilmRatio,
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
        Self::Performance,
    ];

    /// Its name in pipeline files, and before its numbers' names.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Rising => "rising",
            Self::FilmGreen => "film_green",
            Self::FilmRatio => "film_ratio",
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
            Self::Performance => "performance",
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
            Self::FilmGreen | Self::FilmRatio => &["film.csv"],
            Self::Performance => &["table.csv"],
            Self::Typical | Self::Rising => &[],
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
            Self::Performance => performance_numbers(folder),
            Self::TouchValidation | Self::TouchTraining | Self::TouchTest => Ok(evaluation_numbers(folder)?),
            Self::PostureTraining | Self::PostureValidation => Ok(evaluation_numbers(folder)?),
            _ => Numbers::read(&folder.join("numbers.json")).map_err(|why| anyhow!(why)),
        }
    }
}
