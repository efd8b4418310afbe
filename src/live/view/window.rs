//! The last seconds of a session, as pictures.

use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use lunula_predictor::ForceSpace;
use serde::Serialize;

use super::{BIN_S, Bin, Finger, Health, News};
use crate::nail::Positions;

/// Pixels of a trace.
const PIXELS: usize = 200;
/// Between pictures.
const PICTURE: Duration = Duration::from_millis(100);

/// The last seconds of a session.
#[derive(Debug)]
pub struct Window {
    from: Receiver<News>,
    fingers: Vec<Shown>,
    health: Health,
    ended: bool,
}

/// What there is of a finger.
#[derive(Debug, Default)]
struct Shown {
    finger: Finger,
    /// In the order of time, at most [`PIXELS`]; those without samples are there.
    bins: VecDeque<Option<Bin>>,
    /// The place of the last bin.
    last: f64,
    state: String,
}

/// What a page gets.
#[derive(Serialize)]
struct Picture<'a> {
    bin_s: f64,
    /// Pixels of a whole trace.
    pixels: usize,
    /// Forces that fingers have, and friction.
    cone: ForceSpace,
    fingers: Vec<FingerPicture<'a>>,
    health: &'a Health,
    /// Whether the session is over.
    ended: bool,
}

#[derive(Serialize)]
struct FingerPicture<'a> {
    #[serde(flatten)]
    finger: &'a Finger,
    /// Where each photodiode is on the nail, half widths and half lengths; none where it is not known.
    places: Vec<Option<[f64; 2]>>,
    state: &'a str,
    /// When the last pixel begins, by the stream's clock.
    time_s: Option<f64>,
    /// A trace for each photodiode.
    low: Vec<Vec<Option<f64>>>,
    high: Vec<Vec<Option<f64>>>,
    /// The last answer, as `answers` of the finger.
    values: Vec<Option<f64>>,
    contact: Option<&'static str>,
    pressed: Option<bool>,
}

impl Window {
    pub(super) fn new(from: Receiver<News>) -> Self {
        Self { from, fingers: Vec::new(), health: Health::default(), ended: false }
    }

    /// Makes pictures until the session ends; `leave` gets each as JSON.
    pub fn run(mut self, leave: impl Fn(&str)) {
        let mut next = Instant::now();
        while !self.ended {
            match self.from.recv_timeout(next.saturating_duration_since(Instant::now())) {
                Ok(news) => self.add(news),
                Err(RecvTimeoutError::Disconnected) => self.ended = true,
                Err(RecvTimeoutError::Timeout) => {}
            }
            if self.ended || Instant::now() >= next {
                next = Instant::now() + PICTURE;
                leave(&self.picture());
            }
        }
    }

    /// Takes what is there.
    #[cfg(test)]
    pub(super) fn take(&mut self) {
        while let Ok(news) = self.from.try_recv() {
            self.add(news);
        }
    }

    fn add(&mut self, news: News) {
        if let News::Finger(at, _) | News::Bin(at, _) | News::State(at, _) = &news {
            self.fingers.resize_with(self.fingers.len().max(at + 1), Shown::default);
        }
        match news {
            News::Finger(at, finger) => self.fingers[at].finger = finger,
            News::Bin(at, bin) => self.fingers[at].push(bin),
            News::State(at, state) => self.fingers[at].state = state,
            News::Health(health) => self.health = health,
        }
    }

    /// The picture now, as JSON.
    pub(super) fn picture(&self) -> String {
        let positions = Positions::thesis();
        let fingers = self.fingers.iter().map(|finger| finger.picture(&positions)).collect();
        let picture = Picture {
            bin_s: BIN_S,
            pixels: PIXELS,
            cone: ForceSpace::default(),
            fingers,
            health: &self.health,
            ended: self.ended,
        };
        serde_json::to_string(&picture).unwrap_or_default()
    }
}

impl Shown {
    fn push(&mut self, bin: Bin) {
        let step = bin.place - self.last;
        if self.bins.is_empty() || step <= 0.0 {
            self.bins.clear();
        } else {
            let without = (step - 1.0).min(PIXELS as f64) as usize;
            self.bins.extend(std::iter::repeat_n(None, without));
        }
        self.last = bin.place;
        self.bins.push_back(Some(bin));
        self.bins.drain(..self.bins.len().saturating_sub(PIXELS));
    }

    fn picture(&self, positions: &Positions) -> FingerPicture<'_> {
        let finger = &self.finger;
        let place = |name: &String| {
            let place = positions.photodiodes.iter().find(|place| place.name == *name)?;
            Some([place.u, place.v])
        };
        let trace = |of: fn(&Bin) -> &[f64], k: usize| {
            let pixel = |bin: &Option<Bin>| bin.as_ref().and_then(|bin| of(bin).get(k)).and_then(|&value| shown(value));
            self.bins.iter().map(pixel).collect()
        };
        let traces = |of: fn(&Bin) -> &[f64]| (0..finger.photodiodes.len()).map(|k| trace(of, k)).collect();
        let last = self.bins.back().and_then(Option::as_ref);
        FingerPicture {
            places: finger.photodiodes.iter().map(place).collect(),
            state: &self.state,
            time_s: last.map(|_| self.last * BIN_S),
            low: traces(|bin| &bin.low),
            high: traces(|bin| &bin.high),
            values: last.map_or(Vec::new(), |bin| bin.answers.iter().map(|&value| shown(value)).collect()),
            contact: last.and_then(|bin| bin.contact),
            pressed: last.and_then(|bin| bin.pressed),
            finger,
        }
    }
}

/// With four decimals; none where it is not known.
fn shown(value: f64) -> Option<f64> {
    value.is_finite().then(|| (1e4 * value).round() / 1e4)
}
