//! Equilibria over a load (Figure 78): branches, where they turn or end, and how many there are in between.
//!
//! In: a model, the inputs that don't change, a [`LoadPath`], growing loads. Out: a [`LoadCurve`]: every equilibrium at
//! every load with the number of its branch, the [`Turn`]s at which a branch begins or ends (located to rounding, not
//! to the distance of the loads), and the [`LoadRange`]s between these with the number of equilibria that are stable
//! there.
//!
//! At each load the equilibria are those of [`equilibria`], none missed and none spurious. Curves are followed from
//! each of them that no curve has passed yet, around folds, until they leave the range or a vessel closes; so every
//! equilibrium has its branch, and a fold between two loads is found where it belongs to a branch that reaches one of
//! the loads. What begins and ends between two neighbouring loads is not seen: take loads close enough together.

mod follow;
mod trace;

use crate::load::Inputs;
use crate::model::Model;
use crate::parameters::Site;
use crate::state::State;

use super::{Equilibrium, EquilibriumFault, Stability, equilibria};
use trace::Tracer;

/// What a load presses on, and which load a curve goes over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LoadPath {
    /// `P_F1` grows, `P_F2` stays.
    Proximal,
    /// `P_F2` grows, `P_F1` stays.
    Distal,
    /// Both are the load.
    #[default]
    Both,
}

/// An equilibrium on a branch.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvePoint {
    /// The load, Pa.
    pub load_pa: f64,
    /// The branch, counted from 0: the equilibria that go over into each other as the load changes, up to the next
    /// fold.
    pub branch: usize,
    /// The equilibrium.
    pub equilibrium: Equilibrium,
}

/// What happens where equilibria appear, vanish or change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurnKind {
    /// Two branches meet and end.
    Fold,
    /// A branch ends because a vessel closes.
    Closing(Site),
    /// A branch goes on and is no longer stable, or is again.
    Exchange,
}

/// Where equilibria appear, vanish or change.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// The load, Pa.
    pub load_pa: f64,
    /// What happens.
    pub kind: TurnKind,
    /// The lumens there; all rates are 0.
    pub state: State,
    /// The branches that meet or end there.
    pub branches: Vec<usize>,
}

/// A range of loads between two turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadRange {
    /// Its least load, Pa.
    pub from_pa: f64,
    /// Its greatest load, Pa.
    pub to_pa: f64,
    /// Open equilibria in its middle.
    pub equilibria: usize,
    /// How many of them are stable: 2 and more is bistable.
    pub stable: usize,
}

/// Equilibria over a load.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadCurve {
    /// Every equilibrium at every load, loads growing, by the vein's lumen within one. Loads without an open
    /// equilibrium have none.
    pub points: Vec<CurvePoint>,
    /// Where branches turn or end, by the load.
    pub turns: Vec<Turn>,
    /// From the first load to the last, end on end.
    pub ranges: Vec<LoadRange>,
}

impl LoadPath {
    /// The inputs at a load (Pa) over those that don't change.
    pub fn inputs(self, others: &Inputs, load_pa: f64) -> Inputs {
        match self {
            LoadPath::Proximal => Inputs { proximal_pa: load_pa, ..*others },
            LoadPath::Distal => Inputs { distal_pa: load_pa, ..*others },
            LoadPath::Both => Inputs { proximal_pa: load_pa, distal_pa: load_pa, ..*others },
        }
    }

    /// `[P_F1, P_F2]` of a load where nothing else presses.
    pub fn of(self, load_pa: f64) -> [f64; 2] {
        match self {
            LoadPath::Proximal => [load_pa, 0.0],
            LoadPath::Distal => [0.0, load_pa],
            LoadPath::Both => [load_pa, load_pa],
        }
    }
}

impl LoadRange {
    /// Whether there is no equilibrium with open vessels.
    pub fn collapsed(&self) -> bool {
        self.equilibria == 0
    }

    /// Whether several equilibria are stable, so that the path decides.
    pub fn bistable(&self) -> bool {
        self.stable > 1
    }
}

/// All equilibria along loads (Pa), which have to grow. An error where loads don't grow or are not finite, and those of
/// [`equilibria`].
pub fn load_curve(
    model: &Model,
    others: &Inputs,
    path: LoadPath,
    loads_pa: &[f64],
) -> Result<LoadCurve, EquilibriumFault> {
    for (row, pair) in loads_pa.windows(2).enumerate() {
        if pair[1] <= pair[0] {
            return Err(EquilibriumFault::Order { row: row + 2, load_pa: pair[1], before_pa: pair[0] });
        }
    }
    let at_load = |&load_pa: &f64| equilibria(model, &path.inputs(others, load_pa));
    let found = loads_pa.iter().map(at_load).collect::<Result<Vec<_>, _>>()?;
    let (Some(&first), Some(&last)) = (loads_pa.first(), loads_pa.last()) else {
        return Ok(LoadCurve { points: vec![], turns: vec![], ranges: vec![] });
    };
    let (branches, mut turns) = Tracer::new(model, *others, path, loads_pa, &found).all()?;
    turns.retain(|turn| turn.load_pa >= first && turn.load_pa <= last);
    turns.sort_by(|a, b| a.load_pa.total_cmp(&b.load_pa));
    let mut ends = vec![first];
    ends.extend(turns.iter().map(|turn| turn.load_pa));
    ends.push(last);
    let mut ranges = Vec::new();
    for pair in ends.windows(2) {
        let middle = pair[0] + 0.5 * (pair[1] - pair[0]);
        // Mirror images turn at the same load but for rounding.
        if pair[1] - pair[0] > 1e-11 * pair[1].abs().max(1.0) {
            let all = equilibria(model, &path.inputs(others, middle))?;
            let stable = all.iter().filter(|one| one.stability == Stability::Stable).count();
            ranges.push(LoadRange { from_pa: pair[0], to_pa: pair[1], equilibria: all.len(), stable });
        }
    }
    let mut points = Vec::new();
    for ((&load_pa, at_load), branches) in loads_pa.iter().zip(found).zip(branches) {
        let one = |(equilibrium, branch)| CurvePoint { load_pa, branch, equilibrium };
        points.extend(at_load.into_iter().zip(branches).map(one));
    }
    Ok(LoadCurve { points, turns, ranges })
}

#[cfg(test)]
mod tests;
