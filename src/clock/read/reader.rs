//! A frame to one reading of the clock.
//!
//! In: the frames of a video, in order. Out: a [`Reading`] of each. The first frames are kept until they span about a
//! second; from them the clock's place ([`super::locate`]), its cells and its glyphs ([`super::learn`]) are learnt, and
//! they are read afterwards ([`ClockReader::earlier`]). From then on only the clock's pixels are looked at
//! ([`super::follow`]). A clock that can't be read for a while is learnt again in parallel.

use super::follow::Follower;
use super::learn::Model;
use super::locate::Scout;
use crate::clock::beside::Misfit;
use crate::clock::format::ClockFormat;
use crate::clock::ink::crop::{Eye, Gray, Rect};
use crate::clock::{Clock, ClockRoi, Doubt, ReaderEffort, Reading};
use crate::video::{Frame, Info};

/// A clock is learnt from the frames of so many seconds, and of so many frames at least and at most.
const LEARN_S: f64 = 1.15;
const LEARN_FRAMES: [usize; 2] = [12, 150];
/// A crop of more samples is averaged down.
const MOST_SAMPLES: usize = 60_000;
/// A clock that has not been read for so long is searched for again.
const LOST_S: f64 = 2.0;
/// Where nothing was found there is a pause before the next search, each time longer, up to the last of these.
const PAUSES_S: [f64; 5] = [0.0, 1.0, 2.0, 4.0, 8.0];

/// Reads the clock of one video, frame after frame.
#[derive(Debug)]
pub struct ClockReader {
    eye: Eye,
    format: ClockFormat,
    /// The region, where the user gave one.
    given: Option<Window>,
    region: Option<[f64; 4]>,
    follower: Option<(Window, Follower)>,
    search: Option<Search>,
    /// When the clock was read last, and how many searches have failed since.
    last_read_s: f64,
    failed: usize,
    search_from_s: f64,
    earlier: Vec<(u64, Reading)>,
    misfit: Option<Misfit>,
    effort: ReaderEffort,
}

/// What is cut out of the frames.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Window {
    rect: Rect,
    step: usize,
}

/// What a search has collected.
#[derive(Debug)]
enum Search {
    /// Crops of the given region, with their frames' indices and times.
    Region(Vec<Gray>, Vec<(u64, f64)>),
    Everywhere(Scout),
}

/// Where to look, how, and what was read meanwhile.
type Learnt = (Window, Follower, Vec<(u64, Reading)>);

impl ClockReader {
    /// A reader of this clock in this video.
    ///
    /// # Errors
    /// The region reaches outside of the picture or is too small to hold digits; says what to do.
    pub fn new(clock: &Clock, info: &Info) -> Result<Self, String> {
        let eye = Eye::new(info);
        let (width, height) = eye.size();
        let given = match clock.roi {
            ClockRoi::Auto => None,
            ClockRoi::Box(region) => Some(region),
        };
        if let Some([x, y, w, h]) = given {
            let help = "measure x, y, width, height on that picture, or write roi = \"auto\"";
            // A corner that is rounded up is no fault.
            let inside = x >= -1.0 && y >= -1.0 && x + w <= width as f64 + 1.0 && y + h <= height as f64 + 1.0;
            if !inside {
                return Err(format!(
                    "the clock's roi = [{x}, {y}, {w}, {h}] reaches outside of the picture, which is {width} x \
                     {height} pixels as it is shown; {help}"
                ));
            }
            if !(w >= 4.0 * clock.format.digits() as f64 && h >= 8.0) {
                return Err(format!(
                    "the clock's roi = [{x}, {y}, {w}, {h}] is too small for {} legible digits; {help}",
                    clock.format.digits()
                ));
            }
        }
        Ok(Self {
            eye,
            format: clock.format.clone(),
            given: given.map(|region| Window::around(region, (width, height))),
            region: given,
            follower: None,
            search: None,
            last_read_s: 0.0,
            failed: 0,
            search_from_s: 0.0,
            earlier: Vec::new(),
            misfit: None,
            effort: ReaderEffort::default(),
        })
    }

    /// Reads the clock in the next frame.
    pub fn step(&mut self, frame: &Frame<'_>) -> Reading {
        self.effort.frames += 1;
        if !self.eye.fits(&frame.luma) {
            return Reading::Abstained(Doubt::NotFound);
        }
        let reading = match &mut self.follower {
            Some((window, follower)) => {
                let gray = self.eye.cut(&frame.luma, window.rect, window.step);
                follower.read(&gray, &mut self.effort)
            }
            None => Reading::Abstained(Doubt::NotFound),
        };
        if matches!(reading, Reading::Read { .. }) {
            (self.last_read_s, self.search_from_s, self.failed) = (frame.time_s, 0.0, 0);
            self.search = None;
        } else if self.follower.is_none() || frame.time_s - self.last_read_s >= LOST_S {
            self.seek(frame);
        }
        reading
    }

