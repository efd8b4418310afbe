//! `lunula simulate --static`: every equilibrium for a range of loads (Fig. 78).

mod figure;
mod job;
mod kind;
mod options;
mod report;
mod table;

pub use job::{curve, plan as curve_plan};
pub use options::{CurveOptions, CurveRange, LoadRange};
pub use report::{CurveFigures, CurvePoint, CurveReport, Fold};
