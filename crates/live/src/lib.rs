//! From a fingernail sensor to a decision (thesis 3.1.2, 6.1 to 6.3, appendix C): streams of samples and their clocks,
//! the virtual switch, the wearable mouse, the monitoring of skill, and the analysis of time per decision.
//!
//! In: bytes of a device, or rows of numbers. Out: rows with a time, events, figures.
//!
//! Conventions: times are seconds of the stream's own clock unless a name says otherwise (`_ns` of the host's monotonic
//! clock); forces are newtons of the finger on the surface (pressing is a negative `Fz_N`), angles degrees, positive in
//! flexion. What is not known is NaN or `None`, never zero. What is done for every sample allocates nothing.

pub mod companion;
pub mod latency;
pub mod performance;
pub mod pointer;
pub mod skill;
pub mod source;
pub mod spread;
pub mod switch;
pub mod time;
pub mod wire;
mod words;
