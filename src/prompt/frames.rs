//! What a page has shown: every frame, with its time and what was drawn in it.
//!
//! In: frames as a page sends them ([`Frame`]), and what was prompted at their times. Out: a table that grows beside
//! the recording, one row per frame, and figures ([`FrameFigures`]).
//!
//! The place of a force on the page is `centre_px + px_per_n [Fx, -Fy]`, of a pressing on the bar `bar_px[0] +
//! bar_px[1] Fz`: pixels of the page, y down. How far a frame is off is the distance between what was drawn and where
//! it should have been at the frame's own time, of ring, triangle, disc and line the farthest.

use std::collections::VecDeque;
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::protocol::Prompted;
use crate::live::{Growing, LiveError};
use crate::table::push_number;

/// Columns of the table.
const COLUMNS: [&str; 17] = [
    "time_s",
    "uncertainty_s",
    "sequence",
    "dropped",
    "trajectory",
    "prompt_Fx_N",
    "prompt_Fy_N",
    "prompt_Fz_N",
    "prompt_J2_deg",
    "ring_x_px",
    "ring_y_px",
    "triangle_y_px",
    "disc_x_px",
    "disc_y_px",
    "line_y_px",
    "force_time_s",
    "off_px",
];
/// Forces that are remembered, for frames that come later: seconds of a transducer of 1 kHz.
const MOST_FORCES: usize = 4096;
/// Two times that are the same, seconds: a page has them with microseconds.
const SAME_S: f64 = 2e-6;
/// Frames whose figures are kept: two hours at 60 Hz.
const MOST_FRAMES: usize = 432_000;

/// A frame, as a page sends it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Frame {
    /// Counted from 0 by the page.
    pub(crate) n: u64,
    /// When it is seen, seconds of the server's clock, and how far that may be off.
    pub(crate) time_s: f64,
    pub(crate) uncertainty_s: f64,
    /// Frames of the screen that were left out just before it.
    pub(crate) dropped: u32,
    /// Where no force is on the page, pixels, and how many pixels a newton is.
    pub(crate) centre_px: [f64; 2],
    pub(crate) px_per_n: f64,
    /// Where no pressing is on the bar, and how many pixels a newton is.
    pub(crate) bar_px: [f64; 2],
    /// The force of the ring, newtons, and where it was drawn.
    pub(crate) prompt_n: Option<[f64; 3]>,
    pub(crate) ring_px: Option<[f64; 2]>,
    /// Where the triangle was drawn.
    pub(crate) triangle_px: Option<f64>,
    /// How far the drawn finger was bent, degrees, and its length.
    pub(crate) bend_deg: Option<f64>,
    pub(crate) finger_px: f64,
    /// When the force that was shown was measured, seconds of the server's clock, and where disc and line were drawn.
    pub(crate) force_s: Option<f64>,
    pub(crate) disc_px: Option<[f64; 2]>,
    pub(crate) line_px: Option<f64>,
}

/// How the frames were.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrameFigures {
    /// Frames that were shown.
    pub shown: u64,
    /// Those that a screen had time for and that were not.
    pub dropped: u64,
    /// How far half of the frames were off at their own time at most, pixels.
    pub off_px_p50: Option<f64>,
    /// 99 of 100 of them.
    pub off_px_p99: Option<f64>,
    /// All.
    pub off_px_max: Option<f64>,
    /// Frames that showed a ring or finger where nothing was prompted, or none where something was.
    pub mistaken: u64,
    /// The largest uncertainty of a frame's time, seconds.
    pub uncertainty_max_s: Option<f64>,
    /// From frame to frame, in half of them at most, seconds.
    pub interval_p50_s: Option<f64>,
    /// In 99 of 100.
    pub interval_p99_s: Option<f64>,
    /// From a force that was measured to the frame that shows it for the first time, in half of them at most, seconds.
    pub force_to_frame_p50_s: Option<f64>,
    /// In 95 of 100.
    pub force_to_frame_p95_s: Option<f64>,
}

/// The frames so far.
pub(crate) struct Frames {
    table: Option<Growing>,
    forces: VecDeque<(f64, [f64; 3])>,
    shown: u64,
    dropped: u64,
    mistaken: u64,
    uncertainty_max_s: f64,
    off_px: Vec<f32>,
    interval_s: Vec<f32>,
    delay_s: Vec<f32>,
    last: Option<(u64, f64)>,
    last_force_s: f64,
}

impl Frames {
    /// Into a table, where there is one.
    pub(crate) fn new(mut table: Option<Growing>) -> Self {
        if let Some(table) = &mut table {
            table.name(COLUMNS.map(str::to_owned).to_vec());
        }
        Self {
            table,
            forces: VecDeque::new(),
            shown: 0,
            dropped: 0,
            mistaken: 0,
            uncertainty_max_s: f64::NAN,
            off_px: Vec::new(),
            interval_s: Vec::new(),
            delay_s: Vec::new(),
            last: None,
            last_force_s: f64::NEG_INFINITY,
        }
    }

