//! When the button goes down and up, and when the pointer is frozen for it.
//!
//! In: the pressing of each sample of a finger that touches or not. Out: [`Turn`]s, and whether the pointer may move.
//!
//! A press disturbs the shear by which the pointer moves (|F_r| <= mu N: whoever presses harder can also shear more,
//! and does), so the pointer is frozen from the *onset* of the rise, long before the threshold:
//!
//! ```text
//! touch begins -> Settling -> Free -> Rising -> Down -> Dragging -> Dropping -> (up) Settling -> Free
//!                    ^                 |  no click      |   ^___________|  no release
//!                    |                 v in lock_s      |
//!                    |                Free              v
//!                    +------------------------------- (up)
//! ```
//!
//! The onset is pressing of `rise_n` above its own slow mean; a drag is dropped by the same rule downwards. A touch
//! begins, and a click ends, with a settling: frozen until the pressing has been within `rise_n` of its slow mean for
//! `settle_s`. In the mode of taps the pointer is frozen for the first `tap_max_s` of each touch, so that a tap moves
//! nothing; a touch that begins so shortly after a tap and lasts longer is a drag.

use super::super::config::{self, Config};

/// What a sample does to the button or the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turn {
    /// Nothing.
    None,
    /// A click or a drop may have begun: the motion before it may be taken back.
    Onset,
    /// The onset was none.
    FalseOnset,
    /// The button goes down.
    Down,
    /// The button goes up.
    Up,
    /// A tap: down and up at once.
    Tap,
    /// A button that was held drags from here on.
    Drag,
    /// A tap and a touch: down, and it drags.
    DownAndDrag,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Away,
    Settling { quiet_since_s: Option<f64> },
    Free,
    Rising { since_s: f64 },
    Down { since_s: f64 },
    Dragging,
    Dropping { since_s: f64 },
    Tapping { since_s: f64 },
}

/// The button's state.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clicks {
    phase: Phase,
    /// The slow mean of the pressing, N.
    mean_n: f64,
    tapped_s: f64,
}

impl Clicks {
    pub(super) fn new() -> Self {
        Self { phase: Phase::Away, mean_n: 0.0, tapped_s: f64::NEG_INFINITY }
    }

    /// Whether the button is down.
    pub(super) fn is_down(&self) -> bool {
        matches!(self.phase, Phase::Down { .. } | Phase::Dragging | Phase::Dropping { .. })
    }

    /// Whether the pointer may move.
    pub(super) fn lets_move(&self) -> bool {
        matches!(self.phase, Phase::Free | Phase::Dragging)
    }

    /// One valid sample at `t_s`, `dt_s` after the one before.
    pub(super) fn step(&mut self, config: &Config, t_s: f64, dt_s: f64, pressing_n: f64, touches: bool) -> Turn {
        if !touches {
            return self.lift(config, t_s);
        }
        match (self.phase, config.click) {
            (Phase::Away, config::Click::Tap) => self.turn(Phase::Tapping { since_s: t_s }, Turn::None),
            (Phase::Away, _) => {
                self.mean_n = pressing_n;
                self.turn(Phase::Settling { quiet_since_s: None }, Turn::None)
            }
            (Phase::Tapping { since_s }, _) => {
                if t_s - since_s <= config.tap_max_s {
                    Turn::None
                } else if since_s - self.tapped_s <= config.tap_max_s {
                    self.turn(Phase::Dragging, Turn::DownAndDrag)
                } else {
                    self.turn(Phase::Free, Turn::None)
                }
            }
            (_, config::Click::Press) => self.press(config, t_s, dt_s, pressing_n),
            // A touch settles without clicks too; of taps, phases that move go on until the finger lifts.
            (Phase::Settling { quiet_since_s }, _) => self.settle(config, t_s, dt_s, pressing_n, quiet_since_s),
            _ => Turn::None,
        }
    }

    fn lift(&mut self, config: &Config, t_s: f64) -> Turn {
        let turn = match self.phase {
            _ if self.is_down() => Turn::Up,
            Phase::Tapping { since_s } if t_s - since_s <= config.tap_max_s => {
                self.tapped_s = t_s;
                Turn::Tap
            }
            Phase::Rising { .. } => Turn::FalseOnset,
            _ => Turn::None,
        };
        self.turn(Phase::Away, turn)
    }

    /// A finger that touches, where pressing harder clicks.
    fn press(&mut self, config: &Config, t_s: f64, dt_s: f64, pressing_n: f64) -> Turn {
        let above_n = pressing_n - self.mean_n;
        if !self.is_down() && pressing_n >= config.click_n {
            return self.turn(Phase::Down { since_s: t_s }, Turn::Down);
        }
        if self.is_down() && pressing_n < config.release_n {
            return self.turn(Phase::Settling { quiet_since_s: None }, Turn::Up);
        }
        match self.phase {
            Phase::Free if above_n >= config.rise_n => self.turn(Phase::Rising { since_s: t_s }, Turn::Onset),
            Phase::Dragging if above_n <= -config.rise_n => self.turn(Phase::Dropping { since_s: t_s }, Turn::Onset),
            Phase::Free | Phase::Dragging => {
                self.follow(config, dt_s, pressing_n);
                Turn::None
            }
            Phase::Settling { quiet_since_s } => self.settle(config, t_s, dt_s, pressing_n, quiet_since_s),
            Phase::Rising { since_s } if t_s - since_s > config.lock_s => {
                self.mean_n = pressing_n;
                self.turn(Phase::Free, Turn::FalseOnset)
            }
            Phase::Dropping { since_s } if t_s - since_s > config.lock_s => {
                self.mean_n = pressing_n;
                self.turn(Phase::Dragging, Turn::FalseOnset)
            }
            Phase::Down { since_s } if t_s - since_s >= config.drag_after_s => {
                self.mean_n = pressing_n;
                self.turn(Phase::Dragging, Turn::Drag)
            }
            _ => Turn::None,
        }
    }

    fn settle(&mut self, config: &Config, t_s: f64, dt_s: f64, pressing_n: f64, quiet_since_s: Option<f64>) -> Turn {
        self.follow(config, dt_s, pressing_n);
        let quiet = (pressing_n - self.mean_n).abs() < config.rise_n;
        let quiet_since_s = if quiet { quiet_since_s.or(Some(t_s)) } else { None };
        let settled = quiet_since_s.is_some_and(|since_s| t_s - since_s >= config.settle_s);
        self.turn(if settled { Phase::Free } else { Phase::Settling { quiet_since_s } }, Turn::None)
    }

    fn follow(&mut self, config: &Config, dt_s: f64, pressing_n: f64) {
        self.mean_n += (pressing_n - self.mean_n) * dt_s / (config.rise_time_s + dt_s);
    }

    fn turn(&mut self, phase: Phase, turn: Turn) -> Turn {
        self.phase = phase;
        turn
    }
}
