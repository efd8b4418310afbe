//! The switch itself: one reading at a time, and the time that passes without one.
//!
//! Rules, each tested at every phase of a press:
//! - it begins disarmed: a value below `off_N` has to be seen before anything presses;
//! - it presses once the value has been at `on_N` or above for `hold_on_s`, readings that say nothing breaking the
//!   hold;
//! - it releases once the value has been below `off_N` for `hold_off_s`, and does not press again for `lockout_s`;
//! - without a valid reading for more than `watchdog_s`, with a clock that is set back, or a source that is lost, it
//!   releases at once and is disarmed.
//!
//! Time is the stream's own, so that a recording played back at any speed gives the same events at the same times; who
//! reads a live source calls [`Switch::advance`] as time passes.

use super::config::{Outside, SwitchConfig};
use super::event::{Reason, SwitchEvent, Turn};

/// Holds and lock-outs are over this early, seconds: sums of decimal sampling periods miss them by rounding.
const SLACK_S: f64 = 1e-9;

/// What a sample says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// The value that is compared; NaN where it is not known.
    pub value: f64,
    /// Whether it was predicted from voltages beyond the trained ones.
    pub outside: bool,
}

/// A switch and what it remembers.
#[derive(Debug, Clone)]
pub struct Switch {
    config: SwitchConfig,
    pressed: bool,
    /// Since when the value has been where it turns the switch.
    since: Option<f64>,
    /// Whether a value below `off_N` was seen since the last fault.
    armed: bool,
    locked_until_s: f64,
    last_s: f64,
    last_valid_s: f64,
}

impl Switch {
    /// A switch that is released and disarmed.
    #[must_use]
    pub fn new(config: SwitchConfig) -> Self {
        Self {
            config,
            pressed: false,
            since: None,
            armed: false,
            locked_until_s: f64::NEG_INFINITY,
            last_s: f64::NAN,
            last_valid_s: f64::NAN,
        }
    }

    /// Its thresholds and times.
    #[must_use]
    pub fn config(&self) -> &SwitchConfig {
        &self.config
    }

    /// Whether it is pressed.
    #[must_use]
    pub fn is_pressed(&self) -> bool {
        self.pressed
    }

    /// When the watchdog lets go if no valid reading comes; none where it has nothing to do.
    #[must_use]
    pub fn due_s(&self) -> Option<f64> {
        let watches = self.config.watchdog_s > 0.0 && (self.pressed || self.armed || self.since.is_some());
        Some(self.last_valid_s + self.config.watchdog_s).filter(|due_s| watches && due_s.is_finite())
    }

    /// Time has passed without a reading.
    pub fn advance(&mut self, now_s: f64) -> Option<SwitchEvent> {
        let due_s = self.due_s().filter(|due_s| now_s > due_s + SLACK_S)?;
        self.let_go(due_s, Reason::Watchdog, self.config.watchdog_s)
    }

    /// The source is lost or another recording begins: what was known is not any more.
    pub fn lose(&mut self, t_s: f64, reason: Reason) -> Option<SwitchEvent> {
        let silent_s = (t_s - self.last_valid_s).max(0.0);
        let event = self.let_go(t_s, reason, if silent_s.is_finite() { silent_s } else { 0.0 });
        (self.last_s, self.last_valid_s, self.locked_until_s) = (f64::NAN, f64::NAN, f64::NEG_INFINITY);
        event
    }

    /// A sample came at `t_s`; a sample without a time says nothing.
    pub fn sample(&mut self, t_s: f64, reading: Reading) -> Option<SwitchEvent> {
        if !t_s.is_finite() {
            return None;
        }
        if t_s < self.last_s {
            let event = self.lose(t_s, Reason::Clock);
            let next = self.step(t_s, reading);
            return event.or(next);
        }
        // A watchdog that let go before leaves the switch disarmed: the reading turns nothing.
        let event = self.advance(t_s);
        let next = self.step(t_s, reading);
        event.or(next)
    }

    fn step(&mut self, t_s: f64, Reading { value, outside }: Reading) -> Option<SwitchEvent> {
        self.last_s = t_s;
        let outside = if outside { self.config.outside } else { None };
        if !value.is_finite() || outside == Some(Outside::Ignore) {
            if !self.pressed {
                self.since = None;
            }
            return None;
        }
        self.last_valid_s = t_s;
        let beyond = outside == Some(Outside::Release);
        if self.pressed { self.while_pressed(t_s, value, beyond) } else { self.while_released(t_s, value, beyond) }
    }

    fn while_pressed(&mut self, t_s: f64, value: f64, beyond: bool) -> Option<SwitchEvent> {
        if value >= self.config.off_n && !beyond {
            self.since = None;
            return None;
        }
        let since_s = *self.since.get_or_insert(t_s);
        if t_s - since_s < self.config.hold_off_s - SLACK_S {
            return None;
        }
        (self.pressed, self.since) = (false, None);
        // What is beyond the trained voltages is no true release.
        self.armed = !beyond;
        self.locked_until_s = t_s + self.config.lockout_s;
        let reason = if beyond { Reason::Outside } else { Reason::Value };
        Some(SwitchEvent { t_s, turn: Turn::Release, reason, value, delay_s: t_s - since_s })
    }

    fn while_released(&mut self, t_s: f64, value: f64, beyond: bool) -> Option<SwitchEvent> {
        if beyond {
            self.since = None;
            return None;
        }
        self.armed |= value < self.config.off_n;
        if value < self.config.on_n {
            self.since = None;
            return None;
        }
        if t_s < self.locked_until_s - SLACK_S {
            self.armed &= !self.config.rearm;
            return None;
        }
        if !self.armed {
            return None;
        }
        let since_s = *self.since.get_or_insert(t_s);
        if t_s - since_s < self.config.hold_on_s - SLACK_S {
            return None;
        }
        (self.pressed, self.since) = (true, None);
        Some(SwitchEvent { t_s, turn: Turn::Press, reason: Reason::Value, value, delay_s: t_s - since_s })
    }

    /// Releases, if pressed, and disarms.
    fn let_go(&mut self, t_s: f64, reason: Reason, delay_s: f64) -> Option<SwitchEvent> {
        let was = std::mem::replace(&mut self.pressed, false);
        (self.since, self.armed) = (None, false);
        was.then_some(SwitchEvent { t_s, turn: Turn::Release, reason, value: f64::NAN, delay_s })
    }
}
