//! Trajectories for a prompter to play (5.2.3, 5.2.4): a table of forces or angles over time, what a person
//! has to know of it, and pictures (Fig. 89 to 93).
//!
//! In: [`TrajectoryOptions`]. Out: the table, `time_s,Fx_N,Fy_N,Fz_N` (forces of the finger on the surface: pressing is
//! a negative `Fz_N`) or `time_s,J2_deg`, and beside it `<table>.run.json`, the [`TrajectoryReport`], and the pictures.
//! The mathematics are the predictor crate's.

mod check;
mod cone;
mod figures;
mod job;
mod kind;
mod motion;
mod options;
mod report;

pub use job::{plan, run};
pub use options::{BendingOptions, ForceOptions, Kind, KindOptions, RandomOptions, TrajectoryOptions};
pub use report::{ForceFigures, PostureFigures, SpiralFigures, TrajectoryFigures, TrajectoryReport};