    /// Collects the frame, and looks for the clock once there is enough.
    fn seek(&mut self, frame: &Frame<'_>) {
        if frame.time_s < self.search_from_s {
            return;
        }
        let given = self.given;
        let search = self.search.get_or_insert_with(|| match given {
            Some(_) => Search::Region(Vec::new(), Vec::new()),
            None => Search::Everywhere(Scout::new(&self.eye)),
        });
        let (span_s, frames, full) = match (search, given) {
            (Search::Everywhere(scout), _) => {
                scout.keep(&self.eye, frame);
                let (span_s, frames) = scout.span();
                (span_s, frames, scout.is_full())
            }
            (Search::Region(crops, frames), Some(window)) => {
                crops.push(self.eye.cut(&frame.luma, window.rect, window.step));
                frames.push((frame.index, frame.time_s));
                (frame.time_s - frames[0].1, frames.len(), false)
            }
            (Search::Region(..), None) => return,
        };
        if span_s >= LEARN_S && frames >= LEARN_FRAMES[0] || frames >= LEARN_FRAMES[1] || full {
            let found = self.learn();
            let pause_s = PAUSES_S[self.failed.min(PAUSES_S.len() - 1)];
            self.search_from_s = frame.time_s + pause_s;
            if found {
                (self.last_read_s, self.failed) = (frame.time_s, 0);
            } else {
                self.failed += 1;
            }
        }
    }

    /// Learns the clock from what has been collected and reads that; whether there is one.
    fn learn(&mut self) -> bool {
        let found = match self.search.take() {
            Some(Search::Everywhere(scout)) => scout.search(&self.format, &mut self.effort).map(|sighting| {
                let window = Window::of_blocks(sighting.rect, sighting.step);
                self.misfit = sighting.misfit.or(self.misfit.take());
                (window, sighting.follower, sighting.readings)
            }),
            Some(Search::Region(crops, frames)) => {
                self.given.and_then(|window| self.learn_given(window, &crops, &frames))
            }
            None => None,
        };
        let Some((window, mut follower, readings)) = found else { return false };
        self.earlier.extend(readings);
        let (window, digits) = window.shrunk(&mut follower);
        if self.given.is_none() {
            self.region = Some(digits.region());
        }
        self.follower = Some((window, follower));
        true
    }

    /// Learns the clock in the given region and reads the crops; notes a format that does not fit.
    fn learn_given(&mut self, window: Window, crops: &[Gray], frames: &[(u64, f64)]) -> Option<Learnt> {
        let times_s: Vec<f64> = frames.iter().map(|(_, time_s)| *time_s).collect();
        let learnt = Model::learn(crops, &times_s, &self.format);
        let misfit = learnt.misfit.is_some();
        self.misfit = learnt.misfit.or(self.misfit.take());
        let Some(model) = learnt.model else {
            let doubt = Reading::Abstained(Doubt::OtherFormat);
            self.earlier.extend(frames.iter().filter(|_| misfit).map(|(index, _)| (*index, doubt)));
            return None;
        };
        let mut follower = Follower::new(model, &self.format);
        follower.misfit = misfit;
        let readings = crops.iter().zip(frames);
        let readings = readings.map(|(crop, (index, _))| (*index, follower.read(crop, &mut self.effort))).collect();
        Some((window, follower, readings))
    }

    /// Readings, by the frames' indices, of frames from which [`step`](Self::step) abstained because the clock's place
    /// and glyphs were not yet known: to be asked for once, after the last frame, and to be put in their places.
    pub fn earlier(&mut self) -> Vec<(u64, Reading)> {
        if self.search.is_some() {
            self.learn();
        }
        std::mem::take(&mut self.earlier)
    }

    /// Where the clock is on the shown picture: x, y of its top-left corner, width, height; none until it is found.
    #[must_use]
    pub fn region(&self) -> Option<[f64; 4]> {
        self.region
    }

    /// What stands beside the clock's digits that the format does not have, where it was seen while the clock was
    /// learnt; frames with [`Doubt::OtherFormat`] say where else.
    #[must_use]
    pub fn misfit(&self) -> Option<&Misfit> {
        self.misfit.as_ref()
    }

    /// What was looked at.
    #[must_use]
    pub fn effort(&self) -> ReaderEffort {
        self.effort
    }
}

impl Window {
    /// A region, with a margin so that what touches its border is whole, in whole pixels of the picture.
    fn around([x, y, w, h]: [f64; 4], (width, height): (usize, usize)) -> Self {
        let margin = 0.06 * h + 2.0;
        let low = |at: f64| (at - margin).round().max(0.0) as usize;
        let (left, top) = (low(x), low(y));
        let right = ((x + w + margin).round() as usize).min(width);
        let bottom = ((y + h + margin).round() as usize).min(height);
        let rect = Rect { x: left, y: top, width: right.saturating_sub(left), height: bottom.saturating_sub(top) };
        let mut step = 1;
        while rect.width * rect.height > MOST_SAMPLES * step * step {
            step += 1;
        }
        Self { rect, step }
    }

    /// A rectangle of blocks.
    fn of_blocks(blocks: Rect, step: usize) -> Self {
        let Rect { x, y, width, height } = blocks;
        Self { rect: Rect { x: x * step, y: y * step, width: width * step, height: height * step }, step }
    }

    /// The part of it in which the clock's digits are and what stands beside them, to which their cells are moved; and
    /// that of the digits alone.
    fn shrunk(self, follower: &mut Follower) -> (Self, Self) {
        let size = [self.rect.width / self.step, self.rect.height / self.step];
        let cells = &mut follower.model.cells;
        let [around, digits] = [cells.bounds_beside(size), cells.bounds(size)];
        cells.shift(around[0], around[1]);
        let part = |[left, top, right, bottom]: [usize; 4]| {
            let rect = Rect {
                x: self.rect.x + left * self.step,
                y: self.rect.y + top * self.step,
                width: (right - left) * self.step,
                height: (bottom - top) * self.step,
            };
            Self { rect, ..self }
        };
        (part(around), part(digits))
    }

    fn region(&self) -> [f64; 4] {
        let Rect { x, y, width, height } = self.rect;
        [x, y, width, height].map(|side| side as f64)
    }
}

#[cfg(test)]
mod tests;
