//! Fits to generated recordings whose truth is known.

mod coverage;
mod faults;
mod phantom;
mod recovery;
mod undetermined;
