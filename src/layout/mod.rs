//! Where to put photodiodes on the nail: the best k places, with a proof or a bound, and what more of them would gain
//! (thesis 5.5 and 7.2, which ask for a study of the effect of location and name chapter 4's photographs as its
//! source).
//!
//! In: tables whose columns are candidates (cells `C_rr_cc` of the normalized nail, or photodiodes with their places)
//! and targets; or the results of `lunula photos`. Out: `layout.json`, places that `nailvideo` and the phantom read;
//! `layout.csv`, errors of every method and number of photodiodes; pictures.
//!
//! Conventions: u and v as [`crate::nail::Positions`] has them; errors are RMSE of the linear model over the target's
//! SD, averaged over targets and persons, so 1 is what the mean alone reaches; for maps, what two poses are confused at
//! most, so 1/2 is what no photodiode reaches. Each person has a model of their own, as each who wears the sensor is
//! calibrated. Errors of layouts are of the rows that a model is fitted to, those of persons left out of rows that it
//! isn't fitted to (`held_out`), of the same recordings: measure the chosen one with `train` and `evaluate` on others.

mod draw;
mod error;
mod held_out;
mod options;
mod read;
mod run;
mod solve;
#[cfg(test)]
mod tests;

pub use error::LayoutError;
pub use options::{LayoutInputs, LayoutOptions, Numbers};
pub use read::{LeftOutCandidates, PersonFigures};
pub use run::job::run;
pub use run::plan::plan;
pub use run::report::{ChosenFigures, LayoutFigures, LayoutReport, MethodFigures};
pub use solve::{LeftOut, Method};