    /// A force that pages may show from now on.
    pub(crate) fn force(&mut self, time_s: f64, force_n: [f64; 3]) {
        if self.forces.len() == MOST_FORCES {
            self.forces.pop_front();
        }
        self.forces.push_back((time_s, force_n));
    }

    /// A frame; what was prompted at its time, and the step's name.
    pub(crate) fn push(&mut self, frame: &Frame, prompted: Option<Prompted>, step: &str) -> Result<(), LiveError> {
        let measured = frame.force_s.and_then(|force_s| self.measured(force_s));
        let off_px = frame.off_px(prompted, measured);
        self.count(frame, off_px);
        let Some(table) = &mut self.table else { return Ok(()) };
        let mut line = String::with_capacity(256);
        push_number(&mut line, frame.time_s);
        let cell = |line: &mut String, value: Option<f64>| {
            line.push(',');
            push_number(line, value.unwrap_or(f64::NAN));
        };
        cell(&mut line, Some(frame.uncertainty_s));
        let _ = write!(line, ",{},{},{step}", frame.n, frame.dropped);
        let prompt = frame.prompt_n.map_or([None; 3], |force| force.map(Some));
        let pair = |pair: Option<[f64; 2]>| pair.map_or([None; 2], |pair| pair.map(Some));
        let [ring, disc] = [pair(frame.ring_px), pair(frame.disc_px)];
        let others = [frame.bend_deg, ring[0], ring[1], frame.triangle_px, disc[0], disc[1], frame.line_px];
        let cells = prompt.into_iter().chain(others).chain([frame.force_s, off_px]);
        cells.for_each(|value| cell(&mut line, value));
        line.push('\n');
        table.push(&line)
    }

    fn measured(&self, force_s: f64) -> Option<[f64; 3]> {
        let from = self.forces.partition_point(|(time_s, _)| *time_s < force_s - SAME_S);
        self.forces.get(from).filter(|(time_s, _)| (time_s - force_s).abs() <= SAME_S).map(|(_, force_n)| *force_n)
    }

    fn count(&mut self, frame: &Frame, off_px: Option<f64>) {
        self.shown += 1;
        self.dropped += u64::from(frame.dropped);
        self.mistaken += u64::from(off_px.is_none());
        self.uncertainty_max_s = self.uncertainty_max_s.max(frame.uncertainty_s);
        if self.shown as usize > MOST_FRAMES {
            return;
        }
        self.off_px.extend(off_px.map(|off_px| off_px as f32));
        if let Some((before, before_s)) = self.last.replace((frame.n, frame.time_s))
            && before + 1 == frame.n
        {
            self.interval_s.push((frame.time_s - before_s) as f32);
        }
        if let Some(force_s) = frame.force_s.filter(|force_s| *force_s > self.last_force_s) {
            self.last_force_s = force_s;
            self.delay_s.push((frame.time_s - force_s) as f32);
        }
    }

    /// Frames so far: shown, dropped.
    pub(crate) fn counts(&self) -> [u64; 2] {
        [self.shown, self.dropped]
    }

    /// How they were; none where no page showed any.
    pub(crate) fn figures(&self) -> Option<FrameFigures> {
        (self.shown > 0).then(|| FrameFigures {
            shown: self.shown,
            dropped: self.dropped,
            off_px_p50: part(&self.off_px, 0.5),
            off_px_p99: part(&self.off_px, 0.99),
            off_px_max: part(&self.off_px, 1.0),
            mistaken: self.mistaken,
            uncertainty_max_s: Some(self.uncertainty_max_s).filter(|most| most.is_finite()),
            interval_p50_s: part(&self.interval_s, 0.5),
            interval_p99_s: part(&self.interval_s, 0.99),
            force_to_frame_p50_s: part(&self.delay_s, 0.5),
            force_to_frame_p95_s: part(&self.delay_s, 0.95),
        })
    }

    /// Ends the table. Whether there is one.
    pub(crate) fn finish(&mut self) -> Result<bool, LiveError> {
        self.table.take().map_or(Ok(false), Growing::finish)
    }
}

/// The value below which this share lies.
fn part(values: &[f32], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f32::total_cmp);
    let at = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(at.saturating_sub(1)).map(|value| f64::from(*value))
}

impl Frame {
    /// Whether all of it are numbers that a page can have.
    pub(crate) fn is_sound(&self) -> bool {
        let lists =
            [&self.centre_px[..], &self.bar_px, &[self.time_s, self.uncertainty_s, self.px_per_n, self.finger_px]];
        let some = [self.triangle_px, self.bend_deg, self.force_s, self.line_px];
        let pairs = [self.ring_px, self.disc_px].into_iter().flatten().flatten();
        let all = lists.into_iter().flatten().copied().chain(some.into_iter().flatten()).chain(pairs);
        all.chain(self.prompt_n.into_iter().flatten()).all(|value| value.is_finite() && value.abs() <= 1e9)
            && self.px_per_n > 0.0
            && self.uncertainty_s >= 0.0
    }

