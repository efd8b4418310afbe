//! Two clocks to one: joint angles on the camera's clock, photodiodes and forces on a computer's, labelled training
//! sets out (thesis sections 3.1.2c, 3.2.3 and 5.2).
//!
//! A [`Log`](crate::log::Log) is what a lab's file holds; [`Samples`](crate::log::Samples) what is left of it when the
//! light that is not the LED's is taken away; a [`Tie`] says how the log's time follows from the video's; [`Posture`]
//! is the table of joint angles; `label` brings the angles onto the samples' rows; `join` makes one set of several
//! videos'.

mod certificate;
mod error;
mod export;
mod figures;
mod join;
mod label;
mod options;
mod posture;
mod run;
mod tie;

pub use certificate::Certificate;
pub use error::AlignError;
use label::Labels;
pub use options::{AlignInputs, AlignOptions, AlignOutputs, Sync};
pub use posture::Posture;
pub use run::job::run;
pub(crate) use run::kind::{AlignJob, JoinJob};
pub use run::plan::plan;
pub use run::report::{AlignFigures, AlignReport, LabelReport};
pub use tie::{LagPeak, LagSearch, LagTie, Recording, Tie, TieMethod};
