//! Equilibria: to start from, to linearize at, and along a range of loads.

use lunula_hemodynamics::{
    Collapse, EquilibriumFault, Inputs, LoadRange, Loads, Model, Optics, Parameters, Photodiodes, Stability, State,
    Turn, TurnKind, load_curve, rest as at_rest,
};

use crate::hemodynamics::HemodynamicsError;
use crate::hemodynamics::choices::Pressed;
use crate::hemodynamics::curve::{CurvePoint, Fold};
use crate::hemodynamics::given::{Start, read_state};

/// The state of a fingertip that nothing presses.
///
/// # Errors
/// Parameters with which it does not rest, or not in one way.
pub(in crate::hemodynamics) fn rest(parameters: &Parameters) -> Result<State, HemodynamicsError> {
    let found = at_rest(&Model::new(parameters, Collapse::Error), &Inputs::unloaded(parameters));
    Ok(found.map_err(|why| HemodynamicsError::Model(format!("at rest: {why}")))?.state)
}

/// The state that a run starts from.
///
/// # Errors
/// A file that holds none, or loads with no stable equilibrium, or with several.
pub(in crate::hemodynamics) fn start_state(
    start: Option<&Start>,
    parameters: &Parameters,
    loads: &Loads,
    collapse: Collapse,
) -> Result<State, HemodynamicsError> {
    match start {
        Some(Start::Zero) => Ok(State::undisplaced(parameters)),
        Some(Start::File(path)) => read_state(path, parameters),
        None => state_before(0.0, parameters, loads, collapse),
    }
}

/// The equilibrium of the loads just before a time, s.
///
/// # Errors
/// Loads with no stable equilibrium, or with several.
pub fn state_before(
    from_s: f64,
    parameters: &Parameters,
    loads: &Loads,
    collapse: Collapse,
) -> Result<State, HemodynamicsError> {
    let found = at_rest(&Model::new(parameters, collapse), &loads.before(from_s));
    found.map(|one| one.state).map_err(|why| {
        let hint = match why {
            EquilibriumFault::None { .. } => {
                " (a run begins in the equilibrium of the loads just before its first time; --from zero or FILE \
                 begins elsewhere)"
            }
            EquilibriumFault::Several { .. } => " (--from FILE: the last row of a run that led there)",
            _ => "",
        };
        HemodynamicsError::Model(format!("{why}{hint}"))
    })
}

/// The equilibria of a range of loads.
#[derive(Debug, Clone)]
pub struct Curve {
    /// In the order of the loads; a load without an open equilibrium has a point that says so.
    pub points: Vec<CurvePoint>,
    /// Where equilibria appear, vanish or change.
    pub folds: Vec<Fold>,
    /// Loads at which more than one equilibrium is stable, Pa.
    pub bistable_pa: Vec<[f64; 2]>,
    /// Loads at which no equilibrium is open, Pa.
    pub closed_pa: Vec<[f64; 2]>,
}

/// All equilibria at growing loads over blood pressures that don't change.
///
/// # Errors
/// Parameters whose equilibria are not known.
pub fn along(
    parameters: &Parameters,
    collapse: Collapse,
    optics: &Optics,
    pressed: Pressed,
    loads_pa: &[f64],
    [upstream_pa, downstream_pa]: [f64; 2],
) -> Result<Curve, HemodynamicsError> {
    let model = Model::new(parameters, collapse);
    let photodiodes = Photodiodes::new(parameters, optics).map_err(HemodynamicsError::model)?;
    let others = Inputs { upstream_pa, downstream_pa, ..Inputs::default() };
    let found = load_curve(&model, &others, pressed, loads_pa).map_err(HemodynamicsError::model)?;
    let mut known = found.points.iter().peekable();
    let mut points = Vec::new();
    for &load_pa in loads_pa {
        let before = points.len();
        while let Some(one) = known.next_if(|one| one.load_pa == load_pa) {
            let mut volts = vec![0.0; photodiodes.len()];
            photodiodes.voltages(&one.equilibrium.state.lumens, &mut volts);
            points.push(CurvePoint {
                load_pa,
                lumens: Some(one.equilibrium.state.lumens.clone()),
                volts,
                branch: Some(one.branch + 1),
                stable: match one.equilibrium.stability {
                    Stability::Stable => Some(true),
                    Stability::Unstable => Some(false),
                    Stability::Marginal => None,
                },
                slowest_s: one.equilibrium.slowest_s(),
            });
        }
        if points.len() == before {
            points.push(CurvePoint::none(load_pa));
        }
    }
    let fold = |turn: &Turn| {
        let mut volts = vec![0.0; photodiodes.len()];
        photodiodes.voltages(&turn.state.lumens, &mut volts);
        let what = match turn.kind {
            TurnKind::Fold => "fold".to_owned(),
            TurnKind::Closing(site) => format!("{site} closes"),
            TurnKind::Exchange => "stability changes".to_owned(),
        };
        Fold { load_pa: turn.load_pa, what, volts }
    };
    let ranges = |of: fn(&LoadRange) -> bool| -> Vec<[f64; 2]> {
        let mut joined: Vec<[f64; 2]> = Vec::new();
        for range in found.ranges.iter().filter(|range| of(range)) {
            match joined.last_mut() {
                Some(last) if last[1] == range.from_pa => last[1] = range.to_pa,
                _ => joined.push([range.from_pa, range.to_pa]),
            }
        }
        joined
    };
    Ok(Curve {
        points,
        folds: found.turns.iter().map(fold).collect(),
        bistable_pa: ranges(LoadRange::bistable),
        closed_pa: ranges(LoadRange::collapsed),
    })
}