    /// How far it is off, pixels; none where it shows what was not prompted, or does not show what was.
    fn off_px(&self, prompted: Option<Prompted>, measured: Option<[f64; 3]>) -> Option<f64> {
        let place = |[fx, fy, fz]: [f64; 3]| {
            let [x, y] = self.centre_px;
            ([x + self.px_per_n * fx, y - self.px_per_n * fy], self.bar_px[0] + self.bar_px[1] * fz)
        };
        let off = |force: [f64; 3], at: [f64; 2], on_bar: f64| {
            let ([x, y], bar) = place(force);
            (at[0] - x).hypot(at[1] - y).max((on_bar - bar).abs())
        };
        let of_prompt = match (prompted, self.ring_px.zip(self.triangle_px), self.bend_deg) {
            (None, None, None) => 0.0,
            (Some(Prompted::Force(force)), Some((ring, triangle)), None) => off(force, ring, triangle),
            (Some(Prompted::Bend(j2_deg)), None, Some(bend_deg)) => {
                (bend_deg - j2_deg).abs().to_radians() * self.finger_px
            }
            _ => return None,
        };
        let of_force = match (measured, self.disc_px.zip(self.line_px)) {
            (Some(force), Some((disc, line))) => off(force, disc, line),
            _ => 0.0,
        };
        Some(of_prompt.max(of_force))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A frame that shows a force and a measured one exactly.
    pub(crate) fn frame(n: u64, time_s: f64, prompt_n: [f64; 3]) -> Frame {
        Frame {
            n,
            time_s,
            uncertainty_s: 5e-4,
            dropped: 0,
            centre_px: [400.0, 300.0],
            px_per_n: 100.0,
            bar_px: [550.0, 150.0],
            prompt_n: Some(prompt_n),
            ring_px: Some([400.0 + 100.0 * prompt_n[0], 300.0 - 100.0 * prompt_n[1]]),
            triangle_px: Some(550.0 + 150.0 * prompt_n[2]),
            bend_deg: None,
            finger_px: 200.0,
            force_s: None,
            disc_px: None,
            line_px: None,
        }
    }

    #[test]
    fn a_frame_is_off_by_the_farthest_of_what_it_shows() {
        let force = [0.5, -0.25, -1.0];
        let exact = frame(0, 1.0, force);
        assert_eq!(exact.off_px(Some(Prompted::Force(force)), None), Some(0.0));
        assert_eq!(exact.off_px(Some(Prompted::Force([0.53, -0.29, -1.0])), None).map(f64::round), Some(5.0));
        assert_eq!(exact.off_px(Some(Prompted::Force([0.5, -0.25, -1.1])), None).map(f64::round), Some(15.0));
        let shows = Frame { force_s: Some(0.99), disc_px: Some([410.0, 300.0]), line_px: Some(550.0), ..exact.clone() };
        assert_eq!(shows.off_px(Some(Prompted::Force(force)), Some([0.1, 0.0, 0.0])), Some(0.0));
        assert_eq!(shows.off_px(Some(Prompted::Force(force)), Some([0.0; 3])), Some(10.0));
        // What is not prompted is shown, or the other way round.
        assert_eq!((exact.off_px(None, None), exact.off_px(Some(Prompted::Bend(3.0)), None)), (None, None));
        let bent = Frame { ring_px: None, triangle_px: None, bend_deg: Some(30.0), ..exact };
        let off = bent.off_px(Some(Prompted::Bend(31.0)), None).unwrap();
        assert!((off - 200.0 * 1f64.to_radians()).abs() <= 1e-9, "{off}");
    }

    #[test]
    fn figures_are_those_of_the_frames_and_numbers_that_are_none_are_refused() {
        let mut frames = Frames::new(None);
        assert_eq!(frames.figures(), None);
        frames.force(0.95, [0.1, 0.0, -1.0]);
        for n in 0..100u32 {
            let time_s = 1.0 + f64::from(n) / 60.0;
            let shown = Frame { force_s: Some(0.95), dropped: u32::from(n == 50), ..frame(n.into(), time_s, [0.0; 3]) };
            let off_n = if n == 99 { 0.02 } else { 0.0 };
            frames.push(&shown, Some(Prompted::Force([off_n, 0.0, 0.0])), "force").unwrap();
        }
        let figures = frames.figures().unwrap();
        assert_eq!((figures.shown, figures.dropped, figures.mistaken), (100, 1, 0));
        assert_eq!((figures.off_px_p50, figures.off_px_p99, figures.off_px_max), (Some(0.0), Some(0.0), Some(2.0)));
        assert!((figures.interval_p50_s.unwrap() - 1.0 / 60.0).abs() <= 1e-6);
        // A force is late once, when it is shown for the first time.
        assert!((figures.force_to_frame_p95_s.unwrap() - 0.05).abs() <= 1e-6);
        assert!(frame(0, 1.0, [0.0; 3]).is_sound());
        assert!(!Frame { px_per_n: 0.0, ..frame(0, 1.0, [0.0; 3]) }.is_sound());
        assert!(!Frame { ring_px: Some([f64::INFINITY, 0.0]), ..frame(0, 1.0, [0.0; 3]) }.is_sound());
    }
}
