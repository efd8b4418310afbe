//! Where the model comes to rest: all equilibria of a load, their stability, and the branches that they form over the
//! load.
//!
//! In: a [`Model`] and the constant [`Inputs`] on it. Out: every state with open vessels at which nothing moves, each
//! with its pressures and eigenvalues ([`equilibria`]); the one at which a finger rests ([`rest`]). In the thesis'
//! words: the steady state of section 4.3.3, of which Figure 78 shows one for each load. There may be none (a vessel
//! collapses) or several (the branch depends on the path).
//!
//! How it is known that none is missed and none is spurious, and what is assumed: module `search`. Lumens are right to
//! 1e-14 away from folds; at a fold, equilibria nearer than 1e-6 D may be reported as one that is
//! [`Stability::Marginal`].

mod curve;
mod eigenvalues;
mod network;
mod polish;
mod root;
mod search;

pub use curve::{CurvePoint, LoadCurve, LoadPath, LoadRange, Turn, TurnKind, load_curve};
pub use eigenvalues::Eigenvalue;

use crate::load::Inputs;
use crate::model::{Arrow, Model, Pressures};
use crate::state::State;
use network::Network;
use root::Root;
use search::GaveUp;

/// What becomes of a small push.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stability {
    /// It decays: every eigenvalue has a negative real part.
    Stable,
    /// It grows.
    Unstable,
    /// Neither within rounding: at a fold, or where nothing damps a motion.
    Marginal,
}

/// A state at which nothing moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// The lumens; all rates are 0.
    pub state: State,
    /// Blood pressures, Pa.
    pub pressures: Pressures,
    /// What becomes of a small push.
    pub stability: Stability,
    /// Eigenvalues of all `2 (n + 1)` motions about it, the slowest to decay (or the fastest to grow) first.
    pub eigenvalues: Vec<Eigenvalue>,
    /// Whether this is known to be one equilibrium, by the sign of a derivative; false at a fold within rounding.
    pub certified: bool,
}

/// Why equilibria could not be found.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum EquilibriumFault {
    #[error("{what} is {value}; an equilibrium needs finite pressures")]
    NotFinite { what: &'static str, value: f64 },
    #[error(
        "the search for all equilibria of {units} units was given up after {choices} choices of open and narrow \
         vessels; use fewer units, or units that are the same"
    )]
    Choices { units: usize, choices: usize },
    #[error(
        "{units} units have more than {most} equilibria, one for each choice of who is open and who is not; use fewer \
         units"
    )]
    Equilibria { units: usize, most: usize },
    #[error(
        "the parameters or pressures are out of all proportion: k D / A has to be from 1e-6 to 1e30 Pa, N pi D^4 / \
         (128 L mu) from 1e-60 to 1e20 m3/(s Pa), R_Vi at most 1e40 Pa s/m3, pressures at most 1e15 Pa"
    )]
    Range,
    #[error(
        "masses, dampings and stiffnesses are so far apart that the eigenvalues about an equilibrium can't be computed"
    )]
    Eigenvalues,
    #[error("the loads of a curve have to grow: {load_pa} Pa (row {row}) comes after {before_pa} Pa")]
    Order {
        /// The row of the later load, from 1.
        row: usize,
        load_pa: f64,
        before_pa: f64,
    },
    #[error(
        "the branch of equilibria could not be followed beyond a load of {load_pa} Pa; ask for loads that lie closer \
         together"
    )]
    Curve { load_pa: f64 },
    #[error(
        "there is no stable equilibrium with open vessels at P_F1 = {} Pa, P_F2 = {} Pa{}; press less, or let walls \
         touch (contact)",
        inputs.proximal_pa,
        inputs.distal_pa,
        if *unstable > 0 { format!(" ({unstable} are not stable)") } else { String::new() }
    )]
    None { inputs: Inputs, unstable: usize },
    #[error(
        "there are {stable} stable equilibria at P_F1 = {} Pa, P_F2 = {} Pa; which one is reached depends on the \
         path: give the state to start from",
        inputs.proximal_pa, inputs.distal_pa
    )]
    Several { inputs: Inputs, stable: usize },
}

