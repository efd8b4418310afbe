//! Two clocks to one: joint angles on the camera's clock, photodiodes and forces on a computer's, labelled training
//! sets out (thesis sections 3.1.2c, 3.2.3 and 5.2).
//!
//! [`Log`] is what a lab's file holds; [`Samples`] what is left of it when the light that is not the LED's is taken
//! away; a [`Tie`] says how the log's time follows from the video's; [`Posture`] is the table of joint angles;
//! [`label`] brings the angles onto the samples' rows; [`join`](fn@join) makes one set of several videos'.

mod certificate;
mod error;
pub mod export;
pub mod figures;
mod join;
mod label;
mod options;
mod posture;
mod run;
mod tie;

pub use crate::log::{
    AmbientError, AmbientOptions, Channel, Columns, Log, LogError, LogHeader, Samples, TimeUnit, samples,
};
pub use certificate::Certificate;
pub use error::AlignError;
pub use join::{JoinError, join};
pub use label::{Gap, LabelCounts, Labels, Unlabelled, label};
pub use options::{AlignInputs, AlignOptions, AlignOutputs, Sync};
pub use posture::{ClockColumns, Posture};
pub use run::job::run;
pub use run::kind::{AlignJob, JoinJob};
pub use run::plan::plan;
pub use run::report::{AlignFigures, AlignReport, LabelReport};
pub use tie::{
    Correlated, LagPeak, LagSearch, LagTie, Recording, Tie, TieMethod, by_clock, by_correlation, by_offset, correlate,
};
