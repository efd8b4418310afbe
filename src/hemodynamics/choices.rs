//! Choices by a word.

pub use lunula_hemodynamics::LoadPath as Pressed;
use lunula_hemodynamics::{Calibration, Collapse, Optics, Parameters};
use serde::Serialize;

use super::HemodynamicsError;
use super::solve::rest;
use crate::words::Words;

/// How light depends on the capillaries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "their words say it")]
pub enum OpticsChoice {
    #[default]
    BeerLambert,
    Quadratic,
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

impl Words for OpticsChoice {
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Self::BeerLambert, "beer-lambert", "Equation 6: V0 + V1 exp(-alpha d^2)"),
        (Self::Quadratic, "quadratic", "Equation 8, two terms of its series"),
        (Self::Linear, "linear", "The tangent of equation 6 at rest"),
    ];
}

impl Words for Collapse {
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(Self::Error, "error", ""), (Self::Contact, "contact", "")];
}

impl Words for Pressed {
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(Self::Proximal, "proximal", ""), (Self::Distal, "distal", ""), (Self::Both, "both", "")];
}

impl Words for Calibration {
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Self::PerSubject, "subject", ""),
        (Self::PerRecording, "recording", ""),
        (Self::Shared, "shared", ""),
        (Self::Fixed, "held", ""),
    ];
}
