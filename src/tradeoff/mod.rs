//! Error against run time: a job run over its settings on scenes whose truth is known.
//!
//! In: a job's `Settings` (a scene with its truth) and an [`Effort`]. Out: [`Measured`], a [`Row`] for each setting;
//! rows of other programs come from tables ([`peers`]), measured on the scenes and by the errors that [`Plan`] and the
//! jobs' modules hand out. [`judge`] finds the knee of each curve and says where the default stands; [`write`] makes
//! table and picture, [`index`] one page of all jobs. It calls the same entries as the command line, so that a figure
//! on a curve is the figure a user gets. Times are of one thread and of the stage alone that a setting changes.
//!
//! [`write`]: Tradeoff::write

pub mod align;
mod all;
mod choices;
pub mod hemodynamics;
mod judge;
mod measure;
mod page;
pub mod peers;
pub mod photos;
pub mod posture;
pub mod predictor;

pub use all::{Outcomes, all};
pub use choices::{Choice, Job, choices};
pub use judge::knee::{BEND, Cost, Knee, SAME, Why, front, knee};
pub use judge::{Figures, Tradeoff, Verdict, judge};
pub use measure::plan::Plan;
pub use measure::rows::{Measured, Row};
pub use measure::timing::{Effort, Timing};
pub use page::{Setting, index};
