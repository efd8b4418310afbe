//! `lunula simulate --static`: every equilibrium for a range of loads (Fig. 78).

mod figure;
mod job;
mod options;
mod report;
mod table;

pub use job::{CurveOutputs, curve, outline as curve_outline, plan as curve_plan};
pub use options::{CurveOptions, LoadRange, Pressed};
pub use report::{CurvePoint, CurveReport, Fold};
