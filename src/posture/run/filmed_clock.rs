//! The clock in the picture along with the markers: read in the frames that are decoded for them, fitted over the whole
//! video.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::clock::{
    Clock, ClockFit, ClockReader, ClockRoi, Doubt, FEWEST, Misfit, ReaderEffort, Reading, ScreenDelay, fit,
};
use crate::posture::angle::readout::Rows;
use crate::video::{Frame, Info};

/// What the clock in the picture said.
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
    /// The longest that the estimate takes the screen to wait before it shows the next reading; half of it is taken
    /// off.
    pub screen_delay_s: f64,
    /// The longest that the interval counts.
    pub screen_delay_most_s: f64,
}

/// All frames are read up to here: the reader learns the clock's own digits from frames in a row.
const LEARNING_S: f64 = 1.5;

/// A clock that is read frame by frame.
pub(in crate::posture) struct FilmedClock {
    clock: Clock,
    reader: ClockReader,
    every: u64,
    times_s: Vec<f64>,
    /// What each frame's clock shows, seconds, or why it was not read.
    shown_s: Vec<Result<f64, Doubt>>,
}

/// What the table of angles says of the clock in a frame.
#[derive(Debug, Clone, Copy)]
pub(in crate::posture) struct ClockRow {
    /// What the clock counts, by the fit.
    pub(in crate::posture) clock_s: f64,
    /// Its standard error.
    pub(in crate::posture) sd_s: f64,
    /// The least and the greatest that agree with every reading.
    pub(in crate::posture) bounds_s: [f64; 2],
    /// What it was read to show.
    pub(in crate::posture) read_s: Option<f64>,
}

impl ClockRow {
    /// Of frame `index` at `time_s`.
    pub(in crate::posture) fn new(fit: &ClockFit, index: usize, time_s: f64) -> Self {
        Self {
            clock_s: fit.timebase.other_s(time_s),
            sd_s: fit.timebase.sd_s(time_s),
            bounds_s: fit.bounds_s(time_s),
            read_s: fit.accepted_s[index],
        }
    }
}

/// A clock's whole video.
pub(in crate::posture) struct ClockOutcome {
    /// The fit, or in words why there is none.
    pub(in crate::posture) fit: Result<ClockFit, String>,
    pub(in crate::posture) report: ClockReport,
}

impl FilmedClock {
    /// Reads `clock` in every `every`th frame once its digits are known; the error says what is wrong with its region.
    pub(in crate::posture) fn new(clock: &Clock, info: &Info, every: u64) -> Result<Self, String> {
        let reader = ClockReader::new(clock, info)?;
        Ok(Self { clock: clock.clone(), reader, every: every.max(1), times_s: Vec::new(), shown_s: Vec::new() })
    }

    /// Looks at the next frame; none where it could not be decoded.
    pub(in crate::posture) fn look(&mut self, index: u64, time_s: f64, frame: Option<&Frame<'_>>) {
        let reading = match frame {
            None => Reading::Abstained(Doubt::Undecoded),
            Some(_) if time_s > LEARNING_S && !index.is_multiple_of(self.every) => Reading::Abstained(Doubt::NotAsked),
            Some(frame) => self.reader.step(frame),
        };
        self.times_s.push(time_s);
        self.shown_s.push(match reading {
            Reading::Read { shown_s, .. } => Ok(shown_s),
            Reading::Abstained(doubt) => Err(doubt),
        });
    }

    /// Puts what was learnt of earlier frames into their places.
    fn take_earlier(&mut self) {
        for (index, reading) in self.reader.earlier() {
            let Some(place) = self.shown_s.get_mut(index as usize).filter(|place| place.is_err()) else { continue };
            match reading {
                Reading::Read { shown_s, .. } => *place = Ok(shown_s),
                Reading::Abstained(doubt @ (Doubt::OtherFormat | Doubt::HalfUnclear)) => *place = Err(doubt),
                Reading::Abstained(_) => {}
            }
        }
    }

    /// Why the clock can't be read though it may be there, if so: its format does not fit, AM or PM are not seen, or it
    /// was not found.
    fn unfit(&self) -> Option<String> {
        let places = |wanted: fn(&Result<f64, Doubt>) -> bool| -> Vec<usize> {
            (0..self.shown_s.len()).filter(|&place| wanted(&self.shown_s[place])).collect()
        };
        let read = places(|shown| shown.is_ok());
        let other = places(|shown| *shown == Err(Doubt::OtherFormat));
        if Misfit::is_of_all(&read, &other) {
            let unknown = Misfit { fitting: None };
            return Some(self.reader.misfit().unwrap_or(&unknown).says(&self.clock.format, other.len()));
        }
        let halves = places(|shown| *shown == Err(Doubt::HalfUnclear)).len();
        if read.len() < FEWEST && halves >= FEWEST {
            return Some(format!(
                "its digits were read in {halves} frame(s), but no AM or PM beside them: leave `a` out of format = \
                 \"{}\" where the clock shows neither, or let the roi hold them",
                self.clock.format.text()
            ));
        }
        let lost = read.len() < FEWEST && self.clock.roi == ClockRoi::Auto;
        lost.then(|| {
            "it was not found: roi = \"auto\" finds only a clock that changes at least once a second, in the format \
             given; for any other write roi = [x, y, width, height]"
                .to_owned()
        })
    }

