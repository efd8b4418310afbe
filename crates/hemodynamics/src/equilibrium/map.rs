//! Stability maps: over a load and over a factor on some parameters, whether a finger comes to rest.
//!
//! In: parameters, the symbols that are varied together, factors on their values, loads. Out: for every factor and load
//! what [`equilibria`] says of it. The cells don't depend on each other: rows may be made one by one, in parallel
//! ([`stability_row`]).

use super::{EquilibriumFault, LoadPath, Stability, equilibria};
use crate::load::Inputs;
use crate::model::{Collapse, Model};
use crate::parameters::{ParameterFault, Parameters, Symbol};

/// What becomes of a finger under a constant load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fate {
    /// One open equilibrium is stable.
    Converged,
    /// Several are: the path decides.
    Bistable,
    /// No open equilibrium is stable, but there is one: it does not come to rest, or collapses.
    Restless,
    /// There is no open equilibrium: a vessel closes.
    Collapsed,
}

/// A row of a map: one factor, all loads.
#[derive(Clone, Debug, PartialEq)]
pub struct MapRow {
    /// The factor on the parameters' values.
    pub factor: f64,
    /// What becomes of the finger, load by load.
    pub fates: Vec<Fate>,
    /// The slowest time constant of the stable equilibria, s, load by load; `None` where none is stable.
    pub slowest_s: Vec<Option<f64>>,
}

/// Why a map could not be made.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum MapFault {
    #[error("at factor {factor}: {why}")]
    Parameters { factor: f64, why: ParameterFault },
    #[error("at factor {factor}, load {load_pa} Pa: {why}")]
    Equilibria { factor: f64, load_pa: f64, why: EquilibriumFault },
}

/// What is varied over a map, and what is not.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPlan {
    /// The parameters at factor 1.
    pub parameters: Parameters,
    /// The parameters that are multiplied, all by the same factor.
    pub symbols: Vec<Symbol>,
    /// What happens where a vessel closes.
    pub collapse: Collapse,
    /// The inputs that don't change.
    pub others: Inputs,
    /// Which load goes along a row.
    pub path: LoadPath,
    /// The loads, Pa.
    pub loads_pa: Vec<f64>,
}

/// One row of a map. An error where a parameter can't be used, where a load is not finite, or where equilibria can't be
/// counted.
pub fn stability_row(plan: &MapPlan, factor: f64) -> Result<MapRow, MapFault> {
    let multiplied = plan.symbols.iter().try_fold(plan.parameters.clone(), |parameters, &symbol| {
        let value = parameters.get(symbol).unwrap_or(f64::NAN);
        parameters.set(symbol, factor * value)
    });
    let parameters = multiplied.map_err(|why| MapFault::Parameters { factor, why })?;
    let model = Model::new(&parameters, plan.collapse);
    let mut row = MapRow { factor, fates: Vec::new(), slowest_s: Vec::new() };
    for &load_pa in &plan.loads_pa {
        let all = equilibria(&model, &plan.path.inputs(&plan.others, load_pa)).map_err(|why| MapFault::Equilibria {
            factor,
            load_pa,
            why,
        })?;
        let stable = all.iter().filter(|one| one.stability == Stability::Stable);
        row.fates.push(match (stable.clone().count(), all.len()) {
            (1, _) => Fate::Converged,
            (0, 0) => Fate::Collapsed,
            (0, _) => Fate::Restless,
            _ => Fate::Bistable,
        });
        row.slowest_s.push(stable.filter_map(|one| one.slowest_s()).max_by(f64::total_cmp));
    }
    Ok(row)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::tests::load;

    #[test]
    fn soft_capillaries_are_bistable_and_hard_loads_collapse() {
        let plan = MapPlan {
            parameters: Parameters::thesis(),
            symbols: ["k_C1_N_per_m", "k_C2_N_per_m"].map(|name| name.parse().unwrap()).to_vec(),
            collapse: Collapse::Error,
            others: load(0.0, 0.0),
            path: LoadPath::Distal,
            loads_pa: vec![0.0, 5000.0, 11000.0],
        };
        let rows = [1.0, 0.5].map(|factor| stability_row(&plan, factor).unwrap());
        assert_eq!(rows[0].fates, [Fate::Converged, Fate::Converged, Fate::Collapsed]);
        assert_eq!(rows[1].fates, [Fate::Converged, Fate::Bistable, Fate::Collapsed]);
        assert_eq!(rows[1].slowest_s.iter().map(Option::is_some).collect::<Vec<_>>(), [true, true, false]);
        let fault = stability_row(&plan, -1.0).unwrap_err().to_string();
        assert!(fault.starts_with("at factor -1: "), "{fault}");
        let missing = MapPlan { symbols: vec!["k_C3_N_per_m".parse().unwrap()], ..plan };
        assert!(matches!(stability_row(&missing, 1.0), Err(MapFault::Parameters { .. })));
    }
}
