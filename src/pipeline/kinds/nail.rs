//! What the kinds on the hemodynamic model have in common: which nail, values that are written as on the command line,
//! what is left in a folder.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::Path;
use std::str::FromStr;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::options::fault;
use crate::files::beside;
use crate::hemodynamics::GivenParameters;
use crate::hemodynamics::model::Symbol;
use crate::pipeline::kind::{Foreseen, KeyFault, Role, Takes};
use crate::pipeline::task::Work;

/// The role of a parameter file.
pub(super) const PARAMS: Role = Role {
    name: "params",
    takes: Takes::Optional,
    about: "parameters, as fit writes them [default: the thesis' table]",
};

/// Text or a number, as the command line reads it: `pf1 = 5000`, `pf1 = "step:5000@0..2"`.
#[derive(Debug, Clone)]
pub(super) struct Told<T> {
    text: String,
    pub(super) value: T,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Written {
    Number(f64),
    Text(String),
}

impl<'de, T: FromStr<Err: Display>> Deserialize<'de> for Told<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let text = match Written::deserialize(from).map_err(|_| D::Error::custom("write a number or text"))? {
            Written::Number(value) => value.to_string(),
            Written::Text(text) => text,
        };
        Ok(Self { value: text.parse().map_err(D::Error::custom)?, text })
    }
}

impl<T> Serialize for Told<T> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.text.serialize(to)
    }
}

/// Single parameters: `set = { b_V_N_s_per_m = 300 }`.
pub(super) type Settings = BTreeMap<String, f64>;

/// Which nail: the thesis' with so many units and these parameters.
pub(super) fn given(units: Option<u16>, set: &Settings) -> Result<GivenParameters, KeyFault> {
    if units.is_some_and(|units| !(1..=1000).contains(&units)) {
        return Err(fault("units", "choose 1 to 1000"));
    }
    let one = |(name, value): (&String, &f64)| name.parse().map(|symbol: Symbol| (symbol, *value));
    let set = set.iter().map(one).collect::<Result<Vec<_>, String>>().map_err(|why| fault("set", why))?;
    Ok(GivenParameters { file: None, units: units.map(usize::from), set })
}

/// The same from the task's file, where it has one.
pub(super) fn of_task(given: &GivenParameters, work: &Work) -> GivenParameters {
    GivenParameters { file: work.one(PARAMS.name).map(|at| at.path.clone()), ..given.clone() }
}

/// The same from a foreseen file.
pub(super) fn of_foreseen(given: &GivenParameters, inputs: &[Foreseen]) -> GivenParameters {
    let file = inputs.iter().find(|input| input.role == PARAMS.name).map(|input| input.path.clone());
    GivenParameters { file, ..given.clone() }
}

/// Whether all inputs stand, so that a plan can read them.
pub(super) fn all_stand(inputs: &[Foreseen]) -> bool {
    inputs.iter().all(|input| input.stands)
}

/// Takes away the report beside a table: it tells times and places.
pub(super) fn without_report(table: &Path) -> std::io::Result<()> {
    std::fs::remove_file(beside(table, ".run.json"))
}
