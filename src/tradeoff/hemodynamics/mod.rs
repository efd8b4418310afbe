//! The hemodynamic model over its solvers' settings: error against run time on step responses.
//!
//! Twenty responses of 4 s with 400 outputs each: steps of 0.1 to 1.0 N/cm2, released at 2 s, proximal and distal (Fig.
//! 76, 77). The error is the largest `|x - x_ref| / D` of any wall at any output; the reference is the full model by
//! the method of order 13 at its tightest tolerance, which tests of the crate tie to trajectories of 60 digits.

mod bench;
mod modes;

pub(super) use bench::AUTO;
pub use bench::Bench;
pub use modes::measure;
pub(super) use modes::solving_default;

/// By which method, how exactly: job and choice.
pub const SOLVING: (&str, &str) = ("hemodynamics", "solving");
/// The responses, which are the same for any seed.
pub(super) const SCENE: &str = "20 step responses";
/// What the error is.
pub const ERROR: &str = "largest |x - x_ref| / D over 20 step responses, full model";
