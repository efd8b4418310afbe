//! What a simulated person is made of.

/// A person who points. Every default is *assumed*, in the range of the sources named.
#[derive(Debug, Clone, Copy)]
pub(super) struct Person {
    /// From seeing to pushing, s.
    pub(super) delay_s: f64,
    /// Time constant of the muscles, s.
    pub(super) muscle_s: f64,
    /// How late the person has learned that the pointer is beyond that, s: used to foresee where it will be (Miall et
    /// al. 1993, DOI 10.1080/00222895.1993.9942050).
    pub(super) foreseen_lag_s: f64,
    /// The speed per distance that is left, 1/s.
    pub(super) gain_per_s: f64,
    /// SD of the shear, as a share of it (signal-dependent noise: Harris and Wolpert 1998, DOI 10.1038/29528).
    pub(super) motor_noise: f64,
    /// SD of the shear of a finger that rests, N.
    pub(super) tremor_n: f64,
    /// Time constant of both noises, s.
    pub(super) noise_time_s: f64,
    /// Pressing while moving, N.
    pub(super) hold_n: f64,
    /// SD of that pressing, N.
    pub(super) hold_noise_n: f64,
    /// Time constant of its changes, s.
    pub(super) hold_time_s: f64,
    /// Pressing of a click, N.
    pub(super) press_n: f64,
    /// How long the pressing rises, and as long it stays and falls, s.
    pub(super) press_s: f64,
    /// Shear that comes with a press, in a random direction: evenly from 0 to this share of what friction holds of the
    /// pressing that is added.
    pub(super) slip: f64,
    /// Coefficient of friction (5.2.2: about 0.75 on the thesis' platform).
    pub(super) mu: f64,
    /// How long the pointer is to rest on the target before the press, s.
    pub(super) look_s: f64,
}

impl Default for Person {
    fn default() -> Self {
        Self {
            delay_s: 0.2,
            muscle_s: 0.05,
            foreseen_lag_s: 0.1,
            gain_per_s: 3.0,
            motor_noise: 0.1,
            tremor_n: 0.01,
            noise_time_s: 0.1,
            hold_n: 1.0,
            hold_noise_n: 0.05,
            hold_time_s: 0.5,
            press_n: 2.8,
            press_s: 0.12,
            slip: 1.0,
            mu: 0.75,
            look_s: 0.1,
        }
    }
}
