//! A run over time, and how it ended.

use lunula_hemodynamics::{
    Collapse, Loads, Model, Optics, Parameters, Photodiodes, SolveFault, SolveOptions, State, Statistics, Trajectory,
    simulate,
};

use crate::hemodynamics::simulate::Collapsed;
use crate::hemodynamics::{HemodynamicsError, Response};

/// How a run is solved.
#[derive(Debug, Clone)]
pub struct RunSettings {
    /// What happens where a vessel closes.
    pub collapse: Collapse,
    /// See the command line.
    pub rtol: f64,
    /// How light depends on the capillaries.
    pub optics: Optics,
    /// When the run starts, s.
    pub from_s: f64,
}

/// What a run gave.
#[derive(Debug, Clone)]
pub struct Run {
    /// All rows, or those before a vessel closed.
    pub response: Response,
    /// What the solver did.
    pub work: Statistics,
    /// The vessel that closed.
    pub collapsed: Option<Collapsed>,
}

/// Solves for rows at `times_s` from `start` on.
///
/// # Errors
/// Whatever ends a run but a vessel that closes.
pub fn respond(
    parameters: &Parameters,
    loads: &Loads,
    start: &State,
    times_s: &[f64],
    settings: &RunSettings,
) -> Result<Run, HemodynamicsError> {
    let model = Model::new(parameters, settings.collapse);
    let photodiodes = Photodiodes::new(parameters, &settings.optics).map_err(HemodynamicsError::model)?;
    let options = SolveOptions { start_s: Some(settings.from_s), ..SolveOptions::at(settings.rtol) };
    let (trajectory, collapsed) = match simulate(&model, loads, start, times_s, &options) {
        Ok(trajectory) => (trajectory, None),
        Err(SolveFault::Collapsed { site, time_s, before }) => {
            (*before, Some(Collapsed { vessel: site.to_string(), time_s }))
        }
        Err(why) => return Err(HemodynamicsError::model(why)),
    };
    Ok(Run {
        response: response(&trajectory, model.walls(), &photodiodes),
        work: trajectory.statistics().clone(),
        collapsed,
    })
}

fn response(trajectory: &Trajectory, walls: usize, photodiodes: &Photodiodes) -> Response {
    let rows = trajectory.len();
    let mut response = Response {
        times_s: trajectory.times_s().to_vec(),
        walls,
        lumens: Vec::with_capacity(rows * walls),
        rates: Vec::with_capacity(rows * walls),
        volts: vec![0.0; rows * (walls - 1)],
    };
    for row in 0..rows {
        response.lumens.extend(trajectory.lumens(row));
        response.rates.extend(trajectory.rates(row));
    }
    let volts = response.volts.chunks_exact_mut(walls - 1);
    volts.enumerate().for_each(|(row, volts)| photodiodes.voltages(trajectory.lumens(row), volts));
    response
}
