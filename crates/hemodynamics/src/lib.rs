//! Blood flow under a pressed fingernail: the lumped-parameter model of section 4.3 of S. Mascaro's thesis.
//!
//! In: [`Parameters`] of the vessels and [`Loads`] on the fingertip. Out: how the capillaries under the nail swell and
//! empty, and what the photodiodes on the nail see of it.
//!
//! Conventions: SI units throughout. Capillary units are counted from proximal to distal, C1, C2, ..; behind them
//! is the vein, V: arrays over walls hold the capillaries first and the vein last. A wall's state is its lumen
//! `d / D` (diameter over nominal diameter, the thesis' `1 + x / D`) and the rate of it `v / D` in 1/s. What is not
//! known is missing (`None`, NaN), never zero.
//!
//! No pictures, no command line.

mod equilibrium;
mod fit;
mod live;
mod load;
mod model;
mod optics;
mod parameters;
mod radau;
mod sensitivity;
mod state;
mod transient;

pub use equilibrium::{
    CurvePoint, Eigenvalue, Equilibrium, EquilibriumFault, LoadCurve, LoadPath, LoadRange, Stability, Turn, TurnKind,
    equilibria, load_curve, rest,
};
pub use fit::{
    Beside, BesidePart, Bound, Bounds, Calibrated, Calibration, Combination, Course, Delay, Estimate, FitFault,
    FitOptions, FitResult, FitStatistics, Free, Group, Recording, Rival, Stop, Trace, fit, noise, time_constant,
};
pub use live::{Live, LiveFault, LiveStatistics};
pub use load::{Inputs, Load, LoadFault, Loads, Segment};
pub use model::{Arrow, Collapse, Matrices, Model, Pressures, Printed, PrintedFault};
pub use optics::{Optics, OpticsFault, Photodiodes};
pub use parameters::{ParameterFault, Parameters, Site, Symbol, Unit, Vessel};
pub use state::{State, StateFault};
pub use transient::{Order, SolveFault, SolveOptions, Solver, Statistics, Trajectory, simulate};

/// The example of the README, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
