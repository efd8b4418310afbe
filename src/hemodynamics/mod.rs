//! The hemodynamic model of section 4.3: loads in, responses, equilibria, fits and pictures out.
//!
//! The model and its mathematics are the crate `lunula-hemodynamics`'; here are the files and the jobs of the command
//! line, an entry each:
//! [`simulate()`], [`curve()`], [`fit()`].

mod choices;
mod curve;
mod error;
pub mod figures;
mod fit;
mod given;
mod grid;
mod response;
mod simulate;
pub mod solve;

/// The crate that does the mathematics.
pub use lunula_hemodynamics as model;
use lunula_hemodynamics::Parameters;

pub use choices::{OpticsChoice, Pressed};
pub use curve::{CurveFigures, CurveOptions, CurvePoint, CurveRange, CurveReport, Fold, LoadRange, curve, curve_plan};
pub use error::HemodynamicsError;
pub use fit::{
    Between, FitAlone, FitFigures, FitInputs, FitOptions, FitReport, FittedPhotodiode, PhotodiodeColumn,
    RecordingColumns, RecordingReport, fit, fit_plan, own_parameters, voltages,
};
pub use given::{BloodOptions, LoadOptions, ModelOptions, Start};
pub use response::Response;
pub use simulate::{
    Collapsed, SimulateFigures, SimulateInputs, SimulateOptions, SimulateReport, simulate, simulate_plan,
};
pub use solve::{Run, RunSettings, respond};

fn named(parameters: &Parameters) -> Vec<(String, f64)> {
    let of = |symbol: lunula_hemodynamics::Symbol| Some((symbol.to_string(), parameters.get(symbol)?));
    parameters.symbols().into_iter().filter_map(of).collect()
}

/// Names and values as an object, in their order.
fn as_map<S: serde::Serializer>(values: &[(String, f64)], to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(values.iter().map(|(name, value)| (name, value)))
}
