//! The model's response to a recording's loads: lumens of the capillaries at every sample, and their derivatives along
//! each coordinate.

use super::recording::{Course, Recording};
use crate::load::{Inputs, Loads};
use crate::model::{Model, Tangent};
use crate::parameters::Parameters;
use crate::sensitivity::{NoRest, Rest, Variation};
use crate::state::State;
use crate::transient::{Order, SolveFault, SolveOptions, Solver, Trajectory};

/// Why the model has no response.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
pub(super) enum NoResponse {
    #[error(transparent)]
    Rest(#[from] NoRest),
    #[error("the equilibrium at sample {0} is at a fold, where it jumps with the parameters")]
    Fold(usize),
    #[error(transparent)]
    Solve(#[from] Box<SolveFault>),
    #[error("the derivatives by the parameters could not be solved for")]
    Derivatives,
}

/// The lumens of the capillaries.
pub(super) struct Response {
    walls: usize,
    directions: usize,
    lumens: Vec<f64>,
    derivatives: Vec<f64>,
}

impl Response {
    pub(super) fn lumen(&self, sample: usize, i: usize) -> f64 {
        self.lumens[sample * self.walls + i]
    }

    pub(super) fn derivative(&self, sample: usize, direction: usize, i: usize) -> f64 {
        self.derivatives[(sample * self.directions + direction) * self.walls + i]
    }
}

/// The memory of responses, and how much was done.
pub(super) struct Responder {
    rest: Rest,
    solver: Option<Solver>,
    trajectory: Trajectory,
    options: SolveOptions,
    pub(super) simulations: u64,
    pub(super) steps: u64,
}

impl Responder {
    pub(super) fn new(rtol: f64) -> Responder {
        Responder {
            rest: Rest::default(),
            solver: None,
            trajectory: Trajectory::default(),
            options: SolveOptions { most_evaluations: MOST_EVALUATIONS, ..SolveOptions::at(rtol) },
            simulations: 0,
            steps: 0,
        }
    }

    /// The response of the model of these parameters.
    pub(super) fn respond(
        &mut self,
        parameters: &Parameters,
        model: &Model,
        tangents: &[Tangent],
        recording: &Recording,
    ) -> Result<Response, NoResponse> {
        let walls = model.walls();
        let unloaded = Inputs::unloaded(parameters);
        let mut lumens = State::undisplaced(parameters).lumens;
        match &recording.course {
            Course::Static { proximal_pa, distal_pa } => {
                self.rest.settle(model, &unloaded, &mut lumens)?;
                let samples = proximal_pa.len();
                let mut response = Response {
                    walls,
                    directions: tangents.len(),
                    lumens: Vec::with_capacity(samples * walls),
                    derivatives: vec![0.0; samples * tangents.len() * walls],
                };
                for (sample, (&proximal_pa, &distal_pa)) in proximal_pa.iter().zip(distal_pa).enumerate() {
                    let inputs = Inputs { proximal_pa, distal_pa, ..unloaded };
                    self.rest.settle(model, &inputs, &mut lumens)?;
                    response.lumens.extend_from_slice(&lumens);
                    let size = tangents.len() * walls;
                    let out = &mut response.derivatives[sample * size..][..size];
                    if !self.rest.derivatives(model, &inputs, &lumens, tangents, out) {
                        return Err(NoResponse::Fold(sample + 1));
                    }
                }
                Ok(response)
            }
            Course::Transient { times_s, proximal, distal, upstream, downstream } => {
                let loads = Loads::on(parameters, proximal.clone(), distal.clone()).with_blood(upstream, downstream);
                let (own_upstream, own_downstream) = (upstream.is_some(), downstream.is_some());
                let tangents: Vec<Tangent> =
                    tangents.iter().map(|tangent| tangent.under(own_upstream, own_downstream)).collect();
                let first = loads.before(times_s[0]);
                let still = Inputs { proximal_pa: 0.0, distal_pa: 0.0, ..first };
                self.rest.settle(model, &still, &mut lumens)?;
                self.rest.settle(model, &first, &mut lumens)?;
                let mut start = vec![0.0; tangents.len() * walls];
                if !self.rest.derivatives(model, &first, &lumens, &tangents, &mut start) {
                    return Err(NoResponse::Fold(1));
                }
                self.transient(model, &tangents, &loads, lumens, start, times_s)
            }
        }
    }

    fn transient(
        &mut self,
        model: &Model,
        tangents: &[Tangent],
        loads: &Loads,
        lumens: Vec<f64>,
        derivatives: Vec<f64>,
        times_s: &[f64],
    ) -> Result<Response, NoResponse> {
        let walls = model.walls();
        self.simulations += 1;
        let solver = self.solver.get_or_insert_with(|| Solver::new(model));
        solver.replace(model);
        let state = State { lumens, rates: vec![0.0; walls] };
        let mut variation = Variation::new(model, tangents, derivatives);
        variation.put_out();
        // Where breakpoints cut the steps short, fewer stages do.
        let pieces = loads.segments(times_s[0], times_s[times_s.len() - 1]).count();
        self.options.order = if pieces > MANY_PIECES { Order::Fifth } else { Order::Auto };
        let done = solver.run_observed(loads, &state, times_s, &self.options, &mut self.trajectory, &mut variation);
        self.steps += variation.steps;
        done.map_err(Box::new)?;
        let (sound, derivatives) = (variation.sound, variation.into_derivatives());
        if !sound || derivatives.len() != times_s.len() * tangents.len() * walls {
            return Err(NoResponse::Derivatives);
        }
        let lumens = (0..times_s.len()).flat_map(|k| self.trajectory.lumens(k).iter().copied()).collect();
        Ok(Response { walls, directions: tangents.len(), lumens, derivatives })
    }
}

/// Pieces of the loads from which on a transient is solved with 3 stages: a smooth one takes fewer steps than this with
/// 5.
const MANY_PIECES: usize = 100;
/// The most evaluations of a transient: a response that needs more is refused.
const MOST_EVALUATIONS: u64 = 1_000_000;
