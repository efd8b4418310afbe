//! `lunula skill`: what fingers did in trials, from the force with which each pressed (thesis 6.3).
//!
//! In: recordings with `time_s` and `FINGER.Fz_N` for each finger, or `Fz_N` for one, as `lunula predict` writes them,
//! or any log with a normal force; [`SkillOptions`]. Out, in a folder: `skill.json`, the [`SkillFigures`]; `skill.csv`,
//! one row per finger and trial; pictures; `run.json`, the [`SkillReport`] with places and times.
//!
//! Conventions: `Fz_N` is the force of the finger on the surface, pressing is negative; figures call what presses
//! positive. Forces and posture are never known at once (5.1.2): where a column `contact` of a gated prediction says
//! which, forces count in rows in touch, and angles in rows in bending.

mod analysis;
mod figures;
mod job;
mod kind;
mod options;
mod read;
mod report;
mod rows;
mod summary;
mod table;

pub use job::{plan, run};
pub use options::{SkillInputs, SkillOptions};
pub use report::{FingerFigures, FingerSpread, PersonFigures, PostureFigures, SkillFigures, SkillReport, TrialFigures};
