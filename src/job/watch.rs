//! Who called a running job: what was asked for, whether to stop, who looks at its progress.

use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};

use thiserror::Error;

use super::Said;

/// A job was stopped from outside; nothing that existed has changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("interrupted; nothing was written")]
pub struct Interrupted;

/// A caller's view of a running job.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// The options as the caller wrote them; the report repeats them.
    pub said: &'a Said,
    /// Becomes true when the job is to stop.
    pub stop: &'a AtomicBool,
    /// Called with what is done so far and, where that is known, with the whole.
    pub tick: &'a (dyn Fn(u64, Option<u64>) + Sync),
}

static NOTHING_SAID: LazyLock<Said> = LazyLock::new(Said::default);
static GOES_ON: AtomicBool = AtomicBool::new(false);

impl Watch<'_> {
    /// A program that wants nothing but to stop the job.
    #[must_use]
    pub fn stopped_by(stop: &AtomicBool) -> Watch<'_> {
        Watch { said: &NOTHING_SAID, stop, tick: &|_, _| {} }
    }

    /// A caller who asked for nothing in particular and does not interrupt.
    #[must_use]
    pub fn nobody() -> Watch<'static> {
        Watch::stopped_by(&GOES_ON)
    }

    /// Whether the job goes on.
    ///
    /// # Errors
    /// [`Interrupted`] when it is to stop.
    pub fn go_on(&self) -> Result<(), Interrupted> {
        if self.stop.load(Ordering::Relaxed) { Err(Interrupted) } else { Ok(()) }
    }
}
