//! What a simulated person achieves with the pointer: throughput, drift at rest, displacement by a click, clicks that
//! nobody meant.
//!
//! Of the tests alone, which print the figures of docs/src/jobs/mouse.md. In: a `Config`, a `Person`, seeds, and a
//! sensor: a function from the time and the true force to the predicted one, `|_, force| force` for an ideal sensor or
//! a `SensorModel`. Out: figures, the same for the same seeds. They are of a simulation: they compare settings and
//! sensors with each other, and promise nothing of people.
//!
//! Conventions: `[Fx, Fy, Fz]` newtons of the finger on the surface, pressing is a negative `Fz`; seconds; px.

mod click;
mod desk;
mod hand;
mod person;
mod rest;
mod sensor;
mod task;
mod tests;
mod throughput;

/// Samples a second of all simulations (assumed: four times the thesis' 25 Hz, as a modulated sensor of today).
const RATE_HZ: f64 = 100.0;
