//! A counterpart of every data figure of the thesis from a study's results, and a page that sets what the thesis says
//! beside what came out.
//!
//! In: results of the other jobs, of a phantom or of one's own recordings. Out: pictures, tables, and numbers by name
//! ([`Numbers`]) for each part: the sensor's responses of 3.3 ([`responses`]), the coloration of 4.2
//! ([`coloration_numbers`], [`coloration_sheets`]), presses of people ([`read_presses`]), the predictors of chapter 5
//! ([`evaluation_numbers`], [`modes_numbers`], [`compare_numbers`]); and what the thesis states of them, judged
//! ([`statements`]) and set on a page with all figures ([`study_page`]).

mod coloration;
mod numbers;
mod page;
mod predictors;
mod presses;
pub mod responses;
mod section;
pub mod statements;
mod typical;

pub use coloration::{REGIONS, coloration_numbers, coloration_sheets};
pub use numbers::Numbers;
pub use page::{KindFigures, PageFigures, PageOptions, PageReport, Part, PartFolder, StudyJob, study_page};
pub use predictors::{compare_numbers, evaluation_numbers, modes_numbers};
pub use presses::{PressFile, read_presses};
pub use section::{PressesJob, SectionJob};
pub use typical::TypicalJob;
