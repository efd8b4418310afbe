//! Who and what is compared.

use std::path::PathBuf;

use clap::Args;
use clap::builder::TypedValueParser;
use lunula::job::{not_negative, one_of};
use lunula::predictor::{ModelChoice, NetworkOptions};
use lunula_predictor::{Kind, Recipe};

/// Models of photodiodes, which these recordings hold.
fn of_photodiodes(model: ModelChoice) -> Result<ModelChoice, String> {
    match model {
        ModelChoice::Eigennails => Err("reads a nail's picture; choose linear, quadratic or network".to_owned()),
        other => Ok(other),
    }
}

/// One person's recordings: tables with photodiodes and targets, or raw logs where forces are predicted.
#[derive(Debug, Clone)]
pub struct Person {
    /// Whose.
    pub name: String,
    /// Three repetitions of the touch protocol: two to train on, the third to validate.
    pub touch: [PathBuf; 3],
    /// Random touching.
    pub touch_random: PathBuf,
    /// Bending with `J2_deg`; its first half is trained on, its second half validates.
    pub bending: PathBuf,
    /// Random bending with `J2_deg`.
    pub bending_random: PathBuf,
}

/// What is compared.
#[derive(Debug, Clone)]
pub struct CompareOptions {
    /// The models, one of a kind.
    pub models: Vec<Recipe>,
    /// For how long the touch protocol bends before it touches (5.2.4), seconds.
    pub bending_s: f64,
}

/// The options of a stage that compares models over people.
#[derive(Debug, Clone, Args)]
pub struct CompareChoices {
    /// The models
    #[arg(
        long,
        value_delimiter = ',',
        value_parser = one_of::<ModelChoice>().try_map(of_photodiodes),
        default_value = "linear,quadratic,network",
    )]
    pub models: Vec<ModelChoice>,
    /// How networks are trained.
    #[command(flatten)]
    pub network: NetworkOptions,
    /// For how long the touch protocol bends before it touches, seconds (5.2.4)
    #[arg(long = "bending-s", default_value_t = 60.0, value_parser = not_negative)]
    pub bending_s: f64,
}

impl CompareChoices {
    /// As the job takes them.
    #[must_use]
    pub fn options(&self) -> CompareOptions {
        let models = self.models.iter().map(|model| self.network.recipe(*model)).collect();
        CompareOptions { models, bending_s: self.bending_s }
    }

    /// Whether a network is among the models.
    pub(super) fn has_network(&self) -> bool {
        self.models.iter().any(|model| matches!(model.kind(self.network.hidden), Kind::Network { .. }))
    }
}
