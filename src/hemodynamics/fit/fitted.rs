//! What a fitted model says to the samples of a recording.

use lunula_hemodynamics::{
    Calibrated, Collapse, Course, Inputs, Loads, Model, Optics, Parameters, Photodiodes, Recording, Stability, Symbol,
    equilibria,
};

use crate::hemodynamics::HemodynamicsError;
use crate::hemodynamics::solve::{RunSettings, respond, rest, state_before};

const RTOL: f64 = 1e-8;

/// The parameters of a recording: its photodiodes' own offset and scaling among them.
pub fn own_parameters(parameters: &Parameters, photodiodes: &[Calibrated], recording: usize) -> Parameters {
    let own = photodiodes.iter().filter(|one| one.recordings.contains(&recording));
    own.fold(parameters.clone(), |parameters, one| {
        let offset = parameters.set(Symbol::Offset(one.unit), one.offset.value).unwrap_or(parameters);
        offset.set(Symbol::Scaling(one.unit), one.scaling.value).unwrap_or(offset)
    })
}

/// Fitted voltages of each photodiode, V, a value a sample.
///
/// # Errors
/// Parameters with which the model has no response to this.
pub fn voltages(
    parameters: &Parameters,
    recording: &Recording,
    collapse: Collapse,
    optics: &Optics,
) -> Result<Vec<Vec<f64>>, HemodynamicsError> {
    let traces = &recording.photodiodes;
    match &recording.course {
        Course::Transient { times_s, proximal, distal, upstream, downstream } => {
            let loads = Loads::on(parameters, proximal.clone(), distal.clone()).with_blood(upstream, downstream);
            let from_s = times_s[0];
            let start = state_before(from_s, parameters, &loads, collapse)?;
            let settings = RunSettings { collapse, rtol: RTOL, optics: optics.clone(), from_s };
            let run = respond(parameters, &loads, &start, times_s, &settings)?;
            if let Some(collapsed) = run.collapsed {
                return Err(HemodynamicsError::Model(collapsed.words()));
            }
            Ok(traces.iter().map(|trace| run.response.photodiode_v(trace.unit)).collect())
        }
        Course::Static { proximal_pa, distal_pa } => {
            let photodiodes = Photodiodes::new(parameters, optics).map_err(HemodynamicsError::model)?;
            let model = Model::new(parameters, collapse);
            let mut at = rest(parameters)?.lumens;
            let mut voltages = vec![Vec::with_capacity(proximal_pa.len()); traces.len()];
            for (&proximal_pa, &distal_pa) in proximal_pa.iter().zip(distal_pa) {
                let inputs = Inputs { proximal_pa, distal_pa, ..Inputs::unloaded(parameters) };
                let mut found = equilibria(&model, &inputs).map_err(HemodynamicsError::model)?;
                found.retain(|one| one.stability != Stability::Unstable);
                let distance = |lumens: &[f64]| lumens.iter().zip(&at).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                let nearest =
                    found.into_iter().min_by(|a, b| distance(&a.state.lumens).total_cmp(&distance(&b.state.lumens)));
                match nearest {
                    Some(one) => {
                        for (own, trace) in voltages.iter_mut().zip(traces) {
                            own.push(photodiodes.voltage(trace.unit, one.state.lumens[trace.unit]));
                        }
                        at = one.state.lumens;
                    }
                    None => voltages.iter_mut().for_each(|own| own.push(f64::NAN)),
                }
            }
            Ok(voltages)
        }
    }
}
