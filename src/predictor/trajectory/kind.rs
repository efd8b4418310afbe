//! `trajectory` in a pipeline: tables of forces or angles for a prompter to play (5.2.3).
//!
//! The key `kind` is the command's word, and says which options the others are.

use std::sync::Arc;

use super::job::{plan, run};
use super::{BendingOptions, ForceOptions, KindOptions, RandomOptions, TrajectoryOptions};
use crate::job::{
    Demand, Facts, Foreseen, Given, Job, Kind, Made, OptionFault, Order, Part, Prepared, Work, keys, prepared, read,
};
use crate::stages::Step;

const TABLE: &str = "trajectory.csv";
const KIND: &str = "kind";

/// The keys of all kinds.
fn all_keys() -> Vec<String> {
    let mut all = vec![KIND.to_owned()];
    for key in [keys::<ForceOptions>(), keys::<BendingOptions>(), keys::<RandomOptions>()].concat() {
        if !all.contains(&key) {
            all.push(key);
        }
    }
    all
}

/// Reads the keys of the kind that the table names.
fn prepare(table: &toml::Table) -> Result<Arc<dyn Prepared>, OptionFault> {
    let mut table = table.clone();
    let word = table.remove(KIND);
    match word.as_ref().and_then(toml::Value::as_str) {
        Some(word @ "force") => prepare_kind::<ForceOptions>(word, &table),
        Some(word @ "posture") => prepare_kind::<BendingOptions>(word, &table),
        Some(word @ "random") => prepare_kind::<RandomOptions>(word, &table),
        _ => {
            let what = match word {
                Some(word) => format!("`{KIND}` is {word}: choose force, posture or random"),
                None => format!("`{KIND}` is needed: force, posture or random"),
            };
            Err(OptionFault { key: KIND.to_owned(), what })
        }
    }
}

fn prepare_kind<K: KindOptions>(word: &str, table: &toml::Table) -> Result<Arc<dyn Prepared>, OptionFault> {
    let Given { options, said } = read::<K>(table, &format!("a {word} trajectory"))?;
    prepared(options.options(), said.and(KIND, word))
}

impl Job for TrajectoryOptions {
    const KIND: Kind = Kind {
        name: "trajectory",
        roles: &[],
        parts: &[Part::new("trajectory", TABLE), Part::pictures("")],
        revision: 1,
        keys: all_keys,
        prepare,
    };

    fn checked(self) -> Result<Self, OptionFault> {
        plan(&self, &Demand::default().outputs("")).map_err(OptionFault::whole)?;
        Ok(self)
    }

    fn steps(&self, _inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        plan(self, &demand.outputs(TABLE)).map_err(|why| why.to_string())
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts { led: Some(false), forces: Some(self.is_force()), ..Facts::default() }
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (48_000_000, 0.1 + 2e-6 * self.rows() + 1e-3 * self.whole_s())
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let outputs = order.demand.outputs(work.folder.join(TABLE));
        let report = work.run(order.said, |watch| run(self, &outputs, watch))?;
        Ok(report.made(Vec::new()))
    }
}
