//! Synthetic scenes with exact truth: inputs exactly as the jobs read them, and what should come out.
//!
//! A scene is a continuous, band-limited function of the place on the picture. The photograph is that function at the
//! pixel centres, with noise and rounding; the truth is the same function where the job's result should hold it. A
//! sensor's log is likewise the volts of a continuous movement at the samples' times.

mod faults;
pub mod finger;
mod follow;
pub mod force;
pub mod log;
pub mod nail;
pub mod photos;
mod place;
pub mod presses;
mod recording;
pub mod request;
pub mod screen;
pub mod sensor;
pub mod study;
pub mod trajectory;
pub mod video;
mod wave;

pub use faults::Faults;
pub use place::Unwritten;
pub use recording::{Cost, Recording, RecordingError};
