//! `lunula phantom`: synthetic scenes with exact truth.

mod log;
mod photos;
mod study;
mod video;

use clap::{Args, Subcommand};

pub(super) use lunula::phantom::request::SceneArg;

use super::{Common, Interrupted, Outcome, hand_over};

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

pub(super) fn run<const VIDEO: bool>(args: &PhantomArgs) -> anyhow::Result<Outcome> {
    match &args.kind {
        Kind::Log(args) => log::run(args),
        Kind::Photos(args) => photos::run(args),
        Kind::Video(args) if VIDEO => video::run(args),
        Kind::Study(args) if VIDEO => study::run(args),
        Kind::Study(_) | Kind::Video(_) => hand_over(),
    }
}
