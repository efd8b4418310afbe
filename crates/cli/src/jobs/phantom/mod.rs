//! `lunula phantom`: synthetic scenes with exact truth.

mod board;
mod log;
mod nailvideo;
mod photos;
mod study;
mod video;

use std::path::Path;

use anyhow::Context as _;
use clap::{Args, Subcommand};
use lunula::job::{Said, Watch};

use crate::{Common, Outcome};

/// Write synthetic scenes with exact truth: inputs as the jobs read them, and truth/ beside them
#[derive(Debug, Args)]
pub(crate) struct PhantomArgs {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Debug, Subcommand)]
enum Kind {
    Board(Box<board::BoardArgs>),
    Log(Box<log::LogArgs>),
    #[command(name = "nailvideo")]
    NailVideo(Box<nailvideo::NailVideoArgs>),
    Photos(Box<photos::PhotosArgs>),
    Study(Box<study::StudyArgs>),
    Video(Box<video::VideoArgs>),
}

pub(crate) fn run(args: &PhantomArgs) -> anyhow::Result<Outcome> {
    match &args.kind {
        Kind::Board(args) => board::run(args),
        Kind::Log(args) => log::run(args),
        Kind::NailVideo(args) => nailvideo::run(args),
        Kind::Photos(args) => photos::run(args),
        Kind::Video(args) => video::run(args),
        Kind::Study(args) => study::run(args),
    }
}

/// Runs `work` with a bar that counts what it makes; `what` is not there where it fails: `no synthetic video`.
fn watched<T, E: Into<anyhow::Error>>(
    common: &Common,
    unit: &str,
    what: &'static str,
    work: impl FnOnce(&Watch<'_>) -> Result<T, E>,
) -> anyhow::Result<T> {
    let stop = common.start()?;
    let bar = common.progress(0, unit);
    let tick = |done: u64, all: Option<u64>| {
        bar.set_length(all.unwrap_or(done));
        bar.set_position(done);
    };
    let made = work(&Watch { said: &Said::default(), stop: &stop, tick: &tick });
    bar.finish_and_clear();
    made.map_err(Into::into).context(what)
}

/// Reports what was `made`, as `12 views in folder`, with its truth under `out`; `figures` are those of the JSON.
fn report(
    common: &Common,
    job: &str,
    mut figures: serde_json::Value,
    made: &str,
    out: &Path,
    total_s: f64,
    warnings: &[String],
) -> anyhow::Result<Outcome> {
    common.warn(warnings);
    figures["job"] = job.into();
    figures["version"] = env!("CARGO_PKG_VERSION").into();
    figures["warnings"] = warnings.into();
    common.print_json(&figures)?;
    common.say(&format!("{made}, truth in {}; {total_s:.2} s", out.join("truth").display()));
    Ok(Outcome::Done)
}
