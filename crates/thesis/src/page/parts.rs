//! The parts of a study: the title, numbers and tables of each.

use std::path::Path;

use anyhow::anyhow;

use crate::coloration::coloration_numbers;
use crate::numbers::Numbers;
use crate::predictors::{compare_numbers, evaluation_numbers, modes_numbers, performance_numbers};
use lunula::words::Words;

/// A part of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs, reason = "their words say it")]
pub enum Part {
    Rising,
    FilmGreen,
    FilmRatio,
    Normal,
    Lateral,
    Longitudinal,
    Bending,
    Typical,
    Photos,
    Section,
    Presses,
    Calibration,
    TouchTraining,
    TouchValidation,
    TouchTest,
    Modes,
    PostureTraining,
    PostureValidation,
    Compare,
    Performance,
}

impl Words for Part {
    /// All, in the thesis' order: their names in pipeline files and before their numbers' names.
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Rising, "rising", "one nail under rising force"),
        (Self::FilmGreen, "film_green", "a sensor and a camera on one nail, the camera's green"),
        (Self::FilmRatio, "film_ratio", "the same, the camera's green over red"),
        (Self::Normal, "normal", "responses to normal force"),
        (Self::Lateral, "lateral", "responses to lateral shear"),
        (Self::Longitudinal, "longitudinal", "responses to longitudinal shear"),
        (Self::Bending, "bending", "responses to bending"),
        (Self::Typical, "typical", "one subject's coloration"),
        (Self::Photos, "photos", "maps of photographs"),
        (Self::Section, "section", "the simulations of section 4.3"),
        (Self::Presses, "presses", "its experiments"),
        (Self::Calibration, "calibration", "the trajectory that the person was prompted by"),
        (Self::TouchTraining, "touch_training", "the touch model evaluated on what it was trained on"),
        (Self::TouchValidation, "touch_validation", "on the third repetition"),
        (Self::TouchTest, "touch_test", "on random touching"),
        (Self::Modes, "modes", "the touch model analysed"),
        (Self::PostureTraining, "posture_training", "the posture model evaluated on the half that it was trained on"),
        (Self::PostureValidation, "posture_validation", "on the second half"),
        (Self::Compare, "compare", "models compared over subjects"),
        (Self::Performance, "performance", "trials of two methods of control"),
    ];
}

impl Part {
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
            Self::TouchTraining
            | Self::TouchValidation
            | Self::TouchTest
            | Self::PostureTraining
            | Self::PostureValidation => Ok(evaluation_numbers(folder)?),
            _ => Numbers::read(&folder.join("numbers.json")).map_err(|why| anyhow!(why)),
        }
    }
}
