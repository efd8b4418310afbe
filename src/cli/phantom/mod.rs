//! `lunula phantom`: synthetic scenes with exact truth.

mod log;
mod photos;
mod study;
mod video;

use clap::{Args, Subcommand};

pub(super) use lunula::phantom::request::SceneArg;

use super::{Common, Interrupted, Outcome};

/// Synthetic scenes with exact truth: inputs as the jobs read them, and truth/ beside them
#[derive(Debug, Args)]
pub(super) struct PhantomArgs {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Debug, Subcommand)]
enum Kind {
    Log(Box<log::LogArgs>),
    Photos(Box<photos::PhotosArgs>),
    Study(Box<study::StudyArgs>),
    Video(Box<video::VideoArgs>),
}

pub(super) fn run(args: &PhantomArgs) -> anyhow::Result<Outcome> {
    match &args.kind {
        Kind::Log(args) => log::run(args),
        Kind::Photos(args) => photos::run(args),
        Kind::Video(args) => video::run(args),
        Kind::Study(args) => study::run(args),
    }
}
