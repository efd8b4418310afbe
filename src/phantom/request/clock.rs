//! The clock of a video.

use crate::phantom::screen::{Clock, ClockFont};
use crate::phantom::video::{ScreenEvents, VideoOptions};
use clap::Args;

use super::choices::{parse_jump, parse_roi, parse_span_of_frames};

#[derive(Debug, Clone, Args)]
pub(super) struct ClockArgs {
    /// A clock on a screen in the picture: h m s digits of hours, minutes, seconds, t tenths and finer, a AM or PM; as
    /// mm:ss.t or 'hh:mm:ss a' (one h becomes two digits from 10 on)
    #[arg(long, value_name = "FORMAT")]
    clock: Option<String>,
    /// What the clock counts at the first frame [default: 60]
    #[arg(long, value_name = "SECONDS", requires = "clock", allow_negative_numbers = true)]
    clock_offset: Option<f64>,
    /// How much faster than the video's time the clock runs, millionths
    #[arg(long, value_name = "PPM", requires = "clock", allow_negative_numbers = true)]
    clock_drift_ppm: Option<f64>,
    /// Refreshes of the clock's screen a second; the marker file gets them [default: it changes at once]
    #[arg(long, value_name = "HZ", requires = "clock")]
    clock_refresh: Option<f64>,
    /// How late the display shows what its program counts, beside its refreshes; the marker file gets it
    #[arg(long, value_name = "MS", requires = "clock")]
    clock_delay: Option<f64>,
    /// The clock's digits
    #[arg(long, value_enum, requires = "clock")]
    clock_font: Option<ClockFont>,
    /// Dark digits on a light panel
    #[arg(long, requires = "clock")]
    clock_dark: bool,
    /// The clock's panel [default: 900,40,300,70 at 1280x720]
    #[arg(long, value_name = "X,Y,WIDTH,HEIGHT", requires = "clock", value_parser = parse_roi)]
    clock_roi: Option<[usize; 4]>,
    /// The marker file does not tell where the clock is: roi = "auto"
    #[arg(long, requires = "clock")]
    clock_roi_auto: bool,
    /// A plain sheet covers the clock from this frame on, so many frames long; again for more
    #[arg(long, value_name = "FRAME+N", requires = "clock", value_parser = parse_span_of_frames)]
    clock_hide: Vec<[usize; 2]>,
    /// The clock's screen stands still from this frame on
    #[arg(long, value_name = "FRAME", requires = "clock")]
    clock_stop: Option<usize>,
    /// The clock's screen shows so many seconds more from this frame on, as 90+5 or 90-5
    #[arg(long, value_name = "FRAME+SECONDS", requires = "clock", value_parser = parse_jump)]
    clock_jump: Option<(usize, f64)>,
}

impl ClockArgs {
    pub(super) fn settle(&self, options: &mut VideoOptions) {
        let Some(format) = &self.clock else { return };
        let usual = Clock::default();
        options.clock = Some(Clock {
            format: format.clone(),
            offset_s: self.clock_offset.unwrap_or(usual.offset_s),
            drift_ppm: self.clock_drift_ppm.unwrap_or(usual.drift_ppm),
            refresh_hz: self.clock_refresh,
            delay_s: 1e-3 * self.clock_delay.unwrap_or_default(),
            font: self.clock_font.unwrap_or(ClockFont::Mono),
            light_digits: !self.clock_dark,
            roi_px: self.clock_roi,
            ..usual
        });
        options.clock_roi_auto = self.clock_roi_auto;
        options.screen = ScreenEvents { hide: self.clock_hide.clone(), stop: self.clock_stop, jump: self.clock_jump };
    }
}
