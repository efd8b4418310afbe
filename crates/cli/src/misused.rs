//! What to do instead where a command is given several files and takes one.

use std::ffi::OsString;

use clap::error::{ContextKind, ContextValue, ErrorKind};

/// What the commands of batches take, and how the rest is done.
const ONE_AT_A_TIME: [(&str, &str); 4] = [
    (
        "photos",
        "photographs are given as one folder that holds them: `lunula photos FOLDER --out RESULTS`; a folder for \
         outlines follows its option with =: `--write-outlines=FOLDER`",
    ),
    ("edit", "photographs are given as one folder that holds them: `lunula edit FOLDER`"),
    ("posture", MANY_VIDEOS),
    ("nailvideo", MANY_VIDEOS),
];
const MANY_VIDEOS: &str = "one video is done at a time: `lunula init FOLDER --out study.toml` writes a pipeline for \
                           all of a folder, and `lunula run study.toml` runs it";

/// The error with that, where the program was called with `said`.
pub(crate) fn with_tip(wrong: clap::Error, mut said: impl Iterator<Item = OsString>) -> clap::Error {
    let of = match wrong.kind() {
        ErrorKind::UnknownArgument => ContextKind::InvalidArg,
        // Where a command has subcommands, a second file is taken for one.
        ErrorKind::ArgumentConflict => ContextKind::InvalidSubcommand,
        _ => return wrong,
    };
    let command = said.nth(1).unwrap_or_default();
    let tip = ONE_AT_A_TIME.iter().find(|(name, _)| command == *name).map(|(_, tip)| *tip);
    let extra = match wrong.get(of) {
        Some(ContextValue::String(extra)) if !extra.starts_with('-') => Some(extra.clone()),
        _ => None,
    };
    let Some((tip, extra)) = tip.zip(extra).filter(|(_, extra)| extra != "merge" && extra != "help") else {
        return wrong;
    };
    let mut better = clap::Error::new(ErrorKind::UnknownArgument);
    better.insert(ContextKind::InvalidArg, ContextValue::String(extra));
    better.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    if let Some(usage) = wrong.get(ContextKind::Usage) {
        better.insert(ContextKind::Usage, usage.clone());
    }
    better
}
