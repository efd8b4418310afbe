//! Synthetic scenes with exact truth: inputs exactly as the jobs read them, and what should come out.
//!
//! A scene is a continuous, band-limited function of the place on the picture. The photograph is that function at the
//! pixel centres, with noise and rounding; the truth is the same function where the job's result should hold it. A
//! sensor's log is likewise the volts of a continuous movement at the samples' times.

pub mod board;
pub mod log;
mod motion;
pub mod nail;
pub mod nailvideo;
pub mod photos;
pub mod request;
mod scene;
pub mod screen;
pub mod sensor;
pub mod video;

pub use motion::{contacts, finger, force, presses, trajectory};
pub use scene::faults::Faults;
pub use scene::place::{Error, Unwritten, in_the_way, refused, staged, write_record};
pub use scene::recording::{Cost, Generated, Written};
