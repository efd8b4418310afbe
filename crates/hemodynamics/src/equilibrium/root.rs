//! An equilibrium's lumens, and which count.

/// A lumen below this (over its nominal diameter) is closed: on a capillary of 10 micrometres the wall's thickness of
/// an atom.
pub(super) const LEAST_LUMEN: f64 = 1e-9;
/// Equilibria with all orders of equal units before the search gives up.
pub(super) const MOST_EQUILIBRIA: usize = 10_000;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Root {
    pub(super) vein: f64,
    pub(super) units: Vec<f64>,
    /// Known to be one, by the sign of a derivative; false at a fold within rounding.
    pub(super) certified: bool,
}
