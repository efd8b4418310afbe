//! The prompter (5.2, Fig. 87): a protocol of forces and bending, shown to a person, checked, followed and recorded.
//!
//! In: a [`Protocol`](protocol::Protocol), a sensor's samples and a transducer's forces, what a person says and what a
//! page has shown. Out: a recording that `train` reads, in which the measured forces are the training data and the
//! prompted ones a guide in columns of their own; a table of every frame that was shown; a report with the coverage of
//! the cone and the short trajectory that would fill its holes.
//!
//! One thread goes through the session ([`Prompter::run`]); a page's keys and frames come from others, and are never
//! waited for. The ring moves only while forces come and somebody looks. A simulated subject, `phantom:subject`, goes
//! through the same code, in real time or as fast as it can be.

mod attend;
mod cover;
mod desk;
mod error;
mod frames;
mod job;
pub mod protocol;
mod report;
mod run;

pub use cover::{Extra, REST_N};
pub use desk::{Nobody, Show};
pub use error::PromptError;
pub use frames::FrameFigures;
pub use job::{CLOCK, PromptFiles, Prompter, is_alone, prompt_steps, subject, write_protocol};
pub use report::{PromptFigures, PromptReport, StepFigures};
pub use run::Turn;
