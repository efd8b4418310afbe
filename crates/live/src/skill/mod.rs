//! What fingers do in a trial, from the force with which each presses (thesis 6.3).
//!
//! In: one [`Force`] per finger, on one clock. Out: contacts with the surface ([`contacts`]), what a finger did in them
//! ([`Figures`]), which finger came first ([`ranks`]), and how far a trial is from another ([`distance`]).
//!
//! Conventions: a pressing force is positive here (it is `-Fz_N` of a recording), newtons; NaN is a force that is not
//! known. Where it is not known, or time leaps, a contact ends and another may begin: neither end was seen, and the
//! time between is not counted. Forces are straight lines between rows.

mod contact;
mod figures;
mod force;
mod rest;
mod smooth;
mod warp;

pub use contact::{Contact, Thresholds, contacts};
pub use figures::{Figures, ranks};
pub use force::Force;
pub use rest::noise_of_rate;
pub use smooth::{MOST_SAMPLES, noise_of_white, spectral_arc_length};
pub use warp::{MOST_POINTS, distance, resampled};