/// All equilibria with open vessels (every lumen at least 1e-9 of its nominal diameter) under constant inputs, in the
/// order of the vein's lumen. Empty where there are none. An error where an input is not finite, or where units that
/// differ are so many that the branches can't be counted.
pub fn equilibria(model: &Model, inputs: &Inputs) -> Result<Vec<Equilibrium>, EquilibriumFault> {
    inputs.check(|what, value| EquilibriumFault::NotFinite { what, value })?;
    let network = Network::new(model, inputs);
    if !network.in_range() {
        return Err(EquilibriumFault::Range);
    }
    let roots = search::search(&network).map_err(|given_up| given_up.of(model.units.len()))?;
    roots.iter().map(|root| Equilibrium::of(model, inputs, root)).collect()
}

/// The one stable equilibrium under constant inputs. An error where there is none or where there are several, and those
/// of [`equilibria`].
pub fn rest(model: &Model, inputs: &Inputs) -> Result<Equilibrium, EquilibriumFault> {
    let mut all = equilibria(model, inputs)?;
    let unstable = all.len();
    all.retain(|one| one.stability == Stability::Stable);
    match all.len() {
        0 => Err(EquilibriumFault::None { inputs: *inputs, unstable }),
        1 => Ok(all.remove(0)),
        stable => Err(EquilibriumFault::Several { inputs: *inputs, stable }),
    }
}

impl GaveUp {
    fn of(self, units: usize) -> EquilibriumFault {
        match self {
            GaveUp::Choices(choices) => EquilibriumFault::Choices { units, choices },
            GaveUp::Equilibria(most) => EquilibriumFault::Equilibria { units, most },
        }
    }
}

impl Equilibrium {
    /// Time constants of the motions that decay, s, the slowest first.
    pub fn time_constants_s(&self) -> impl Iterator<Item = f64> + '_ {
        let decaying = self.eigenvalues.iter().filter(|one| one.real_per_s < 0.0);
        decaying.map(|one| -1.0 / one.real_per_s)
    }

    /// The slowest time constant, s; `None` where a motion does not decay.
    pub fn slowest_s(&self) -> Option<f64> {
        (self.stability == Stability::Stable).then(|| self.time_constants_s().next()).flatten()
    }

    /// The stability of an equilibrium that is known in numbers.
    fn in_numbers(model: &Model, inputs: &Inputs, vein: &f64, units: &[f64]) -> Result<Stability, EquilibriumFault> {
        let root = Root { vein: *vein, units: units.to_vec(), certified: true };
        Ok(Equilibrium::of(model, inputs, &root)?.stability)
    }

    fn of(model: &Model, inputs: &Inputs, root: &Root) -> Result<Equilibrium, EquilibriumFault> {
        let mut lumens = root.units.clone();
        lumens.push(root.vein);
        let rates = vec![0.0; lumens.len()];
        let mut arrow = Arrow::default();
        model.jacobian(&lumens, &rates, inputs, &mut arrow);
        let eigenvalues = eigenvalues::eigenvalues(&arrow).ok_or(EquilibriumFault::Eigenvalues)?;
        let stability = if !root.certified { Stability::Marginal } else { stability(&eigenvalues) };
        let pressures = model.pressures(&lumens, &rates, inputs);
        Ok(Equilibrium { state: State { lumens, rates }, pressures, stability, eigenvalues, certified: root.certified })
    }
}

fn stability(eigenvalues: &[Eigenvalue]) -> Stability {
    if eigenvalues.iter().any(|one| one.real_per_s > one.error_per_s) {
        Stability::Unstable
    } else if eigenvalues.iter().all(|one| one.real_per_s < -one.error_per_s) {
        Stability::Stable
    } else {
        Stability::Marginal
    }
}

#[cfg(test)]
mod reference_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin_tests;
