//! The clock in the picture along with the markers: read in the frames that are decoded for them, fitted over the whole video.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::clock::{Clock, ClockFit, ClockReader, Doubt, ReaderEffort, Reading, ScreenDelay, fit};
use crate::video::{Frame, Info};

/// What the clock in the picture told.
#[derive(Debug, Clone, Serialize)]
pub struct ClockReport {
    /// Where it is on the shown picture: x, y of the top-left corner, width, height; none where it was not found.
    pub region_px: Option<[f64; 4]>,
    /// How it is written.
    pub format: String,
    /// Frames in which it was read and agrees with the rest.
    pub frames_read: u64,
    /// Frames in which it was read and contradicts the rest; these readings are not used.
    pub frames_refused: u64,
    /// Frames in which it was not read, by reason.
    pub frames_abstained: BTreeMap<Doubt, u64>,
    /// What was looked at to read it.
    pub effort: ReaderEffort,
    /// The tie of its time to the video's; none where there is none.
    pub tie: Option<ClockTieReport>,
}

/// The clock's time in the video's.
#[derive(Debug, Clone, Serialize)]
pub struct ClockTieReport {
    /// The clock's time at the first frame.
    pub offset_s: f64,
    /// Its standard error.
    pub offset_sd_s: f64,
    /// The least and the greatest that agree with every reading.
    pub offset_interval_s: [f64; 2],
    /// How much faster than the video's time it runs, millionths.
    pub drift_ppm: f64,
    /// Its standard error.
    pub drift_sd_ppm: f64,
    /// What is left over: root mean square of the middle of each reading's step less the fitted clock.
    pub residual_rms_s: f64,
    /// The least step that it shows.
    pub resolution_s: f64,
    /// How its screen's delay is known.
    pub screen: ScreenDelay,
    /// The longest that the estimate takes the screen to wait before it shows the next reading; half of it is taken off.
    pub screen_delay_s: f64,
    /// The longest that the interval counts.
    pub screen_delay_most_s: f64,
}

/// All frames are read up to here: the reader learns the clock's own digits from frames in a row.
const LEARNING_S: f64 = 1.5;

/// A clock that is read frame by frame.
pub(super) struct FilmedClock {
    clock: Clock,
    reader: ClockReader,
    every: u64,
    times_s: Vec<f64>,
    shown_s: Vec<Option<f64>>,
    abstained: BTreeMap<Doubt, u64>,
}

/// What the table of angles tells of the clock in a frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct ClockRow {
    /// What the clock counts, by the fit.
    pub(super) clock_s: f64,
    /// Its standard error.
    pub(super) sd_s: f64,
    /// The least and the greatest that agree with every reading.
    pub(super) bounds_s: [f64; 2],
    /// What it was read to show.
    pub(super) read_s: Option<f64>,
}

impl ClockRow {
    /// Of frame `index` at `time_s`.
    pub(super) fn new(fit: &ClockFit, index: usize, time_s: f64) -> Self {
        Self {
            clock_s: fit.timebase.other_s(time_s),
            sd_s: fit.timebase.sd_s(time_s),
            bounds_s: fit.bounds_s(time_s),
            read_s: fit.accepted_s[index],
        }
    }
}

/// A clock's whole video.
pub(super) struct ClockOutcome {
    /// The fit, or in words why there is none.
    pub(super) fit: Result<ClockFit, String>,
    pub(super) report: ClockReport,
}

impl FilmedClock {
    /// Reads `clock` in every `every`th frame once its digits are known; the error says what is wrong with its region.
    pub(super) fn new(clock: &Clock, info: &Info, every: u64) -> Result<Self, String> {
        let reader = ClockReader::new(clock, info)?;
        let (times_s, shown_s, abstained) = (Vec::new(), Vec::new(), BTreeMap::new());
        Ok(Self { clock: clock.clone(), reader, every: every.max(1), times_s, shown_s, abstained })
    }

    /// Looks at the next frame; none where it could not be decoded.
    pub(super) fn look(&mut self, index: u64, time_s: f64, frame: Option<&Frame<'_>>) {
        let reading = match frame {
            None => Reading::Abstained(Doubt::Undecoded),
            Some(_) if time_s > LEARNING_S && !index.is_multiple_of(self.every) => Reading::Abstained(Doubt::NotAsked),
            Some(frame) => self.reader.step(frame),
        };
        self.times_s.push(time_s);
        self.shown_s.push(match reading {
            Reading::Read { shown_s, .. } => Some(shown_s),
            Reading::Abstained(doubt) => {
                *self.abstained.entry(doubt).or_default() += 1;
                None
            }
        });
    }

    /// Fits the clock over the whole video.
    pub(super) fn finish(mut self) -> ClockOutcome {
        for (index, reading) in self.reader.earlier() {
            let Some(place) = self.shown_s.get_mut(index as usize) else { continue };
            if let (Reading::Read { shown_s, .. }, None) = (reading, *place) {
                *place = Some(shown_s);
                if let Some(count) = self.abstained.get_mut(&Doubt::NotFound) {
                    *count = count.saturating_sub(1);
                }
            }
        }
        self.abstained.retain(|_, count| *count > 0);
        let format = &self.clock.format;
        let resolution_s = format.resolution_s();
        let fit = fit(&self.times_s, &self.shown_s, resolution_s, &format.wraps_s(), self.clock.refresh_hz)
            .map_err(|fault| fault.to_string());
        let read = self.shown_s.iter().flatten().count() as u64;
        let refused = fit.as_ref().map_or(read, |fit| fit.refused as u64);
        let report = ClockReport {
            region_px: self.reader.region(),
            format: format.text().to_owned(),
            frames_read: read - refused,
            frames_refused: refused,
            frames_abstained: self.abstained,
            effort: self.reader.effort(),
            tie: fit.as_ref().ok().map(|fit| ClockTieReport {
                offset_s: fit.timebase.offset_s(),
                offset_sd_s: fit.timebase.offset_sd_s(),
                offset_interval_s: fit.offset_interval_s,
                drift_ppm: 1e6 * fit.timebase.drift,
                drift_sd_ppm: 1e6 * fit.timebase.drift_sd,
                residual_rms_s: fit.residual_rms_s,
                resolution_s,
                screen: fit.screen,
                screen_delay_s: fit.screen_delay_s,
                screen_delay_most_s: fit.screen_delay_most_s,
            }),
        };
        ClockOutcome { fit, report }
    }
}
