//! The virtual switch (6.1): its thresholds from recordings, and how it does.

mod doubts;
mod evaluate;
mod figures;
mod flattery;
mod kind;
mod options;
mod report;
mod traces;
mod truth;
mod tune;

pub use evaluate::{EvaluateSwitchFigures, EvaluateSwitchReport, evaluate_plan, evaluate_switch, read_switch};
pub(crate) use options::FALSE_PER_HOUR;
pub use options::{ContactOptions, OutsideChoice, TuneOptions};
pub(crate) use report::of_another_model;
pub use report::{CurvePoint, TuneFigures, TuneReport};
pub use traces::SwitchInputs;
pub(crate) use traces::{Traces, read_traces};
pub use truth::TrueContact;
pub use tune::{tune_plan, tune_switch};
