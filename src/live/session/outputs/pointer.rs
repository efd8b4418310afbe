//! The pointer of a session: predicted forces and posture to moves and clicks, for a file and a mouse of the kernel's.

use std::path::Path;

use lunula_live::pointer::{Config, Event, Pointer, Reason, Uinput, What};
use lunula_predictor::{Contact, FORCES};
use serde::Serialize;

use super::events::EventsFile;
use crate::live::error::LiveError;
use crate::live::options::MouseFiles;
use crate::live::session::sensor::Answer;
use crate::predictor::POSTURE;

/// A pointer and where its events go.
pub(crate) struct PointerOutput {
    pointer: Pointer,
    /// Where the forces are in an answer, and the angle.
    forces: [usize; 3],
    bend: Option<usize>,
    events: Option<EventsFile>,
    uinput: Option<Uinput>,
    /// What it did.
    pub(crate) counts: PointerCounts,
}

/// What a pointer did in a session.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct PointerCounts {
    /// Moves.
    pub moves: u64,
    /// How far it is from where it began, counts right and down.
    pub x_counts: i64,
    /// See `x_counts`.
    pub y_counts: i64,
    /// Buttons that went down.
    pub clicks: u64,
    /// Lines scrolled, up and down alike.
    pub scrolled: u64,
    /// How often everything was let go: no valid sample, a clock set back, a lost source, the end.
    pub let_go: u64,
}

/// Reads a `mouse.toml`.
pub(crate) fn read_mouse(path: &Path) -> Result<Config, LiveError> {
    let refused = |what: String| LiveError::Config { path: path.to_owned(), what };
    let text = crate::input::read_text(path).map_err(|why| refused(why.to_string()))?;
    Config::from_toml(&text).map_err(|why| refused(why.to_string()))
}

impl PointerOutput {
    /// A pointer of these answers.
    ///
    /// # Errors
    /// Forces that the models do not predict, a file that can't be made, no uinput.
    pub(crate) fn new(config: Config, files: &MouseFiles, predicted: &[String]) -> Result<Self, LiveError> {
        let place = |name: &str| {
            predicted.iter().position(|one| one == name).ok_or_else(|| {
                LiveError::Request(format!(
                    "the mouse needs {name}, and the models predict {}; name a model of all three forces",
                    predicted.join(", ")
                ))
            })
        };
        let forces = [place(FORCES[0])?, place(FORCES[1])?, place(FORCES[2])?];
        let bend = predicted.iter().position(|one| one == POSTURE);
        if config.scroll && bend.is_none() {
            let what = format!("scroll = true needs {POSTURE}; name a model of posture too, or leave it out");
            return Err(LiveError::Request(what));
        }
        let events = EventsFile::create(files.events.as_deref())?;
        let uinput = files.uinput.then(Uinput::open).transpose().map_err(|why| LiveError::Request(why.to_string()))?;
        Ok(Self { pointer: Pointer::new(config), forces, bend, events, uinput, counts: PointerCounts::default() })
    }

    /// After how long without a valid sample everything is let go, seconds.
    pub(crate) fn watchdog_s(&self) -> f64 {
        self.pointer.config().watchdog_s
    }

    /// When its watchdog lets go.
    pub(crate) fn due_s(&self) -> Option<f64> {
        self.pointer.due_s()
    }

    /// What was answered to a row.
    pub(crate) fn sample(&mut self, t_s: f64, values: &[f64], answer: Answer) -> Result<(), LiveError> {
        let [fx, fy, fz] = self.forces.map(|k| values[k]);
        // Under a gate the angle of a touching finger is no prediction.
        let bend = self.bend.map(|k| values[k]);
        let bend = bend.filter(|deg| deg.is_finite() && answer.contact != Some(Contact::Touch));
        let valid = !answer.is_far_outside && [fx, fy, fz].iter().all(|force| force.is_finite());
        self.with(|pointer, out| pointer.sample(t_s, fx, fy, fz, bend, valid, out))
    }

    /// Time has passed without one.
    pub(crate) fn advance(&mut self, now_s: f64) -> Result<(), LiveError> {
        self.with(|pointer, out| pointer.advance(now_s, out))
    }

    /// The source is lost, or the session ends.
    pub(crate) fn lose(&mut self, t_s: f64, reason: Reason) -> Result<(), LiveError> {
        self.with(|pointer, out| pointer.lose(t_s, reason, out))
    }

    fn with(&mut self, does: impl FnOnce(&mut Pointer, &mut &mut dyn FnMut(Event))) -> Result<(), LiveError> {
        let Self { pointer, events, uinput, counts, .. } = self;
        let mut fault = None;
        let mut hears = |event: Event| {
            counts.count(event.what);
            if let Some(events) = events {
                let written = events.write(|line| event.write_json(line));
                fault = written.err().or(fault.take());
            }
            if let Some(mouse) = uinput
                && let Err(why) = mouse.write(&event)
            {
                fault = Some(LiveError::Request(why.to_string()));
            }
        };
        let mut hears: &mut dyn FnMut(Event) = &mut hears;
        does(pointer, &mut hears);
        fault.map_or(Ok(()), Err)
    }
}

impl PointerCounts {
    fn count(&mut self, what: What) {
        match what {
            What::Move { dx, dy } => {
                self.moves += 1;
                self.x_counts += i64::from(dx);
                self.y_counts += i64::from(dy);
            }
            What::Button { down, .. } => self.clicks += u64::from(down),
            What::Scroll { lines } => self.scrolled += u64::from(lines.unsigned_abs()),
            What::Lost { .. } => self.let_go += 1,
            What::Zero { .. } | What::Drag { .. } | What::Ready => {}
        }
    }
}
