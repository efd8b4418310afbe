//! Whose source, models and switch are whose: the fingers of a session.

use std::path::{Path, PathBuf};

use lunula_live::source::{Address, MOST_WAITED, OfFinger, Place};

use super::decide::Plan;
use crate::files::beside;
use crate::live::error::LiveError;
use crate::live::options::{SessionFiles, StreamOptions};
use crate::live::switch::read_switch;

pub(super) struct Finger<'a> {
    /// Its name and its place among the fingers; none where the one source has no name.
    pub(super) name: Option<String>,
    place: usize,
    pub(super) source: &'a Address,
    /// A force transducer that is a device of its own.
    pub(super) force: Option<&'a Address>,
    pub(super) models: Vec<PathBuf>,
    pub(super) switch: Option<PathBuf>,
}

impl Finger<'_> {
    /// What is done with its rows, but for models, switch and mouse.
    pub(super) fn plan(&self, keep_faults: bool) -> Plan {
        Plan {
            finger: self.name.clone().map(|name| (name, self.place)),
            keep_faults,
            joins_forces: self.force.is_some(),
            ..Plan::default()
        }
    }

    /// Whether its sources can wait for whoever reads: recordings, and what comes down a pipe.
    pub(super) fn waits(&self) -> bool {
        std::iter::once(self.source)
            .chain(self.force)
            .all(|source| matches!(source.place, Place::File { .. } | Place::Phantom { .. } | Place::Stdin))
    }
}

/// The fingers that the options name.
///
/// # Errors
/// Sources without a name among several, names twice, names that no source has, all in words.
pub(super) fn fingers<'a>(options: &'a StreamOptions, files: &SessionFiles) -> Result<Vec<Finger<'a>>, LiveError> {
    let refused = |what: String| Err(LiveError::Request(what));
    let sources = &options.source;
    if sources.is_empty() {
        return refused("--source is needed: where samples come from".to_owned());
    }
    if sources.len() + options.force.len() > MOST_WAITED {
        return refused(format!("{} sources are too many; {MOST_WAITED} are the most", sources.len()));
    }
    let several = sources.len() > 1;
    let mut names: Vec<&str> = Vec::new();
    for of in sources {
        match of.finger.as_deref() {
            None if several => {
                let what = format!("{}: whose it is has to be said where there are several, as index={0}", of.what);
                return refused(format!("--source {what}"));
            }
            Some(name) if names.contains(&name) => {
                return refused(format!("two sources are `{name}`'s; name each once"));
            }
            name => names.extend(name),
        }
    }
    let piped = sources.iter().chain(&options.force).filter(|of| of.what.place == Place::Stdin).count();
    if piped > 1 {
        return refused("standard input is one source only; name another place for the others".to_owned());
    }
    check_names("--force", &options.force, &names)?;
    check_names("--model", &files.models, &names)?;
    check_names("--switch", &files.switches, &names)?;
    if several && let Some(of) = options.force.iter().find(|of| of.finger.is_none()) {
        return refused(format!("--force {}: whose it is has to be said, as {}={0}", of.what, names[0]));
    }
    if !options.force.is_empty() && files.out.is_none() {
        return refused("--force is recorded; name the recording with --out".to_owned());
    }
    let mut all = Vec::new();
    for (place, of) in sources.iter().enumerate() {
        let name = of.finger.as_deref();
        let mut forces = options.force.iter().filter(|force| force.is_for(name));
        let force = forces.next().map(|force| &force.what);
        if let Some(second) = forces.next() {
            return refused(format!("--force {second}: a finger has one force transducer; name one"));
        }
        let models: Vec<PathBuf> =
            files.models.iter().filter(|model| model.is_for(name)).map(|model| model.what.clone()).collect();
        if let (true, Some(name)) = (models.is_empty() && !files.models.is_empty(), name) {
            return refused(format!("no --model is {name}'s; name one, as {name}=MODEL.json"));
        }
        let switch = switch_of(name, &files.switches)?;
        all.push(Finger { name: of.finger.clone(), place, source: &of.what, force, models, switch });
    }
    let unused = files.switches.iter().find(|of| all.iter().all(|finger| finger.switch.as_ref() != Some(&of.what)));
    if let Some(unused) = unused {
        let what = format!("--switch {}: is no finger's here; see `finger` in it", unused.what.display());
        return refused(what);
    }
    Ok(all)
}

/// A switch that was named for the finger, or whose file says that it is the finger's, or one of all fingers.
fn switch_of(finger: Option<&str>, switches: &[OfFinger<PathBuf>]) -> Result<Option<PathBuf>, LiveError> {
    let mut own = Vec::new();
    for switch in switches.iter().filter(|switch| switch.is_for(finger)) {
        let says = if switch.finger.is_none() && finger.is_some() {
            read_switch(&switch.what)?.finger
        } else {
            switch.finger.clone()
        };
        if says.is_none() || says.as_deref() == finger {
            own.push((says.is_none(), &switch.what));
        }
    }
    // What is meant for one finger goes before what is meant for all.
    own.sort_by_key(|(for_all, _)| *for_all);
    if let [(first, one), (second, other), ..] = own[..]
        && first == second
    {
        let what = format!("{} and {} are both the switch of one finger; name one", one.display(), other.display());
        return Err(LiveError::Request(what));
    }
    Ok(own.first().map(|(_, path)| (*path).clone()))
}

fn check_names<T>(option: &str, given: &[OfFinger<T>], names: &[&str]) -> Result<(), LiveError> {
    for of in given {
        if let Some(name) = of.finger.as_deref().filter(|name| !names.contains(name)) {
            let known = if names.is_empty() { "has no name".to_owned() } else { format!("are {}", names.join(", ")) };
            let what = format!("{option} {name}=..: no source is `{name}`'s; those of --source {known}");
            return Err(LiveError::Request(what));
        }
    }
    Ok(())
}

/// Where a finger's samples are recorded: `OUT.csv`, of several fingers `OUT.index.csv`.
pub(super) fn of_finger(out: &Path, finger: Option<&str>) -> PathBuf {
    finger.map_or(out.to_owned(), |finger| beside(out, &format!(".{finger}{}", ending(out))))
}

/// Where the rows of answers are, beside the recording of samples.
pub(super) fn predicted_beside(out: &Path) -> PathBuf {
    beside(out, &format!(".predicted{}", ending(out)))
}

fn ending(out: &Path) -> String {
    out.extension().map_or(String::new(), |ending| format!(".{}", ending.to_string_lossy()))
}
