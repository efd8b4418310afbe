//! Presses on time: the finger presses, holds and lets go, again and again, with exact times of both.
//!
//! In: [`Presses`]. Out: `[Fx, Fy, Fz]` at any time, newtons, and each [`Press`]'s times. The force rises smoothly from
//! 0 within 0.1 s of the onset and falls to 0 within 0.05 s of the release (assumed; a finger that lets go takes 0.06 s
//! and more, but refill starts with the release, which should be a moment). There is no shear.

use lunula_predictor::smooth;
use serde::Serialize;

/// How long a press rises and falls, seconds.
const RISE_S: f64 = 0.1;
const FALL_S: f64 = 0.05;

/// Presses one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Presses {
    /// The pressing that is held, newtons.
    pub peak_n: f64,
    /// The first onset, seconds.
    pub first_s: f64,
    /// From an onset to its release, seconds, more than it takes to rise.
    pub held_s: f64,
    /// From a release to the next onset, seconds, more than it takes to fall.
    pub pause_s: f64,
}

/// One press.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// The force begins to rise, seconds.
    pub onset_s: f64,
    /// It begins to fall, seconds.
    pub release_s: f64,
}

impl Default for Presses {
    fn default() -> Self {
        Self { peak_n: 3.0, first_s: 1.5, held_s: 2.5, pause_s: 3.5 }
    }
}

impl Presses {
    /// The presses that begin before `until_s`.
    pub fn until(&self, until_s: f64) -> impl Iterator<Item = Press> {
        let (first_s, held_s, period_s) = (self.first_s, self.held_s, self.held_s + self.pause_s);
        let all = (0u32..).map(move |k| first_s + f64::from(k) * period_s);
        let all = all.map(move |onset_s| Press { onset_s, release_s: onset_s + held_s });
        all.take_while(move |press| press.onset_s < until_s)
    }

    /// `[Fx, Fy, Fz]` at `t_s`, newtons.
    #[must_use]
    pub fn forces_n(&self, t_s: f64) -> [f64; 3] {
        let since_s = t_s - self.first_s;
        if since_s <= 0.0 {
            return [0.0; 3];
        }
        let within_s = since_s % (self.held_s + self.pause_s);
        let held = smooth(within_s / RISE_S) * (1.0 - smooth((within_s - self.held_s) / FALL_S));
        [0.0, 0.0, -self.peak_n * held]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_is_there_from_each_onset_to_just_after_its_release() {
        let presses = Presses::default();
        let all: Vec<Press> = presses.until(20.0).collect();
        assert_eq!(all.len(), 4);
        let pressing_n = |t_s: f64| -presses.forces_n(t_s)[2];
        for press in all {
            let Press { onset_s, release_s } = press;
            assert!(pressing_n(onset_s - 1e-6) == 0.0 && pressing_n(onset_s + 0.01) > 0.0);
            assert!((pressing_n(onset_s + RISE_S + 1e-9) - 3.0).abs() <= 1e-9);
            assert!((pressing_n(release_s - 1e-6) - 3.0).abs() <= 1e-9 && pressing_n(release_s + 0.01) < 2.9);
            assert!(pressing_n(release_s + FALL_S + 1e-9) == 0.0);
        }
    }
}
