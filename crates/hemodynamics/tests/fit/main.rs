//! Fits to generated recordings whose truth is known.

mod beside;
mod clock;
mod coverage;
mod faults;
mod noise;
mod phantom;
mod recovery;
mod undetermined;
