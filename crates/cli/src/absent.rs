//! Inputs that are named and are not there: a plan, for which many jobs read nothing, says so as a run would.

use std::path::PathBuf;

use clap::ArgMatches;
use lunula::live::streams::source::OfFinger;
use lunula::predictor::DataFile;

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
    let paths = read.flat_map(|id| {
        let paths = paths(of, id, PathBuf::clone);
        let data = paths.chain(self::paths(of, id, |file: &DataFile| file.path.clone()));
        data.chain(self::paths(of, id, |model: &OfFinger<PathBuf>| model.what.clone()))
    });
    // Standard input has no name.
    paths.filter(|path| path.as_os_str() != "-" && !path.exists()).collect()
}

/// What an argument of this type names.
fn paths<'a, T: Clone + Send + Sync + 'static>(
    said: &'a ArgMatches,
    id: &str,
    path: fn(&T) -> PathBuf,
) -> impl Iterator<Item = PathBuf> + use<'a, T> {
    said.try_get_many::<T>(id).ok().flatten().into_iter().flatten().map(path)
}
