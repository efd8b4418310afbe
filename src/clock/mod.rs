//! The digital clock in the picture: its digits in each frame, and the time base that they tie (thesis section 3.2.3,
//! where a computer's clock is filmed with the finger).
//!
//! [`ClockFormat`] says how it is written. A [`ClockReader`] looks at a frame and gives one [`Reading`] or none: what
//! it is not sure of it does not say. [`fit`] takes the readings of the whole video, throws out what does not fit the
//! rest, and ties the clock to the video's time by the moments at which its digits change.
//!
//! Coordinates are those of the stored picture ([`crate::video`]); [`ClockRoi`] speaks of the shown one.

mod beside;
mod cell;
mod format;
mod glyph;
mod ink;
mod read;
mod reading;
mod sequence;

pub use beside::Misfit;
pub use format::{Cell, ClockFormat, Half, Unit};
#[doc(hidden)]
pub use glyph::training;
pub use glyph::{InkBox, Levels, Patch, SURE, Scores, recognise};
pub use read::ClockReader;
pub use reading::{Doubt, ReaderEffort, Reading};
pub use sequence::{ClockFault, ClockFit, FEWEST, MOST_DRIFT, ScreenDelay, USUAL_DRIFT, USUAL_SCREEN_S, fit};

/// A digital clock in the picture, as the marker file describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// Where it is.
    pub roi: ClockRoi,
    /// What its digits mean.
    pub format: ClockFormat,
    /// How often its screen changes a second, infinite where it changes at once; none: not known.
    pub refresh_hz: Option<f64>,
    /// The least and the longest time from the program to the display's light, beside its refreshes, seconds.
    pub delay_s: [f64; 2],
}

/// Where the clock is on the shown picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClockRoi {
    /// To be looked for.
    Auto,
    /// x, y of the top-left corner, width, height.
    Box([f64; 4]),
}
