//! What is installed, what is missing and how to get it.
//!
//! In: the folder that results are to go to, and what the program that reads video says of itself ([`Linked`]). Out: a [`Check`] for each
//! thing that a job may need, with what was found and, where something is to be done, what. Nothing of the machine is changed: what is
//! written to try a folder out is removed again.

mod clock;
mod folder;
mod linked;
mod machine;
mod program;
mod programs;

use std::path::Path;

use serde::Serialize;

pub use linked::{Libraries, Linked, libraries};
pub use program::Program;

/// How well something is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// As it should be.
    Good,
    /// Not there, or not as good as it could be: only some jobs miss it.
    Note,
    /// Jobs will fail, or their results can't be trusted.
    Bad,
}

/// One thing that was looked at.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Check {
    /// What.
    pub what: String,
    /// How it is.
    pub state: State,
    /// What was found.
    pub found: String,
    /// What to do; empty where nothing is to be done.
    pub remedy: String,
}

impl Check {
    fn good(what: &str, found: impl Into<String>) -> Self {
        Self { what: what.to_owned(), state: State::Good, found: found.into(), remedy: String::new() }
    }

    fn note(what: &str, found: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { what: what.to_owned(), state: State::Note, found: found.into(), remedy: remedy.into() }
    }

    fn bad(what: &str, found: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { what: what.to_owned(), state: State::Bad, found: found.into(), remedy: remedy.into() }
    }
}

/// Checks that belong together.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Group {
    /// What they are about.
    pub about: String,
    /// In the order in which they are shown.
    pub checks: Vec<Check>,
}

/// Looks at everything. `out` is the folder that results are to go to; it need not exist.
#[must_use]
pub fn examine(program: &Program, linked: &Linked, out: &Path) -> Vec<Group> {
    let group = |about: &str, checks: Vec<Check>| Group { about: about.to_owned(), checks };
    let folders = folder::examine(out).into_iter().chain(folder::temporary()).collect();
    vec![
        group("this program", program.examine(linked)),
        group("this machine", machine::examine().into_iter().chain(clock::examine(&program.path)).collect()),
        group("places to write to", folders),
        group("programs beside lunula", programs::examine()),
    ]
}

/// Whether something is bad.
#[must_use]
pub fn is_ill(groups: &[Group]) -> bool {
    groups.iter().flat_map(|group| &group.checks).any(|check| check.state == State::Bad)
}
