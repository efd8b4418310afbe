//! What a simulated person achieves with the pointer: throughput, drift at rest, displacement by a click, clicks that
//! nobody meant.
//!
//! In: a [`Config`](super::Config), a [`Person`], seeds, and a sensor: a function from the time and the true force to
//! the predicted one, `|_, force| force` for an ideal sensor, a [`SensorModel`], or a whole phantom. Out: figures, the
//! same for the same seeds. They are of a simulation: they compare settings and sensors with each other, and promise
//! nothing of people.
//!
//! Conventions: `[Fx, Fy, Fz]` newtons of the finger on the surface, pressing is a negative `Fz`; seconds; px.

mod click;
mod hand;
mod person;
mod rest;
mod sensor;
mod task;
#[cfg(test)]
mod tests;
mod throughput;

pub use click::{Displacement, Spread, click_displacement};
pub use person::Person;
pub use rest::{Inadvertent, Rest, inadvertent_clicks, rest_drift};
pub use sensor::SensorModel;
pub use task::Task;
pub use throughput::{Condition, Throughput, throughput};

/// Samples a second of all simulations (assumed: four times the thesis' 25 Hz, as a modulated sensor of today).
pub const RATE_HZ: f64 = 100.0;
