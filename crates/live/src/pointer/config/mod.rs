//! `mouse.toml`: what moves, what clicks, what scrolls, and what happens where nothing is known.
//!
//! Every key may be left out. Forces are newtons, pressing (-`Fz_N`) positive here; distances are counts of the
//! pointer, pixels where the desktop does not accelerate them. Defaults are *assumed*, for a force error of 0.05 N SD,
//! unless a key says otherwise.

mod check;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

pub use check::ConfigFault;

/// What shear controls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// How fast the pointer goes: a finger on a hard surface hardly moves, so a force can only be held.
    Velocity,
    /// How far the pointer is from where it was: as a spring, it comes back when the shear goes.
    Position,
}

/// What clicks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Click {
    /// Pressing harder than to move.
    Press,
    /// Touching shortly.
    Tap,
    /// Nothing.
    Off,
}

/// The keys of `mouse.toml`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// What shear controls: `velocity` or `position`.
    pub mode: Mode,
    /// Shear is turned by this before it moves the pointer, degrees counter-clockwise as seen from above, where the
    /// sensor's axes are not the desk's.
    pub turn_deg: f64,
    /// Whether x is mirrored before that, for a sensor whose `Fx_N` grows to the left.
    pub mirror_x: bool,
    /// The finger touches from this pressing on, N. 6 SD of the noise.
    pub touch_n: f64,
    /// The touch ends below this pressing, N.
    pub touch_release_n: f64,
    /// Shear up to this does nothing, N; it counts from there. 5 SD of the noise.
    pub dead_zone_n: f64,
    /// Velocity: the gain from the dead zone to the knee, px/s per N.
    pub gain_low_px_per_s_per_n: f64,
    /// Velocity: the gain beyond the knee, px/s per N.
    pub gain_high_px_per_s_per_n: f64,
    /// Velocity: where the gain changes, N of shear beyond the dead zone.
    pub knee_n: f64,
    /// Position: px per N of shear beyond the dead zone.
    pub gain_position_px_per_n: f64,
    /// The pointer goes no faster than this, px/s.
    pub cap_px_per_s: f64,
    /// One-euro low-pass of the shear: its cut-off at rest, Hz.
    pub min_cutoff_hz: f64,
    /// By how much the cut-off grows with the rate of the shear, Hz per N/s.
    pub beta: f64,
    /// What clicks: `press`, `tap` or `off`.
    pub click: Click,
    /// Press: the button goes down from this pressing on, N. Above what friction needs for the fastest movement.
    pub click_n: f64,
    /// Press: the button goes up below this pressing, N.
    pub release_n: f64,
    /// Press: pressing so much above its slow mean is the onset of a click and freezes the pointer, N. 5 SD of the
    /// noise.
    pub rise_n: f64,
    /// Press: the time constant of that slow mean, s.
    pub rise_time_s: f64,
    /// Press: an onset that has not become a click after so long was none, s.
    pub lock_s: f64,
    /// The pressing has to be steady for so long after a touch begins or a click ends, until the pointer moves, s.
    pub settle_s: f64,
    /// A click takes back the motion of so long before its onset, s.
    pub take_back_s: f64,
    /// A button held for so long drags: the pointer moves again, by the change of shear since, s.
    pub drag_after_s: f64,
    /// Tap: a touch of at most this is a click; the pointer stays for so long at the beginning of every touch, s.
    pub tap_max_s: f64,
    /// Whether bending scrolls while the finger does not touch.
    pub scroll: bool,
    /// The bending of a finger that rests, degrees.
    pub scroll_rest_deg: f64,
    /// Bending that differs from rest by up to this does nothing, degrees. 1.5 times the thesis' error of posture of
    /// 10 degrees (5.4.2).
    pub scroll_dead_zone_deg: f64,
    /// Lines per second for each degree beyond the dead zone.
    pub scroll_lines_per_s_per_deg: f64,
    /// No faster than this, lines/s.
    pub scroll_cap_lines_per_s: f64,
    /// Nothing scrolls for so long after a touch, s.
    pub scroll_after_s: f64,
    /// Whether the zero of the shear follows its slow mean while the finger does not touch.
    pub zero: bool,
    /// Not for so long after a touch, s: blood comes back slowly.
    pub zero_after_s: f64,
    /// The mean over so long makes one re-zero, s.
    pub zero_window_s: f64,
    /// The time constant with which the zero follows these means, s.
    pub zero_time_s: f64,
    /// Without a valid sample for so long: button up, no motion, until the finger has lifted, s.
    pub watchdog_s: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            mode: Mode::Velocity,
            turn_deg: 0.0,
            mirror_x: false,
            touch_n: 0.3,
            touch_release_n: 0.2,
            dead_zone_n: 0.25,
            gain_low_px_per_s_per_n: 400.0,
            gain_high_px_per_s_per_n: 2400.0,
            knee_n: 0.15,
            gain_position_px_per_n: 800.0,
            cap_px_per_s: 1500.0,
            min_cutoff_hz: 1.0,
            beta: 2.0,
            click: Click::Press,
            click_n: 1.8,
            release_n: 1.4,
            rise_n: 0.25,
            rise_time_s: 0.3,
            lock_s: 0.4,
            settle_s: 0.1,
            take_back_s: 0.06,
            drag_after_s: 0.5,
            tap_max_s: 0.25,
            scroll: false,
            scroll_rest_deg: 20.0,
            scroll_dead_zone_deg: 15.0,
            scroll_lines_per_s_per_deg: 0.3,
            scroll_cap_lines_per_s: 20.0,
            scroll_after_s: 0.5,
            zero: true,
            zero_after_s: 0.5,
            zero_window_s: 2.0,
            zero_time_s: 10.0,
            watchdog_s: 0.25,
        }
    }
}
