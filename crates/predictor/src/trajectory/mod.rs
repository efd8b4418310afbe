//! Calibration trajectories (sections 5.2.2 and 5.2.3): what a prompter asks a finger to do, how fast that may be, and
//! how evenly it covers the space of forces.
//!
//! In: the parameters of the thesis. Out: forces `[Fx, Fy, Fz]` in newtons or J2 in degrees at any time, the limits of
//! equations 19 to 26, and measures of coverage of any rows of forces, planned or recorded.
//!
//! Forces are those of the finger on the surface: pressing is a negative Fz. The equations' own F_z is how hard the
//! finger presses, here the pressing N = -Fz.
//!
//! | equation | here |
//! |---|---|
//! | 19, % error = F' tau / F = f tau | [`rate_limit_per_s`], [`rate_limits`] |
//! | 20, dt = a F_z dF_z | a = 2 T / N_max^2 for equation 21 |
//! | 21 to 23, the spiral | [`Spiral`] |
//! | 24, 2 pi f_c < f | [`circling_limit_hz`] |
//! | 25, the radial rate's maximum | `Spiral::radial_rate_{printed,true,max}_n_per_s` |
//! | 26, how long it has to take | `Spiral::{shortest_printed_s, shortest_true_s, shortest_s}` |
//! | 27, bending | [`Bending`] |

mod bending;
mod coverage;
mod random;
mod space;
mod speed;
mod spiral;
mod wave;

pub use bending::{Bending, RandomBending};
pub use coverage::{CONE_CELLS, ConeCoverage, Evenness, Hole, cell_middle_n, cone_cell, cone_coverage};
pub use random::RandomForce;
pub use space::{Density, ForceSpace, ForceSpaceFault};
pub use speed::{RateLimits, circling_limit_hz, rate_limit_per_s, rate_limits};
pub use spiral::{RELEASE_S, Spiral};
pub use wave::Wave;

/// From 0 to 1 between 0 and 1, with slope 0 at both ends; 0 before and 1 after.
#[must_use]
pub fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// The normal distribution function, to 5e-4 (the tanh approximation of Hendrycks and Gimpel 2016).
fn normal(z: f64) -> f64 {
    0.5 * (1.0 + ((2.0 / std::f64::consts::PI).sqrt() * (z + 0.044_715 * z * z * z)).tanh())
}
