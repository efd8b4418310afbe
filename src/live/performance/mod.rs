//! `lunula performance`: time per decision and how it is learned (thesis, appendix C, Fig. 123 and 124).
//!
//! In: a table `operator,method,trial,time_s` and the course ([`PerformanceOptions`]). Out, in a folder:
//! `performance.json`, the [`PerformanceFigures`]; `table.csv`, the means of each method and trial; `rows.csv`, the
//! time per decision of each row; pictures; `run.json`, the [`PerformanceReport`] with places and times.
//!
//! Time per decision is (time - path / speed) / decisions. No figures of the thesis' experiment are published: what can
//! be repeated is its analysis, and its two statements are checked as figures on any data. (Fig. 123 shows four
//! operators, the text of Fig. 124 speaks of five.)

mod analysis;
mod figures;
mod job;
mod kind;
mod options;
mod read;
mod report;
mod tables;

pub use job::{plan, run};
pub use options::PerformanceOptions;
pub use report::{
    Comparison, Fit, Fitted, Level, MethodFigures, PerformanceFigures, PerformanceReport, Statement, TrialMean,
    TrialPair,
};
