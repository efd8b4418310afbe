//! diffsol's BDF on the equations of `lunula-hemodynamics`, for `bench/peers` and for a test that both agree.
//!
//! A package of its own, and none of the workspace's default members: diffsol brings matrices that take minutes to
//! compile.

use std::cell::{Cell, RefCell};

use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod, OdeSolverStopReason, Vector};
use lunula_hemodynamics::{Arrow, Collapse, Inputs, Model, Parameters, State};

/// When the loads end, s.
const HALF_S: f64 = 2.0;
/// The first step after a jump, s: of 1e-5 to 1e-9 the one that served best.
const FIRST_STEP_S: f64 = 1e-7;

/// What a response starts from, and how it is solved.
#[derive(Debug, Clone, Copy)]
pub struct Peer<'a> {
    /// The state before the load.
    pub rest: &'a State,
    /// The absolute tolerance of rates over that of lumens.
    pub rates: f64,
}

/// The loads on the pulp from 0 to 2 s, pascals; none after.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// Over the vein.
    pub proximal_pa: f64,
    /// Over the capillaries of the distal unit.
    pub distal_pa: f64,
}

/// The accelerations of three walls without memory of their own: `Model::accelerations` makes two vectors at every
/// call.
struct Walls {
    push: [f64; 3],
    spring: [f64; 3],
    damper: [f64; 3],
    swept: [f64; 3],
    conductance: [f64; 3],
    resistance: [f64; 2],
}

impl Walls {
    fn new(parameters: &Parameters) -> Walls {
        let walls: Vec<_> = parameters.walls().copied().collect();
        let each = |value: &dyn Fn(usize) -> f64| [value(0), value(1), value(2)];
        let mu = parameters.viscosity_pa_s();
        Walls {
            push: each(&|j| walls[j].area_m2 / (walls[j].mass_kg * walls[j].diameter_m)),
            spring: each(&|j| walls[j].stiffness_n_per_m / walls[j].mass_kg),
            damper: each(&|j| walls[j].damping_n_s_per_m / walls[j].mass_kg),
            swept: each(&|j| walls[j].area_m2 * walls[j].diameter_m),
            conductance: each(&|j| {
                let wall = &walls[j];
                wall.count * std::f64::consts::PI * wall.diameter_m.powi(4) / (128.0 * wall.length_m * mu)
            }),
            resistance: [0, 1].map(|i| parameters.units()[i].venule_pa_s_per_m3),
        }
    }

    fn right(&self, x: &[f64], u: &Inputs, y: &mut [f64]) {
        let g: [f64; 3] = std::array::from_fn(|j| {
            let square = x[j] * x[j];
            self.conductance[j] * (square * square)
        });
        let t: [f64; 2] = std::array::from_fn(|i| 1.0 / (1.0 + g[i] * self.resistance[i]));
        let flow: [f64; 2] = std::array::from_fn(|i| (g[i] * u.upstream_pa - self.swept[i] * x[3 + i]) * t[i]);
        let venous =
            (flow[0] + flow[1] + g[2] * u.downstream_pa - self.swept[2] * x[5]) / (g[0] * t[0] + g[1] * t[1] + g[2]);
        let pressures = [
            self.resistance[0] * flow[0] + venous * t[0],
            self.resistance[1] * flow[1] + venous * t[1] - u.distal_pa,
            venous - u.proximal_pa,
        ];
        for j in 0..3 {
            y[j] = x[3 + j];
            y[3 + j] = self.push[j] * pressures[j] - self.spring[j] * (x[j] - 1.0) - self.damper[j] * x[3 + j];
        }
    }
}

/// The Jacobian at the last state that it was asked for: a matrix is made of six products.
struct Memo {
    at: [f64; 6],
    arrow: Arrow,
}

