//! What every job is made of: options that a person gives on the command line and a pipeline file gives as keys.
//!
//! A job's request is one struct (`clap::Args`): its fields are the command's options, their comments its help, and
//! [`read`] reads the same struct from the keys of a TOML table, through the same parsers.

mod options;

pub use options::{OptionFault, keys, not_negative, number, read};
