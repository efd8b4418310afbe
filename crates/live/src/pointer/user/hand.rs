//! A person's finger: forces, from what is seen of the pointer.
//!
//! The person sees the pointer and the target `delay_s` late, foresees where the pointer is now from the speeds
//! intended since, and pushes by as much shear as the pointer's curve, which is learned, needs for a speed in
//! proportion to the distance that is left. Muscles lag, noise grows with the push, and the shear never leaves the cone
//! |F_r| <= mu N.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::RATE_HZ;
use super::person::Person;
use super::sensor::Noise;
use crate::pointer::Config;
use crate::pointer::decide::{off_screen, shear_for_n};

/// A pointer that goes slower rests, px/s.
const SLOW_PX_PER_S: f64 = 8.0;
/// The person stops pushing within this share of the target's radius, and pushes again beyond the other.
const STOPS: f64 = 0.3;
const PUSHES: f64 = 0.6;
/// A press that does nothing is repeated so long after it should have been seen, s.
const WAITS_S: f64 = 0.3;
/// The share of what friction holds that a person uses to push.
const CAREFUL: f64 = 0.9;

/// A round target, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Target {
    pub(super) centre_px: [f64; 2],
    pub(super) radius_px: f64,
}

/// What is seen at one moment.
#[derive(Debug, Clone, Copy)]
struct Sight {
    pointer_px: [f64; 2],
    target: Target,
    /// The speed that was intended then, px/s.
    foreseen_px_per_s: [f64; 2],
}

/// A press under way.
#[derive(Debug, Clone, Copy)]
struct Press {
    began_s: f64,
    /// Shear per newton of pressing that is added.
    slip: [f64; 2],
}

/// A finger and what its person remembers.
#[derive(Debug)]
pub(super) struct Hand {
    person: Person,
    config: Config,
    rng: ChaCha8Rng,
    noise: Noise<2>,
    tremor: Noise<2>,
    hold: Noise<1>,
    seen: VecDeque<Sight>,
    foreseen_px_per_s: [f64; 2],
    pushes: bool,
    rests_since_s: Option<f64>,
    shear_n: [f64; 2],
    press: Option<Press>,
    /// When the last press ended.
    pressed_s: f64,
}

impl Hand {
    pub(super) fn new(person: Person, config: Config, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(2 << 32);
        let noise = |sd, time_s, stream| Noise::new(sd, time_s, seed, stream);
        Self {
            person,
            config,
            rng,
            noise: noise(person.motor_noise, person.noise_time_s, 3 << 32),
            tremor: noise(person.tremor_n, person.noise_time_s, 4 << 32),
            hold: Noise::new(person.hold_noise_n, person.hold_time_s, seed, 5 << 32),
            seen: VecDeque::new(),
            foreseen_px_per_s: [0.0; 2],
            pushes: true,
            rests_since_s: None,
            shear_n: [0.0; 2],
            press: None,
            pressed_s: f64::NEG_INFINITY,
        }
    }

    /// Begins a press: forth, for a while, and back.
    pub(super) fn press(&mut self, t_s: f64) {
        let turn = TAU * self.rng.random_range(0.0..1.0_f64);
        let size = self.person.mu * self.person.slip * self.rng.random_range(0.0..1.0_f64);
        self.press = Some(Press { began_s: t_s, slip: [size * turn.cos(), size * turn.sin()] });
    }

    /// The force that aims at a target and clicks it.
    pub(super) fn aim(&mut self, t_s: f64, pointer_px: [f64; 2], target: Target) -> [f64; 3] {
        self.seen.push_back(Sight { pointer_px, target, foreseen_px_per_s: self.foreseen_px_per_s });
        let late = (self.person.delay_s * RATE_HZ).round() as usize;
        let intended_px_per_s = if self.seen.len() > late { self.judge(t_s) } else { [0.0; 2] };
        let lag_s = self.person.muscle_s + self.person.foreseen_lag_s;
        let share = 1.0 / (1.0 + lag_s * RATE_HZ);
        for (foreseen, intended) in self.foreseen_px_per_s.iter_mut().zip(intended_px_per_s) {
            *foreseen += share * (intended - *foreseen);
        }
        let speed = intended_px_per_s[0].hypot(intended_px_per_s[1]);
        let size_n = if speed > 0.0 { self.config.dead_zone_n + shear_for_n(&self.config, speed) } else { 0.0 };
        let intended_n = intended_px_per_s.map(|part| if speed > 0.0 { part / speed * size_n } else { 0.0 });
        self.force_n(t_s, off_screen(&self.config, intended_n))
    }

