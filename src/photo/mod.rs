//! Photographs of nails to coloration maps (section 4.2.2, Fig. 51-56).
//!
//! A photograph is read, outlined, framed, normalized, added up, drawn: [`set`] lists which, [`read`] makes upright pixels,
//! [`outline`] finds the nails, [`frame`] measures axis and box, [`normalize`] brings the green channel into the nail's
//! frame, [`maps`] sums to mean and SD, [`results`] and [`report`] write. [`job`] is the one entry; [`merge`] joins
//! results made in parts ([`partial`]).

pub mod frame;
pub mod job;
pub mod keep;
pub mod maps;
pub mod merge;
pub mod normalize;
pub mod outline;
pub mod partial;
pub mod plan;
mod plane;
pub mod read;
pub mod report;
mod resample;
pub mod results;
pub mod set;

pub use plane::Channel;
