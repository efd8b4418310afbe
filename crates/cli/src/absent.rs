//! Inputs that are named and are not there: a plan, for which many jobs read nothing, says so as a run would.

use std::path::PathBuf;

use clap::ArgMatches;

/// What files and folders are named for to be written; all others are read.
const RESULTS: [&str; 10] =
    ["out", "bids", "dlc", "mot", "tracks", "overlay", "learning_curve", "events", "write_protocol", "write_outlines"];

/// Those of a command that is only to be planned.
pub(crate) fn inputs(said: &ArgMatches) -> Vec<PathBuf> {
    let mut of = said;
    while let Some((_, command)) = of.subcommand() {
        of = command;
    }
    let is_plan = of.try_get_one::<bool>("plan").is_ok_and(|plan| plan == Some(&true));
    let read = of.ids().map(|id| id.as_str()).filter(|id| is_plan && !RESULTS.contains(id));
    let paths = read.filter_map(|id| of.try_get_many::<PathBuf>(id).ok().flatten()).flatten();
    paths.filter(|path| !path.exists()).cloned().collect()
}