    /// The force of a push, on the sensor's axes: with muscles, noise and friction.
    pub(super) fn force_n(&mut self, t_s: f64, intended_n: [f64; 2]) -> [f64; 3] {
        let dt_s = RATE_HZ.recip();
        let most_n = CAREFUL * self.person.mu * self.person.hold_n;
        let size_n = intended_n[0].hypot(intended_n[1]);
        let less = if size_n > most_n { most_n / size_n } else { 1.0 };
        let (noise, tremor_n) = (self.noise.step(dt_s), self.tremor.step(dt_s));
        let share = 1.0 / (1.0 + self.person.muscle_s * RATE_HZ);
        for (shear_n, intended_n) in self.shear_n.iter_mut().zip(intended_n) {
            *shear_n += share * (less * intended_n - *shear_n);
        }
        let (added_n, slip) = self.pressing(t_s);
        let pressing_n = (self.person.hold_n + self.hold.step(dt_s)[0] + added_n).max(0.0);
        let pushed_n = self.shear_n[0].hypot(self.shear_n[1]);
        let shear_n: [f64; 2] = std::array::from_fn(|axis| {
            self.shear_n[axis] + noise[axis] * pushed_n + tremor_n[axis] + slip[axis] * added_n
        });
        let (size_n, friction_n) = (shear_n[0].hypot(shear_n[1]), self.person.mu * pressing_n);
        let held = if size_n > friction_n { friction_n / size_n } else { 1.0 };
        [shear_n[0] * held, shear_n[1] * held, -pressing_n]
    }

    /// The pressing that a click adds, N, and its shear per newton.
    fn pressing(&mut self, t_s: f64) -> (f64, [f64; 2]) {
        let Some(Press { began_s, slip }) = self.press else { return (0.0, [0.0; 2]) };
        let part = (t_s - began_s) / self.person.press_s;
        if part >= 3.0 {
            (self.press, self.pressed_s) = (None, t_s);
            return (0.0, [0.0; 2]);
        }
        let height = smooth(part.min(3.0 - part));
        (height * (self.person.press_n - self.person.hold_n), slip)
    }

    /// What the person makes of what is seen: the speed that is intended, px/s; a press begins where the pointer rests
    /// on the target.
    fn judge(&mut self, t_s: f64) -> [f64; 2] {
        let Some(Sight { pointer_px, target, .. }) = self.seen.pop_front() else { return [0.0; 2] };
        if self.press.is_some() {
            self.rests_since_s = None;
            return [0.0; 2];
        }
        let since: [f64; 2] = std::array::from_fn(|axis| {
            self.seen.iter().map(|sight| sight.foreseen_px_per_s[axis]).sum::<f64>() / RATE_HZ
        });
        let left_px: [f64; 2] = std::array::from_fn(|axis| target.centre_px[axis] - (pointer_px[axis] + since[axis]));
        let far = left_px[0].hypot(left_px[1]) / target.radius_px;
        self.pushes = far > if self.pushes { STOPS } else { PUSHES };
        if self.pushes {
            self.rests_since_s = None;
            return left_px.map(|part| self.person.gain_per_s * part);
        }
        if self.foreseen_px_per_s[0].hypot(self.foreseen_px_per_s[1]) < SLOW_PX_PER_S {
            let since_s = *self.rests_since_s.get_or_insert(t_s);
            // What the last press did is seen late, and waited for.
            let seen = t_s - self.pressed_s >= self.person.delay_s + WAITS_S;
            if seen && t_s - since_s >= self.person.look_s {
                self.press(t_s);
            }
        }
        [0.0; 2]
    }
}

/// From 0 to 1 between 0 and 1, with slope 0 at both ends.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
