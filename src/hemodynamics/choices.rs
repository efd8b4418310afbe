//! Which optics a job is asked for, by a word.

use lunula_hemodynamics::{Optics, Parameters};
use serde::Serialize;

use super::HemodynamicsError;
use super::solve::rest;

/// How light depends on the capillaries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OpticsChoice {
    /// Equation 6.
    #[default]
    BeerLambert,
    /// Equation 8.
    Quadratic,
    /// The tangent of equation 6 at rest.
    Linear,
}

impl OpticsChoice {
    /// The optics of these parameters; a working point is that of rest.
    ///
    /// # Errors
    /// No rest to linearize at.
    pub fn optics(self, parameters: &Parameters) -> Result<Optics, HemodynamicsError> {
        Ok(match self {
            Self::BeerLambert => Optics::BeerLambert,
            Self::Quadratic => Optics::Quadratic,
            Self::Linear => {
                let mut lumens = rest(parameters)?.lumens;
                lumens.truncate(parameters.units().len());
                Optics::Linear(lumens)
            }
        })
    }
}
