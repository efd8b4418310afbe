//! `lunula phantom`: synthetic scenes with exact truth.

mod choices;
mod clock;
mod log;
mod photos;
mod video;

use clap::{Args, Subcommand};

pub(super) use choices::SceneArg;

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
    Video(Box<video::VideoArgs>),
}

pub(super) fn run<const VIDEO: bool>(args: &PhantomArgs) -> anyhow::Result<Outcome> {
    match &args.kind {
        Kind::Log(args) => log::run(args),
        Kind::Photos(args) => photos::run(args),
        Kind::Video(args) if VIDEO => video::run(args),
        Kind::Video(_) => hand_over(),
    }
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    sides.ok_or_else(|| format!("`{text}` is not WIDTHxHEIGHT, as 640x480"))
}