/// Solves for the lumens at `times`, seconds, and gives how often the right-hand side was evaluated.
///
/// # Errors
/// diffsol's, in its words.
pub fn bdf(peer: &Peer<'_>, step: Step, rtol: f64, times: &[f64], lumens: &mut Vec<[f64; 3]>) -> Result<u64, String> {
    let parameters = Parameters::thesis();
    let (walls, model) = (Walls::new(&parameters), Model::new(&parameters, Collapse::Error));
    let loaded = Inputs {
        upstream_pa: parameters.upstream_pa(),
        downstream_pa: parameters.downstream_pa(),
        proximal_pa: step.proximal_pa,
        distal_pa: step.distal_pa,
    };
    let inputs = Cell::new(loaded);
    let memo = RefCell::new(Memo { at: [f64::NAN; 6], arrow: Arrow::default() });
    let evaluations = Cell::new(0u64);
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(rtol)
        .atol([rtol, rtol, rtol, peer.rates * rtol, peer.rates * rtol, peer.rates * rtol])
        .h0(FIRST_STEP_S)
        .rhs_implicit(
            |x: &[f64], _: &[f64], _: f64, y: &mut [f64]| {
                evaluations.set(evaluations.get() + 1);
                walls.right(x, &inputs.get(), y);
            },
            |x: &[f64], _: &[f64], _: f64, v: &[f64], y: &mut [f64]| {
                let memo = &mut *memo.borrow_mut();
                if memo.at != x[..6] {
                    memo.at.copy_from_slice(&x[..6]);
                    model.jacobian(&x[..3], &x[3..6], &inputs.get(), &mut memo.arrow);
                }
                let arrow = &memo.arrow;
                let mut pressure = 0.0;
                for j in 0..3 {
                    pressure += arrow.pressure_by_lumen[j] * v[j] + arrow.pressure_by_rate[j] * v[3 + j];
                }
                for j in 0..3 {
                    y[j] = v[3 + j];
                    y[3 + j] = arrow.by_lumen[j] * v[j] + arrow.by_rate[j] * v[3 + j] + arrow.by_pressure[j] * pressure;
                }
            },
        )
        .init(
            |_: &[f64], _: f64, y: &mut [f64]| {
                y[..3].copy_from_slice(&peer.rest.lumens);
                y[3..].copy_from_slice(&peer.rest.rates);
            },
            6,
        )
        .build()
        .map_err(|fault| fault.to_string())?;
    let mut solver = problem.bdf::<NalgebraLU<f64>>().map_err(|fault| fault.to_string())?;
    lumens.clear();
    let waiting = times.iter().take_while(|time| **time <= 0.0).count();
    lumens.extend((0..waiting).map(|_| [0, 1, 2].map(|j| peer.rest.lumens[j])));
    let mut next = waiting;
    let mut value = solver.state().y.clone();
    for half_s in [HALF_S, 2.0 * HALF_S] {
        solver.set_stop_time(half_s).map_err(|fault| fault.to_string())?;
        loop {
            let stopped = solver.step().map_err(|fault| fault.to_string())?;
            let reached = matches!(stopped, OdeSolverStopReason::TstopReached);
            let now = if reached { half_s } else { solver.state().t };
            while next < times.len() && times[next] <= now {
                let at = times[next].min(solver.state().t);
                solver.interpolate_inplace(at, &mut value).map_err(|fault| fault.to_string())?;
                lumens.push([0, 1, 2].map(|j| value.get_index(j)));
                next += 1;
            }
            if reached {
                break;
            }
        }
        // Restarted without the load.
        inputs.set(Inputs { proximal_pa: 0.0, distal_pa: 0.0, ..loaded });
        memo.borrow_mut().at = [f64::NAN; 6];
        let state = solver.state_mut();
        *state.h = FIRST_STEP_S;
        let (mut x, mut dy) = ([0.0; 6], [0.0; 6]);
        x.iter_mut().enumerate().for_each(|(j, x)| *x = state.y.get_index(j));
        walls.right(&x, &inputs.get(), &mut dy);
        for (j, dy) in dy.into_iter().enumerate() {
            state.dy.set_index(j, dy);
        }
    }
    Ok(evaluations.get())
}
