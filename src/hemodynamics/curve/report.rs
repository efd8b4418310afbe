//! What was found along a range of loads.

use std::path::PathBuf;

use serde::Serialize;

use super::LoadRange;
use crate::hemodynamics::choices::{OpticsChoice, Pressed};
use crate::job::Report;

/// An equilibrium, or that there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePoint {
    /// The load, Pa.
    pub load_pa: f64,
    /// Lumens over nominal diameters; none where there is no equilibrium with open vessels.
    pub lumens: Option<Vec<f64>>,
    /// Photodiodes, V.
    pub volts: Vec<f64>,
    /// Equilibria that go over into each other as the load changes have one number, from 1.
    pub branch: Option<usize>,
    /// Whether small changes die away.
    pub stable: Option<bool>,
    /// The slowest time constant, s, of a stable one.
    pub slowest_s: Option<f64>,
}

impl CurvePoint {
    /// A load without an open equilibrium.
    pub(in crate::hemodynamics) fn none(load_pa: f64) -> Self {
        Self { load_pa, lumens: None, volts: Vec::new(), branch: None, stable: None, slowest_s: None }
    }
}

/// A load at which equilibria appear, vanish or change.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fold {
    /// The load, Pa.
    pub load_pa: f64,
    /// `fold`: a stable and an unstable equilibrium meet and end; `V closes`: a vessel does; `stability changes`.
    pub what: String,
    /// Photodiodes there, V.
    pub volts: Vec<f64>,
}

/// What a run did.
pub type CurveReport = Report<CurveFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct CurveFigures {
    /// The table.
    pub table: PathBuf,
    /// Its rows: one for each equilibrium, and one for each load without any.
    pub rows: u64,
    /// Capillary units.
    pub units: usize,
    /// What the loads press on.
    pub load: Pressed,
    /// The loads.
    pub range: LoadRange,
    /// What happens where a vessel closes.
    pub collapse: &'static str,
    /// How light depends on the capillaries.
    pub optics: OpticsChoice,
    /// How many loads.
    pub loads: usize,
    /// Those with one open equilibrium.
    pub with_one: usize,
    /// Those with several.
    pub with_several: usize,
    /// Those with none.
    pub with_none: usize,
    /// Where equilibria appear, vanish or change.
    pub folds: Vec<Fold>,
    /// Loads at which more than one equilibrium is stable, Pa.
    pub bistable_pa: Vec<[f64; 2]>,
    /// Loads at which no equilibrium is open, Pa.
    pub closed_pa: Vec<[f64; 2]>,
    /// The parameters, by their names in files.
    #[serde(serialize_with = "crate::hemodynamics::as_map")]
    pub parameters: Vec<(String, f64)>,
}
