//! What the session's thread and the page share: the run, what was collected, what was shown.
//!
//! The server's clock is the session's own: seconds since it began. Of live sources samples are on it already; of the
//! simulated subject that is played as it goes, they are brought to it once; of one that is played as fast as it can
//! be, the samples' time *is* the clock.

mod show;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use lunula_live::source::HostClock;
use serde::Deserialize;
pub(in crate::prompt) use show::short;
use show::{force_json, state_json};

use crate::live::LiveError;
use crate::prompt::cover::Cover;
use crate::prompt::frames::{Frame, Frames};
use crate::prompt::protocol::Prompted;
use crate::prompt::run::{Key, Phase, Run};

/// A page that listens hears the state so often at least, seconds.
const STATE_S: f64 = 0.25;
/// Frames of one message.
const MOST_FRAMES: usize = 500;
/// A frame's time is not believed to be farther from now than this, seconds.
const FARTHEST_S: f64 = 60.0;

/// Where news for pages go; no call may wait.
pub trait Show: Send + Sync {
    /// The state, as JSON.
    fn state(&self, json: &str);
    /// The latest force, as JSON.
    fn force(&self, json: &str);
}

/// Nobody looks.
pub struct Nobody;

impl Show for Nobody {
    fn state(&self, _: &str) {}
    fn force(&self, _: &str) {}
}

/// How the samples' time becomes the server's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::prompt) enum Pace {
    /// It is the server's.
    Live,
    /// It is played as it goes; ahead by so much, once that is known, seconds.
    Played(Option<f64>),
    /// It is the clock, and it is so late, seconds.
    Clock(f64),
}

/// What both share.
#[derive(Clone)]
pub(in crate::prompt) struct Desk {
    shared: Arc<Mutex<Shared>>,
    pub(in crate::prompt) clock: HostClock,
    show: Arc<dyn Show>,
}

pub(in crate::prompt) struct Shared {
    pub(in crate::prompt) run: Run,
    pub(in crate::prompt) cover: Cover,
    pub(in crate::prompt) frames: Frames,
    pub(in crate::prompt) pace: Pace,
    /// How well each step was followed.
    pub(in crate::prompt) followed: Vec<Followed>,
    /// Further messages to a person.
    pub(in crate::prompt) extra_asked: bool,
    /// What could not be written.
    pub(in crate::prompt) fault: Option<LiveError>,
    shown_s: f64,
    shown_version: u64,
}

