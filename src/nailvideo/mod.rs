//! A nail followed through a video: virtual photodiodes (thesis sections 3.2.2, 3.3, 4.2 and 7.2).
//!
//! In: a video of a finger and, where it is drawn, the nail's outline on the first frame. Out: what a sensor of
//! photodiodes at given places of the nail would see ([`crate::nail::Positions`]), each value with its standard error
//! and whether it can be believed; the nail's motion; normalized frames and maps; how fast the colour follows each
//! press and release. `first` finds the nail, `follow` follows it by its affine motion from the first good frame,
//! `sample` reads colours through that motion, `press` fits the courses. [`run`] is the one entry.
//!
//! Coordinates are those of the *shown* picture: the centre of its top-left pixel is (0, 0), x to the right, y down. On
//! the nail u is across in half widths, positive to the right with the tip up, v along the axis in half lengths,
//! positive to the tip. The photodiodes' values are of light: the film's curve is undone. Where the nail is, what lies
//! over it, normalized frames and maps are of colours as encoded.

mod affine;
mod error;
mod first;
mod follow;
mod grid;
mod normal;
mod options;
mod press;
mod run;
mod sample;
#[cfg(test)]
mod scenes;

pub use error::NailVideoError;
pub use first::mask_of;
pub use options::{Inputs, Light, NailVideoOptions, Outputs, Window};
pub use run::job::run;
pub use run::kind::NailVideoJob;
pub use run::plan::plan;
pub use run::report::{FrameCounts, MapFigures, NailFigures, NailVideoFigures, NailVideoReport, PhotodiodeFigures};
