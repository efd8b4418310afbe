//! The text of `mouse.toml` to a [`Config`], and whether its values can work together.

use std::ops::RangeInclusive;

use super::{Click, Config, Mode};

/// The longest time of any key, s, and of what a person waits for at every touch: longer ones, of which many are
/// milliseconds, leave a pointer that doesn't move or a button that isn't pressed (assumed).
const LONGEST_S: f64 = 3600.0;
const LONGEST_WAIT_S: f64 = 10.0;
/// The longest watchdog, s: a button must not be held by nothing for longer (assumed).
const LONGEST_WATCHDOG_S: f64 = 10.0;
/// Times whose motion is taken back, s (assumed).
const TAKE_BACK_S: RangeInclusive<f64> = 0.001..=1.0;
/// The greatest force of any key, N: the thesis' transducer ends at 17 N (3.2).
const GREATEST_N: f64 = 20.0;
/// The greatest speed, px/s, and the greatest gain: moves of one sample stay far within 32 bits.
const FASTEST: f64 = 1e6;

/// All that is wrong with a `mouse.toml`, by its keys.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", .0.join("\n"))]
pub struct ConfigFault(pub Vec<String>);

impl Config {
    /// Reads a file's text.
    ///
    /// # Errors
    /// Text that is no TOML, has unknown keys or values of another type, with its line; values that can't be.
    pub fn from_toml(text: &str) -> Result<Self, ConfigFault> {
        let config: Self = toml::from_str(text).map_err(|why| ConfigFault(vec![why.to_string()]))?;
        config.check()?;
        Ok(config)
    }

    /// Can it work?
    ///
    /// # Errors
    /// All that is wrong, by key.
    pub fn check(&self) -> Result<(), ConfigFault> {
        let faults: Vec<_> = self.ranges().into_iter().flatten().chain(self.orders().into_iter().flatten()).collect();
        if faults.is_empty() { Ok(()) } else { Err(ConfigFault(faults)) }
    }

    /// Values that are impossible by themselves.
    fn ranges(&self) -> Vec<Option<String>> {
        let above = |key: &'static str, value: f64, most: f64, unit: &str| {
            (!(value > 0.0 && value <= most))
                .then(|| format!("{key} = {value}: choose above 0 and up to {most} {unit}"))
        };
        let from_zero = |key: &'static str, value: f64, most: f64, unit: &str| {
            (!(0.0..=most).contains(&value)).then(|| format!("{key} = {value}: choose 0 to {most} {unit}"))
        };
        let angle = |key: &'static str, value: f64| {
            (!(-180.0..=180.0).contains(&value)).then(|| format!("{key} = {value}: choose -180 to 180 degrees"))
        };
        vec![
            angle("turn_deg", self.turn_deg),
            above("touch_n", self.touch_n, GREATEST_N, "N"),
            above("touch_release_n", self.touch_release_n, GREATEST_N, "N"),
            from_zero("dead_zone_n", self.dead_zone_n, GREATEST_N, "N"),
            above("gain_low_px_per_s_per_n", self.gain_low_px_per_s_per_n, FASTEST, "px/s per N"),
            above("gain_high_px_per_s_per_n", self.gain_high_px_per_s_per_n, FASTEST, "px/s per N"),
            from_zero("knee_n", self.knee_n, GREATEST_N, "N"),
            above("gain_position_px_per_n", self.gain_position_px_per_n, FASTEST, "px per N"),
            above("cap_px_per_s", self.cap_px_per_s, FASTEST, "px/s"),
            above("min_cutoff_hz", self.min_cutoff_hz, 1000.0, "Hz"),
            from_zero("beta", self.beta, 1000.0, "Hz per N/s"),
            above("click_n", self.click_n, GREATEST_N, "N"),
            above("release_n", self.release_n, GREATEST_N, "N"),
            above("rise_n", self.rise_n, GREATEST_N, "N"),
            above("rise_time_s", self.rise_time_s, LONGEST_WAIT_S, "s"),
            from_zero("lock_s", self.lock_s, LONGEST_WAIT_S, "s"),
            from_zero("settle_s", self.settle_s, LONGEST_WAIT_S, "s"),
            (self.take_back_s != 0.0 && !TAKE_BACK_S.contains(&self.take_back_s)).then(|| {
                let (least, most) = (TAKE_BACK_S.start(), TAKE_BACK_S.end());
                format!("take_back_s = {}: choose 0, or {least} to {most} s", self.take_back_s)
            }),
            above("drag_after_s", self.drag_after_s, LONGEST_S, "s"),
            above("tap_max_s", self.tap_max_s, LONGEST_WAIT_S, "s"),
            angle("scroll_rest_deg", self.scroll_rest_deg),
            from_zero("scroll_dead_zone_deg", self.scroll_dead_zone_deg, 180.0, "degrees"),
            above("scroll_lines_per_s_per_deg", self.scroll_lines_per_s_per_deg, 1000.0, "lines/s per degree"),
            above("scroll_cap_lines_per_s", self.scroll_cap_lines_per_s, 1000.0, "lines/s"),
            from_zero("scroll_after_s", self.scroll_after_s, LONGEST_WAIT_S, "s"),
            from_zero("zero_after_s", self.zero_after_s, LONGEST_WAIT_S, "s"),
            above("zero_window_s", self.zero_window_s, LONGEST_S, "s"),
            above("zero_time_s", self.zero_time_s, LONGEST_S, "s"),
            above("watchdog_s", self.watchdog_s, LONGEST_WATCHDOG_S, "s"),
        ]
    }

    /// Values that are impossible together. Comparisons with what is not a number are false: `ranges` reports it.
    fn orders(&self) -> Vec<Option<String>> {
        let Self { touch_n, touch_release_n, click_n, release_n, .. } = *self;
        let press = self.click == Click::Press;
        vec![
            (touch_release_n > touch_n).then(|| {
                format!(
                    "touch_release_n = {touch_release_n} is above touch_n = {touch_n}: a touch would end as soon as it \
                     begins"
                )
            }),
            (press && release_n >= click_n).then(|| {
                format!(
                    "release_n = {release_n} must be below click_n = {click_n}, or noise would press and release the \
                     button again and again"
                )
            }),
            (press && release_n < touch_n).then(|| {
                format!(
                    "release_n = {release_n} must be at least touch_n = {touch_n}, or the finger has to lift to let \
                     the button go"
                )
            }),
            (press && click_n <= touch_n).then(|| {
                format!("click_n = {click_n} must be above touch_n = {touch_n}: between the two the pointer moves")
            }),
            (self.mode == Mode::Velocity && self.gain_high_px_per_s_per_n < self.gain_low_px_per_s_per_n).then(|| {
                format!(
                    "gain_high_px_per_s_per_n = {} is below gain_low_px_per_s_per_n = {}: the pointer has to be finer \
                     near rest",
                    self.gain_high_px_per_s_per_n, self.gain_low_px_per_s_per_n
                )
            }),
        ]
    }
}