/// How well a step was followed.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::prompt) struct Followed {
    /// Forces, and the sum of their squared distances from what was prompted, square newtons.
    pub(in crate::prompt) forces: u64,
    pub(in crate::prompt) squares: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Pressed {
    key: Key,
    time_s: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Seen {
    frames: Vec<Frame>,
}

impl Desk {
    pub(in crate::prompt) fn new(run: Run, frames: Frames, pace: Pace, show: Arc<dyn Show>) -> Self {
        let cover = Cover::new(run.protocol.space);
        let shared = Shared {
            run,
            cover,
            frames,
            pace,
            followed: Vec::new(),
            extra_asked: false,
            fault: None,
            shown_s: f64::NEG_INFINITY,
            shown_version: u64::MAX,
        };
        Self { shared: Arc::new(Mutex::new(shared)), clock: HostClock::start(), show }
    }

    pub(in crate::prompt) fn lock(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The server's clock now, seconds.
    pub(in crate::prompt) fn now_s(&self) -> f64 {
        self.of_host(&self.lock(), self.clock.now_ns())
    }

    pub(in crate::prompt) fn of_host(&self, shared: &Shared, now_ns: u64) -> f64 {
        match shared.pace {
            Pace::Live | Pace::Played(_) => 1e-9 * now_ns as f64,
            Pace::Clock(now_s) => now_s,
        }
    }

    /// What is prompted at a time: for the simulated subject.
    pub(in crate::prompt) fn prompted(&self, sample_s: f64) -> Option<Prompted> {
        let shared = self.lock();
        shared.run.prompted(sample_s + shared.ahead_s()).0
    }

    /// A key, as a page sends it; whether it is one.
    pub(in crate::prompt) fn key(&self, json: &[u8]) -> bool {
        let Ok(Pressed { key, time_s }) = serde_json::from_slice(json) else { return false };
        let mut shared = self.lock();
        let now_s = self.of_host(&shared, self.clock.now_ns());
        shared.key(key, time_s, now_s);
        self.tell(&mut shared, now_s);
        true
    }

    /// Frames, as a page sends them; whether they are some.
    pub(in crate::prompt) fn frames(&self, json: &[u8]) -> bool {
        let Ok(Seen { frames }) = serde_json::from_slice(json) else { return false };
        let mut shared = self.lock();
        let now_s = self.of_host(&shared, self.clock.now_ns());
        let near = |frame: &Frame| frame.is_sound() && (frame.time_s - now_s).abs() <= FARTHEST_S;
        if frames.len() > MOST_FRAMES || !frames.iter().all(near) {
            return false;
        }
        shared.run.page(now_s);
        for frame in &frames {
            let (prompted, place) = shared.run.prompted(frame.time_s);
            let steps = &shared.run.protocol.steps;
            let step = place.and_then(|(place, _)| steps.get(place)).map_or(String::new(), |step| step.name.clone());
            if let Err(why) = shared.frames.push(frame, prompted, &step) {
                shared.fault.get_or_insert(why);
            }
        }
        true
    }

    /// The page hears the state where it changed, or is due.
    pub(in crate::prompt) fn tell(&self, shared: &mut Shared, now_s: f64) {
        if shared.shown_version != shared.run.version || now_s - shared.shown_s >= STATE_S {
            (shared.shown_s, shared.shown_version) = (now_s, shared.run.version);
            self.show.state(&state_json(shared, now_s));
        }
    }

    /// The page hears a force.
    pub(in crate::prompt) fn tell_force(&self, shared: &mut Shared, time_s: f64, force_n: [f64; 3]) {
        // As a page has it, so that it can be found again.
        shared.frames.force(short(time_s), force_n);
        self.show.force(&force_json(time_s, force_n));
    }
}

impl Shared {
    /// The server's clock less the samples', seconds.
    pub(in crate::prompt) fn ahead_s(&self) -> f64 {
        match self.pace {
            Pace::Played(ahead_s) => ahead_s.unwrap_or(0.0),
            Pace::Live | Pace::Clock(_) => 0.0,
        }
    }

    pub(in crate::prompt) fn key(&mut self, key: Key, key_s: f64, now_s: f64) {
        if key == Key::Extra && *self.run.phase().0 == Phase::Done {
            if let Some(extra) = self.cover.extra() {
                let session = self.run.protocol.steps.iter().map(|step| step.session).max().unwrap_or(1);
                self.run.append(extra.step(session));
                self.extra_asked = true;
            }
        } else {
            self.run.key(key, key_s, now_s);
        }
    }

    /// How far a measured force is from what is prompted.
    pub(in crate::prompt) fn follow(&mut self, time_s: f64, force_n: [f64; 3]) {
        if self.run.collecting(time_s).is_none() {
            return;
        }
        let (Some(Prompted::Force(prompt_n)), Some((place, _))) = self.run.prompted(time_s) else { return };
        let square: f64 = prompt_n.iter().zip(force_n).map(|(prompt, force)| (force - prompt).powi(2)).sum();
        if !square.is_finite() {
            return;
        }
        if self.followed.len() <= place {
            self.followed.resize(place + 1, Followed::default());
        }
        let followed = &mut self.followed[place];
        followed.forces += 1;
        followed.squares += square;
    }

    /// The RMS distance in the step that it is at, newtons.
    pub(in crate::prompt) fn followed_n(&self, place: usize) -> Option<f64> {
        let followed = self.followed.get(place).filter(|followed| followed.forces > 0)?;
        Some((followed.squares / followed.forces as f64).sqrt())
    }
}
