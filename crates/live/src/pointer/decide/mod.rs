//! The pointer itself: one sample at a time, and the time that passes without one.
//!
//! Rules, each tested at every phase of a press:
//! - it begins disarmed: the finger has to be seen lifted (pressing below `touch_release_n`) before anything happens;
//! - it moves only while the finger touches and neither clicks nor settles ([`click`]);
//! - motion is counted between two valid samples only: a sample that is not valid moves nothing, and nothing is held
//!   over it;
//! - without a valid sample for more than `watchdog_s`, with a clock that goes back or leaps by more than that, or a
//!   source that is lost, the button goes up at once and the pointer is disarmed.
//!
//! Time is the stream's own, so that a recording played back at any speed gives the same events at the same times; who
//! reads a live source calls [`Pointer::advance`] as time passes.

mod click;
mod counts;
mod filter;
mod gain;
mod motion;
mod scroll;
mod zero;

#[cfg(test)]
pub(super) use gain::{off_screen, shear_for_n};

use super::config::Config;
use super::event::{Button, Event, Reason, What};
use click::{Clicks, Turn};
use filter::OneEuro;
use motion::Motion;
use scroll::Scroll;
use zero::Zero;

/// A force of more than this is not a finger's, N (assumed; the thesis' transducer ends at 17 N).
const MOST_N: f64 = 1000.0;
/// Samples closer than this are one moment, s: rates would overflow (assumed; sensors sample at up to 20 kHz).
const SHORTEST_S: f64 = 1e-6;
/// So many samples without a time are passed over; after one more the clock is lost (assumed).
const MOST_UNTIMED: u32 = 10;
/// Sums of decimal sampling periods miss the watchdog by rounding, s.
const SLACK_S: f64 = 1e-9;

/// A pointer and what it remembers.
#[derive(Debug, Clone)]
pub struct Pointer {
    config: Config,
    armed: bool,
    /// Whether the finger touches, as far as is known.
    pub(in crate::pointer) touches: bool,
    /// The last sample of any kind; NaN before the first.
    last_s: f64,
    /// Whether it was valid.
    last_valid: bool,
    /// The last valid sample; NaN before the first.
    valid_s: f64,
    /// The greatest time that is known to have passed.
    now_s: f64,
    filter: OneEuro,
    zero: Zero,
    clicks: Clicks,
    scroll: Scroll,
    motion: Motion,
    /// Samples without a time since the last with one.
    untimed: u32,
}

impl Pointer {
    /// A pointer that is disarmed. What `config` says is not checked here ([`Config::check`]).
    #[must_use]
    pub fn new(config: Config) -> Self {
        Self {
            config,
            armed: false,
            touches: false,
            last_s: f64::NAN,
            last_valid: false,
            valid_s: f64::NAN,
            now_s: f64::NAN,
            filter: OneEuro::new(config.min_cutoff_hz, config.beta),
            zero: Zero::new(),
            clicks: Clicks::new(),
            scroll: Scroll::new(),
            motion: Motion::new(config.take_back_s),
            untimed: 0,
        }
    }

    /// Its keys.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Whether the button is down.
    #[must_use]
    pub fn is_down(&self) -> bool {
        self.clicks.is_down()
    }

    /// Where the pointer is, px from where it began: the integral of all motion less what was taken back. The sum of
    /// all moves is never a whole count away from it.
    #[must_use]
    pub fn place_px(&self) -> [f64; 2] {
        self.motion.place_px()
    }

    /// When the watchdog lets go if no valid sample comes; none where it has nothing to do.
    #[must_use]
    pub fn due_s(&self) -> Option<f64> {
        Some(self.valid_s + self.config.watchdog_s).filter(|due_s| due_s.is_finite())
    }

    /// Time has passed without a sample. A clock that is set back by more than the watchdog lets go as well.
    pub fn advance(&mut self, now_s: f64, out: &mut impl FnMut(Event)) {
        if !now_s.is_finite() {
            return;
        }
        if now_s < self.now_s - self.config.watchdog_s - SLACK_S {
            return self.lose(now_s, Reason::Clock, out);
        }
        self.now_s = self.now_s.max(now_s);
        if let Some(due_s) = self.due_s().filter(|due_s| now_s > due_s + SLACK_S) {
            self.let_go(due_s, Reason::Watchdog, out);
        }
    }

    /// The source is lost, or another recording begins: the button goes up, and what was known is not any more, but for
    /// the zero.
    pub fn lose(&mut self, t_s: f64, reason: Reason, out: &mut impl FnMut(Event)) {
        let t_s = if t_s.is_finite() { t_s } else { self.last_s };
        self.let_go(t_s, reason, out);
        (self.last_s, self.last_valid, self.now_s) = (f64::NAN, false, f64::NAN);
    }

    /// As new, after the button went up.
    pub fn reset(&mut self, out: &mut impl FnMut(Event)) {
        self.lose(self.last_s, Reason::End, out);
        *self = Self::new(self.config);
    }

