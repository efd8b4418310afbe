//! `lunula man`: a page of the manual for each command.

use std::path::PathBuf;

use clap::{Args, Command, CommandFactory as _};
use clap_mangen::Man;
use lunula::files::Staging;

use crate::{Cli, Common, Outcome};

/// Write manual pages, one per command: OUT/lunula.1, OUT/lunula-photos.1, ..
///
/// `man -l OUT/lunula.1` shows one; `--out ~/.local/share/man/man1` is where `man lunula` looks.
#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// Folder for the pages
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    common: Common,
}

pub(crate) fn run(args: &ManArgs) -> anyhow::Result<Outcome> {
    let mut all = Cli::command().disable_help_subcommand(true);
    all.build();
    let staging = Staging::new(&args.out)?;
    pages(&all, &staging)?;
    let written = staging.commit()?;
    args.common.say(&format!("{} pages; look at {}", written.len(), args.out.join("lunula.1").display()));
    args.common.print_json(&serde_json::json!({ "job": "man", "written": written, "failed": [] }))?;
    Ok(Outcome::Done)
}

/// A command's page and those of the commands within it.
fn pages(command: &Command, staging: &Staging) -> anyhow::Result<()> {
    for inner in command.get_subcommands().filter(|inner| !inner.is_hide_set()) {
        pages(inner, staging)?;
    }
    let page = Man::new(command.clone()).manual("lunula");
    let mut text = Vec::new();
    page.render(&mut text)?;
    staging.write(&page.get_filename(), &text)?;
    Ok(())
}
