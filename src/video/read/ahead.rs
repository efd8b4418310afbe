//! Events of a reader: decoded when they are asked for, or some frames ahead by a thread of its own.
//!
//! Either way they are the same events in the same order: where following a frame takes as long as decoding it, a job
//! takes half of the time with the second thread.

use std::ops::RangeInclusive;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::video::read::reader::{Alarm, Event, Reader};

/// Frames that may wait take so many bytes, and are so many: as many as are decoded while a job begins with the first
/// one, and of 4K not less than 4.
const WAITING_BYTES: usize = 50 << 20;
const WAITING: RangeInclusive<usize> = 4..=64;

/// How many frames of so many pixels may wait.
pub(in crate::video) fn most_waiting(pixels: usize) -> usize {
    // A pixel of 4:2:0 of 8 bits takes 1.5 bytes.
    (WAITING_BYTES / (pixels + pixels / 2).max(1)).clamp(*WAITING.start(), *WAITING.end())
}

/// What a reader has said.
pub(in crate::video) struct Told {
    pub(in crate::video) event: Result<Option<Event>, Alarm>,
    /// At the end: the file ended early, in words.
    pub(in crate::video) cut: Option<String>,
    /// How long it took.
    pub(in crate::video) took: Duration,
}

/// Where events come from.
pub(in crate::video) enum Events {
    Here(Box<Reader>),
    Ahead(Ahead),
}

/// A thread that decodes.
pub(in crate::video) struct Ahead {
    from: Receiver<Told>,
    /// None once it has ended.
    thread: Option<JoinHandle<()>>,
    /// What it said at the end.
    cut: Option<String>,
}

impl Events {
    /// Events of `reader`, so many of them ahead of whoever asks.
    pub(in crate::video) fn of(reader: Box<Reader>, ahead: usize) -> Self {
        if ahead == 0 {
            return Self::Here(reader);
        }
        let (to, from) = sync_channel(ahead);
        let thread = std::thread::spawn(move || {
            let mut reader = reader;
            loop {
                let told = next(&mut reader);
                let is_last = !matches!(told.event, Ok(Some(_)));
                // Nobody asks any more, or there is no more.
                if to.send(told).is_err() || is_last {
                    return;
                }
            }
        });
        Self::Ahead(Ahead { from, thread: Some(thread), cut: None })
    }

    pub(in crate::video) fn next(&mut self) -> Told {
        match self {
            Self::Here(reader) => next(reader),
            Self::Ahead(ahead) => ahead.next(),
        }
    }
}

impl Ahead {
    fn next(&mut self) -> Told {
        if let Ok(told) = self.from.recv() {
            self.cut.clone_from(&told.cut);
            return told;
        }
        // It has ended: after its last event, or it has failed.
        if let Some(Err(panic)) = self.thread.take().map(JoinHandle::join) {
            std::panic::resume_unwind(panic);
        }
        Told { event: Ok(None), cut: self.cut.clone(), took: Duration::ZERO }
    }
}

fn next(reader: &mut Reader) -> Told {
    let start = Instant::now();
    let event = reader.next_event();
    let cut = if matches!(event, Ok(None)) { reader.cut.clone() } else { None };
    Told { event, cut, took: start.elapsed() }
}
