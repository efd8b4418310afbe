//! What every job is made of: its options, its kind, what runs it, its report.
//!
//! A job's options are one struct (`clap::Args`): its fields are the command's options, their comments its help, and
//! [`read`] reads the same struct from the keys of a pipeline's stage, through the same parsers.

mod keys;
mod kind;
mod options;
mod outputs;
mod report;
mod truth;
mod watch;
mod work;

pub use keys::Keys;
pub use kind::{Demand, Facts, Foreseen, Job, Kind, Maker, Order, Part, Prepared, Role, Takes, prepare, prepared};
pub use options::{Given, OptionFault, Said, Tables, defaults, keys, not_negative, number, one_of, read};
pub use outputs::Outputs;
pub use report::Report;
pub use truth::against;
pub use watch::{Interrupted, Watch};
pub use work::{At, Made, Quality, Work};