    /// A sample at `t_s`: the force of the finger on the surface, newtons (pressing is a negative `fz_n`), the bending
    /// of its joint, degrees, where there is a posture, and whether all that is to be believed. A force that is not
    /// finite is not valid, a sample without a time neither.
    #[allow(clippy::too_many_arguments, reason = "the columns of a row")]
    pub fn sample(
        &mut self,
        t_s: f64,
        fx_n: f64,
        fy_n: f64,
        fz_n: f64,
        bend_deg: Option<f64>,
        valid: bool,
        out: &mut impl FnMut(Event),
    ) {
        if !t_s.is_finite() {
            self.last_valid = false;
            self.untimed += 1;
            if self.untimed > MOST_UNTIMED {
                self.let_go(self.last_s, Reason::Clock, out);
            }
            return;
        }
        self.untimed = 0;
        if t_s < self.last_s {
            self.lose(t_s, Reason::Clock, out);
        }
        // A leap of the clock, or silence: which of them can't be known.
        self.advance(t_s, out);
        let dt_s = t_s - self.last_s;
        if dt_s < SHORTEST_S {
            return;
        }
        let follows = self.last_valid && valid && self.valid_s.is_finite();
        let valid = valid && [fx_n, fy_n, fz_n].iter().all(|force_n| force_n.abs() <= MOST_N);
        (self.last_s, self.last_valid) = (t_s, valid);
        if !valid {
            self.scroll.stop();
            self.zero.stop();
            return;
        }
        self.valid_s = t_s;
        let dt_s = if follows { dt_s } else { 0.0 };
        self.step(t_s, dt_s, [fx_n, fy_n], -fz_n, bend_deg, out);
    }
}

impl Pointer {
    /// A valid sample, `dt_s` after another; 0 where the one before was not valid.
    fn step(
        &mut self,
        t_s: f64,
        dt_s: f64,
        shear_n: [f64; 2],
        pressing_n: f64,
        bend_deg: Option<f64>,
        out: &mut impl FnMut(Event),
    ) {
        let config = self.config;
        if !self.armed {
            if pressing_n >= config.touch_release_n {
                return;
            }
            self.armed = true;
            out(Event { t_s, what: What::Ready });
        }
        if dt_s == 0.0 {
            self.filter.reset();
        }
        let filtered_n = self.filter.step(shear_n, dt_s);
        let from_n = if self.touches { config.touch_release_n } else { config.touch_n };
        self.touches = pressing_n >= from_n;
        if self.touches {
            self.scroll.stop();
            self.zero.stop();
        } else {
            self.in_the_air(t_s, dt_s, shear_n, pressing_n, bend_deg, out);
        }
        let zero_n = self.zero.at_n();
        let from_zero_n = [filtered_n[0] - zero_n[0], filtered_n[1] - zero_n[1]];
        let on_screen_n = gain::on_screen(&config, from_zero_n);
        let turn = self.clicks.step(&config, t_s, dt_s, pressing_n, self.touches);
        self.turn(t_s, turn, from_zero_n, on_screen_n, out);
        if self.touches && self.clicks.lets_move() {
            self.motion.go(&config, t_s, dt_s, on_screen_n);
        } else {
            self.motion.stay();
        }
        self.report_moves(t_s, out);
    }

    fn in_the_air(
        &mut self,
        t_s: f64,
        dt_s: f64,
        shear_n: [f64; 2],
        pressing_n: f64,
        bend_deg: Option<f64>,
        out: &mut impl FnMut(Event),
    ) {
        let lines = self.scroll.step(&self.config, t_s, dt_s, bend_deg);
        if lines != 0 {
            out(Event { t_s, what: What::Scroll { lines } });
        }
        let bends = |bend_deg: f64| scroll::beyond_rest_deg(&self.config, bend_deg) != 0.0;
        if self.config.scroll && bend_deg.is_some_and(bends) {
            self.zero.stop();
        } else if let Some([fx_n, fy_n]) = self.zero.step(&self.config, t_s, shear_n, pressing_n) {
            out(Event { t_s, what: What::Zero { fx_n, fy_n } });
        }
    }

    /// What the button does, with this shear on the sensor's axes and on the screen's.
    fn turn(
        &mut self,
        t_s: f64,
        turn: Turn,
        [fx_n, fy_n]: [f64; 2],
        on_screen_n: [f64; 2],
        out: &mut impl FnMut(Event),
    ) {
        let button = Button::Left;
        match turn {
            Turn::None => {}
            Turn::Onset => self.motion.onset(Some(t_s)),
            Turn::FalseOnset => self.motion.onset(None),
            Turn::Down | Turn::Up => {
                self.motion.take_back(t_s);
                self.report_moves(t_s, out);
                out(Event { t_s, what: What::Button { button, down: turn == Turn::Down } });
            }
            Turn::Tap => {
                out(Event { t_s, what: What::Button { button, down: true } });
                out(Event { t_s, what: What::Button { button, down: false } });
            }
            Turn::Drag | Turn::DownAndDrag => {
                if turn == Turn::DownAndDrag {
                    out(Event { t_s, what: What::Button { button, down: true } });
                }
                self.motion.drag(on_screen_n);
                out(Event { t_s, what: What::Drag { fx_n, fy_n } });
            }
        }
    }

    fn report_moves(&mut self, t_s: f64, out: &mut impl FnMut(Event)) {
        if let Some([dx, dy]) = self.motion.whole() {
            out(Event { t_s, what: What::Move { dx, dy } });
        }
    }

    /// The button goes up, and nothing happens until the finger is seen lifted.
    fn let_go(&mut self, t_s: f64, reason: Reason, out: &mut impl FnMut(Event)) {
        if self.clicks.is_down() {
            out(Event { t_s, what: What::Button { button: Button::Left, down: false } });
        }
        if self.armed {
            out(Event { t_s, what: What::Lost { reason } });
        }
        (self.armed, self.touches, self.valid_s) = (false, false, f64::NAN);
        self.filter.reset();
        self.zero.stop();
        self.clicks = Clicks::new();
        self.scroll.stop();
        self.motion.forget();
    }
}
