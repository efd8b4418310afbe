//! `lunula completions`: what a shell needs to complete commands and options.

use clap::{Args, CommandFactory as _};
use clap_complete::{Shell, generate};

use crate::{Cli, Outcome, out};

/// Print completions of commands and options for a shell
///
/// bash:  lunula completions bash > ~/.local/share/bash-completion/completions/lunula
/// zsh:   lunula completions zsh > "${fpath[1]}/_lunula"
/// fish:  lunula completions fish > ~/.config/fish/completions/lunula.fish
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct CompletionsArgs {
    /// Which shell
    #[arg(value_enum)]
    shell: Shell,
}

pub(crate) fn run(args: &CompletionsArgs) -> anyhow::Result<Outcome> {
    let mut text = Vec::new();
    generate(args.shell, &mut Cli::command(), "lunula", &mut text);
    out::print(&text);
    Ok(Outcome::Done)
}
