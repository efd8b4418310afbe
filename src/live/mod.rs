//! A sensor at work (3.1.2, 6.1-6.3, appendix C): samples as they come to answers, decisions and recordings; what is
//! made of those recordings.
//!
//! The streams, the switch and the figures are the crate `lunula-live`'s; here they meet the models, the logs' columns
//! and the files.

mod error;
mod onlooker;
mod options;
pub mod performance;
mod session;
pub mod skill;
mod steps;
mod switch;
mod view;

/// The crate that does the streams and the decisions.
pub use lunula_live as streams;
pub use lunula_live::switch::Evaluation;

pub use error::LiveError;
pub(crate) use onlooker::{Attended, Onlooker};
pub use options::{AnswerOptions, LiveOptions, MouseFiles, MouseOptions, SessionFiles, StreamOptions};
pub(crate) use session::{Growing, PhantomRows, StreamColumns, attend};
pub use session::{
    Latency, PointerCounts, Readers, SessionFigures, SessionReport, SourceFigures, SourceRole, SwitchCounts, live,
    record,
};
pub use steps::{live_steps, record_steps};
pub use switch::{
    ContactOptions, CurvePoint, EvaluateSwitchFigures, EvaluateSwitchReport, OutsideChoice, SwitchInputs, TrueContact,
    TuneFigures, TuneOptions, TuneReport, evaluate_plan, evaluate_switch, read_switch, tune_plan, tune_switch,
};
pub(crate) use switch::{FALSE_PER_HOUR, Traces, read_traces};
pub use view::{View, Window};
