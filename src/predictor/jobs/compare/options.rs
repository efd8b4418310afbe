//! Who and what is compared.

use std::path::PathBuf;

use lunula_predictor::Recipe;

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
