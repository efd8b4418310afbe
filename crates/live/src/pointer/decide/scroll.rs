//! Bending to lines, while the finger does not touch.
//!
//! Posture and force are never used at once: the thesis' predictor gives one or the other (5.1.2), and whether it
//! touches decides which. Flexion beyond rest scrolls down, extension up.

use super::super::config::Config;

/// Lines that were not yet reported, and since when the finger is in the air.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scroll {
    left: f64,
    since_s: Option<f64>,
}

impl Scroll {
    pub(super) fn new() -> Self {
        Self { left: 0.0, since_s: None }
    }

    /// The finger touches, or nothing is known of it.
    pub(super) fn stop(&mut self) {
        *self = Self::new();
    }

    /// A sample at `t_s` of a finger that does not touch, `dt_s` after the one before: whole lines, up positive, or 0.
    pub(super) fn step(&mut self, config: &Config, t_s: f64, dt_s: f64, bend_deg: Option<f64>) -> i32 {
        let since_s = *self.since_s.get_or_insert(t_s);
        let Some(bend_deg) = bend_deg.filter(|bend_deg| bend_deg.is_finite() && config.scroll) else { return 0 };
        if t_s - since_s < config.scroll_after_s {
            return 0;
        }
        let beyond_deg = beyond_rest_deg(config, bend_deg);
        let cap = config.scroll_cap_lines_per_s;
        self.left -= (beyond_deg * config.scroll_lines_per_s_per_deg).clamp(-cap, cap) * dt_s;
        let lines = self.left as i32;
        self.left -= f64::from(lines);
        lines
    }
}

/// How far a bending is beyond the dead zone about rest, degrees; 0 within it.
pub(super) fn beyond_rest_deg(config: &Config, bend_deg: f64) -> f64 {
    let from_rest = bend_deg - config.scroll_rest_deg;
    (from_rest.abs() - config.scroll_dead_zone_deg).max(0.0).copysign(from_rest)
}
