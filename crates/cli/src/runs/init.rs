//! `lunula init`: a pipeline file for a folder.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;
use lunula::files::{clear_leftovers, write_whole};
use lunula::pipeline::{Proposal, propose};
use serde_json::json;

use crate::{Common, Outcome};

/// Write a pipeline file for the photographs, videos, marker files, logs and tables found in a folder
///
/// Files are recognized by their endings, tables by their columns, subjects and sessions by what differs in names. The
/// file runs as it is, and its comments say what was taken for what, and what is not used. An existing file is never
/// overwritten.
#[derive(Debug, Args)]
pub(crate) struct InitArgs {
    /// The folder to look at
    #[arg(value_name = "FOLDER", default_value = ".")]
    folder: PathBuf,
    /// The pipeline file to write [default: pipeline.toml in the folder]
    #[arg(long, value_name = "PIPELINE.toml")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

pub(crate) fn run(args: &InitArgs) -> anyhow::Result<Outcome> {
    let out = args.out.clone().unwrap_or_else(|| args.folder.join("pipeline.toml"));
    if out.exists() {
        bail!("{}: stands already and is left; name another file with --out", out.display());
    }
    let from = seen_from(&args.folder, home_of(&out))?;
    let Proposal { text, left_out } = propose(&args.folder, &from)?;
    let home = home_of(&out);
    std::fs::create_dir_all(home).with_context(|| format!("{}: cannot be made", home.display()))?;
    clear_leftovers(home);
    write_whole(&out, text.as_bytes())?;
    args.common.warn(&left_out);
    args.common.print_json(&json!({ "job": "init", "pipeline": out, "warnings": left_out, "failed": [] }))?;
    args.common.say(&format!(
        "{}: look at it, then `lunula run {} --out results --plan`",
        out.display(),
        out.display()
    ));
    Ok(Outcome::Done)
}

fn home_of(file: &Path) -> &Path {
    file.parent().filter(|home| !home.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The folder as a file in `home` names it: empty for its own, else with `/` at the end.
fn seen_from(folder: &Path, home: &Path) -> std::io::Result<String> {
    // What is not there has no links.
    let real = |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path));
    let way = pathdiff::diff_paths(real(folder)?, real(home)?).unwrap_or_default();
    let way = way.to_string_lossy().into_owned();
    Ok(if way.is_empty() || way == "." { String::new() } else { format!("{way}/") })
}
