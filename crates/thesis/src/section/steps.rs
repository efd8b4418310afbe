//! Step responses as in Fig. 76 and 77: a load at t = 0, released at t = 2 s, and how long what follows takes; and
//! responses to any load.

use std::path::Path;

use lunula_hemodynamics::{Collapse, Load, Loads, Optics, Parameters, time_constant};

use lunula::hemodynamics::Pressed;
use lunula::hemodynamics::figures::{Curve, N_PER_CM2, Panel, draw_over_time};
use lunula::hemodynamics::solve::{RunSettings, respond, state_before};
use lunula::hemodynamics::{HemodynamicsError, Response};

/// When the load is released, and when the response ends, s.
const RELEASED_S: f64 = 2.0;
const END_S: f64 = 4.0;
/// Rows a second.
const RATE: u32 = 500;

/// The response to a step.
#[derive(Debug, Clone)]
pub(super) struct Stepped {
    pub(super) load_pa: f64,
    pub(super) response: Response,
}

/// What a signal does under a step and after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    /// From rest to the end of the step.
    pub(super) size: f64,
    /// Time constants of loading and of unloading, s.
    pub(super) constants_s: [Option<f64>; 2],
}

/// Answers to steps of these loads.
pub(super) fn steps(
    parameters: &Parameters,
    pressed: Pressed,
    loads_pa: &[f64],
    rtol: f64,
) -> Result<Vec<Stepped>, HemodynamicsError> {
    let rows = (END_S * f64::from(RATE)) as u32;
    let times_s: Vec<f64> = (0..=rows).map(|k| f64::from(k) / f64::from(RATE)).collect();
    let one = |&load_pa: &f64| {
        let step =
            |height: f64| Load::step(height, 0.0, RELEASED_S).map_err(|why| HemodynamicsError::Model(why.to_string()));
        let [proximal, distal] = pressed.of(load_pa);
        let loads = Loads::on(parameters, step(proximal)?, step(distal)?);
        Ok(Stepped { load_pa, response: answer(parameters, &loads, &times_s, rtol)? })
    };
    loads_pa.iter().map(one).collect()
}

/// The answer to loads from t = 0 on, from the equilibrium before.
pub(super) fn answer(
    parameters: &Parameters,
    loads: &Loads,
    times_s: &[f64],
    rtol: f64,
) -> Result<Response, HemodynamicsError> {
    let collapse = Collapse::Error;
    let settings = RunSettings { collapse, rtol, optics: Optics::BeerLambert, from_s: 0.0 };
    let start = state_before(0.0, parameters, loads, collapse)?;
    let run = respond(parameters, loads, &start, times_s, &settings)?;
    match run.collapsed {
        Some(collapsed) => Err(HemodynamicsError::Model(collapsed.words())),
        None => Ok(run.response),
    }
}

/// What a signal of a step response does.
pub(super) fn change(times_s: &[f64], values: &[f64]) -> Change {
    let released = times_s.partition_point(|&time_s| time_s < RELEASED_S);
    Change {
        size: values[released] - values[0],
        constants_s: [
            time_constant(times_s, values, 0.0, RELEASED_S),
            time_constant(times_s, values, RELEASED_S, END_S),
        ],
    }
}

/// A signal of a response, with the words about its panel and its numbers.
pub(super) struct Signal<'a> {
    pub(super) title: &'a str,
    /// The axis, with its unit.
    pub(super) y: &'a str,
    /// What tables and numbers call it.
    pub(super) name: &'a str,
    /// Of its numbers: um, or V, which tables have as mV.
    pub(super) unit: &'a str,
    pub(super) of: &'a dyn Fn(&Response) -> Vec<f64>,
}

/// Signals of step responses over time, a panel each, all loads on it.
pub(super) fn draw(stepped: &[Stepped], signals: &[Signal<'_>], png: &Path, svg: &Path) -> anyhow::Result<()> {
    let panel = |signal: &Signal<'_>| Panel {
        title: signal.title.to_owned(),
        y: signal.y.to_owned(),
        curves: stepped
            .iter()
            .enumerate()
            .map(|(k, one)| {
                // The first and the last are enough to tell which is which.
                let end = k == 0 || k + 1 == stepped.len();
                let name = if end { format!("{} N/cm2", one.load_pa / N_PER_CM2) } else { "between".to_owned() };
                Curve {
                    name: (end || k == 1).then_some(name),
                    times_s: one.response.times_s.clone(),
                    values: (signal.of)(&one.response),
                    colour: if k == 0 { 0 } else { 1 + 4 * usize::from(!end) },
                    width: 2,
                }
            })
            .collect(),
    };
    draw_over_time(&signals.iter().map(panel).collect::<Vec<_>>(), png, svg)
}