    /// Fits the clock over the whole video; `rows`: when a rolling shutter takes it.
    pub(in crate::posture) fn finish(mut self, rows: Option<Rows>, info: &Info) -> ClockOutcome {
        self.take_earlier();
        if let (Some(rows), Some([x, y, width, height])) = (rows, self.reader.region()) {
            let shown_px = [x + 0.5 * (width - 1.0), y + 0.5 * (height - 1.0)];
            let [_, row] = info.turn.stored_from_shown(shown_px, (info.format.width, info.format.height));
            self.times_s.iter_mut().for_each(|time_s| *time_s += rows.late_s(row));
        }
        let unfit = self.unfit();
        let format = &self.clock.format;
        let resolution_s = format.resolution_s();
        let shown_s: Vec<Option<f64>> = self.shown_s.iter().map(|shown| shown.ok()).collect();
        let mut frames_abstained = BTreeMap::new();
        for doubt in self.shown_s.iter().filter_map(|shown| shown.err()) {
            *frames_abstained.entry(doubt).or_default() += 1;
        }
        let fit = || fit(&self.times_s, &shown_s, resolution_s, &format.wraps_s(), self.clock.refresh_hz);
        let delayed = |fit: ClockFit| fit.delayed(self.clock.delay_s);
        let fit = unfit.map_or_else(|| fit().map(delayed).map_err(|fault| fault.to_string()), Err);
        let read = shown_s.iter().flatten().count() as u64;
        let refused = fit.as_ref().map_or(read, |fit| fit.refused as u64);
        let report = ClockReport {
            region_px: self.reader.region(),
            format: format.text().to_owned(),
            frames_read: read - refused,
            frames_refused: refused,
            frames_abstained,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::ClockFormat;
    use crate::phantom::screen::Clock as Screen;
    use crate::video::{Format, Picture};

    /// What is made of a clock on a plain desk, 30 frames a second, that is read as `format`.
    fn outcome(shown: &str, offset_s: f64, roi: ClockRoi, format: &str, frames: u64) -> ClockOutcome {
        let layout = Format { width: 320, height: 80, subsampling: None, depth: 8 };
        let screen = Screen { format: shown.to_owned(), offset_s, ..Screen::default() };
        let clock = Clock { roi, format: ClockFormat::parse(format).unwrap(), refresh_hz: None, delay_s: [0.0; 2] };
        let mut filmed = FilmedClock::new(&clock, &Info::plain(layout), 1).unwrap();
        for index in 0..frames {
            let time_s = index as f64 / 30.0;
            let mut picture = Picture::new(layout);
            picture.planes[0].fill(140);
            for (k, lit) in screen.panel(&screen.shown(time_s).0, 280, 36).into_iter().enumerate() {
                picture.planes[0][(22 + k / 280) * 320 + 20 + k % 280] = (25.0 + 190.0 * lit) as u8;
            }
            filmed.look(index, time_s, Some(&picture.frame(index, time_s)));
        }
        filmed.finish(None, &Info::plain(layout))
    }

    const ROI: ClockRoi = ClockRoi::Box([20.0, 22.0, 280.0, 36.0]);

    #[test]
    fn a_clock_of_another_format_is_refused_with_the_format_that_fits() {
        let cases = [("hh:mm:ss", "h:mm:ss", "\"hh:mm:ss\""), ("hh:mm:ss a", "hh:mm:ss", "\"hh:mm:ss a\"")];
        for (shown, format, fitting) in cases {
            for roi in [ROI, ClockRoi::Auto] {
                let outcome = outcome(shown, 70_874.017, roi, format, 75);
                let why = outcome.fit.unwrap_err();
                assert!(why.contains(fitting), "{roi:?} {why}");
                let report = outcome.report;
                assert!(report.frames_read == 0 && report.frames_abstained[&Doubt::OtherFormat] >= 60, "{report:?}");
            }
        }
        let why = outcome("hh:mm:ss", 70_874.017, ROI, "hh:mm:ss a", 45).fit.unwrap_err();
        assert!(why.contains("no AM or PM"), "{why}");
    }

    #[test]
    fn auto_says_that_it_finds_only_clocks_that_change() {
        let why = outcome("h:mm:ss", 36_000.017, ClockRoi::Auto, "mm:ss.t", 60).fit.unwrap_err();
        assert!(why.contains("auto") && why.contains("changes"), "{why}");
    }

    #[test]
    fn noon_and_the_hour_after_it_are_counted_on() {
        let fit = outcome("hh:mm:ss a", 43_198.517, ROI, "hh:mm:ss a", 90).fit.unwrap();
        assert!((fit.timebase.offset_s() - 43_198.517).abs() <= 0.02, "{}", fit.timebase.offset_s());
        // 12:59:59 PM becomes 1:00:00 PM, narrower: the frames before tie the rest.
        let fit = outcome("h:mm:ss a", 46_798.017, ROI, "hh:mm:ss a", 90).fit.unwrap();
        let [low, high] = fit.bounds_s(2.5);
        assert!(low <= 46_800.517 && 46_800.517 <= high, "{low} {high}");
        let read = fit.accepted_s.iter().flatten().count();
        assert!((45..=60).contains(&read), "{read}");
    }
}
