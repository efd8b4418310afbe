//! A fingernail sensor with eight photodiodes on a person's nail (sections 3.1.2, 3.3.2 to 3.3.5).
//!
//! In: what the fingertip does over time, a [`Touch`] at each moment. Out: volts that each photodiode adds when the LED
//! is on.
//!
//! The thesis prints its measurements as drawings. The formulae here are assumed; they do what its words say. With the
//! pressing N = -Fz >= 0, all in newtons, and theta = J2:
//!
//! V_i = V0_i + G_i (n_i + x_i + y_i + b_i), where
//! - pressing (3.3.2): n = w (1 - exp(-N / 1.2)) - r (1 - exp(-N / 0.45)) + e (1 - exp(-(N / 2.5)^2)): whitening w
//!   raises P1, P2; at P3, P4 reddening r lowers first and the encroaching whitening e then raises a little;
//! - lateral (3.3.3): x = o tanh(Fx / 1.5) + s (1 - exp(-(Fx / 1.2)^2)): P7 in phase and P5 opposite (o), P2, P3, P4
//!   the same to both sides (s), P1 none;
//! - longitudinal (3.3.4): y = l 0.8 (ln(1 + exp(Fy / 0.8)) - ln 2) + d (1 - exp(-min(Fy, 0)^2)): all in phase, more
//!   sensitive to positive Fy; P1, P2 rise a little with negative Fy (d);
//! - bending (3.3.5): b = c (1 - u)^2 with u = (theta + 10) / (theta_flat + 10) held to 0..1 and theta_flat from 25 to
//!   30 degrees: all fall with flexion, P2 and P3 most, and nothing changes beyond. J1 and J3 have no influence.
//!
//! Where the thesis is silent (P6 and P8, taken for the nearer neighbours of P5 and P7; all sizes) the figures are
//! assumed.
//!
//! A [`WornSensor`] sees the nail's own colour instead, that of the phantom's pictures, at places that a file gives.
//!
//! [`Response`] adds what is not static: hysteresis, evident for forces and little for bending, and the blood's lag, of
//! first order. [`Wander`] and [`Disturbances`] add what the finger does not do.

mod ambient;
mod colour;
mod discs;
mod disturbances;
mod photodiode;
mod response;
mod wander;
mod worn;

pub use ambient::Ambient;
pub use discs::Discs;
pub(in crate::phantom) use discs::disc_samples;
pub use disturbances::{DisturbanceSizes, Disturbances, Elevation, Pulse};
pub use photodiode::{CHANNELS, Photodiode, Sensor};
pub use response::{Dynamics, Following, Response};
pub use wander::Wander;
pub use worn::{WornSensor, person};

/// What a fingertip does at a moment.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Touch {
    /// `[Fx, Fy, Fz]`, those of the finger on the surface, newtons; pressing is a negative Fz.
    pub forces_n: [f64; 3],
    /// J1, J2, J3, radians.
    pub angles_rad: [f64; 3],
}
