//! `trajectory` in a pipeline: tables of forces or angles for a prompter to play (5.2.3).
//!
//! The key `kind` is the command's word, and says which options the others are.

use std::path::Path;

use super::job::{plan, run};
use super::{BendingOptions, ForceOptions, KindOptions, RandomOptions, TrajectoryOptions, TrajectoryOutputs};
use crate::job::{Demand, Facts, Foreseen, Given, Job, Kind, Made, OptionFault, Order, Part, Said, Work, keys, read};
use crate::stages::Step;

const PICTURES: &str = "pictures";
const TABLE: &str = "trajectory.csv";
const KIND: &str = "kind";

/// A stage of a pipeline.
#[derive(Debug, Clone, Copy)]
pub struct TrajectoryJob(TrajectoryOptions);

fn outputs(folder: &Path, demand: &Demand) -> TrajectoryOutputs {
    TrajectoryOutputs { table: folder.join(TABLE), figures: demand.wants(PICTURES), report: false }
}

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

fn checked(options: TrajectoryOptions) -> Result<TrajectoryJob, OptionFault> {
    plan(&options, None).map_err(|why| OptionFault { key: String::new(), what: why.to_string() })?;
    Ok(TrajectoryJob(options))
}

fn read_kind<K: KindOptions>(word: &str, table: &toml::Table) -> Result<(TrajectoryJob, Said), OptionFault> {
    let Given { options, said } = read::<K>(table, &format!("a {word} trajectory"))?;
    Ok((checked(options.options())?, said.and(KIND, word)))
}

impl Job for TrajectoryJob {
    const KIND: Kind = Kind {
        keys: all_keys,
        ..Kind::of::<Self>(
            "trajectory",
            &[],
            &[
                Part { name: "trajectory", file: TABLE, only_if_wanted: false },
                Part { name: PICTURES, file: "", only_if_wanted: true },
            ],
        )
    };

    type Options = ForceOptions;

    fn new(options: ForceOptions) -> Result<Self, OptionFault> {
        checked(options.options())
    }

    fn read(table: &toml::Table) -> Result<(Self, Said), OptionFault> {
        let mut table = table.clone();
        let word = table.remove(KIND);
        match word.as_ref().and_then(toml::Value::as_str) {
            Some(word @ "force") => read_kind::<ForceOptions>(word, &table),
            Some(word @ "posture") => read_kind::<BendingOptions>(word, &table),
            Some(word @ "random") => read_kind::<RandomOptions>(word, &table),
            _ => {
                let what = match word {
                    Some(word) => format!("`{KIND}` is {word}: choose force, posture or random"),
                    None => format!("`{KIND}` is needed: force, posture or random"),
                };
                Err(OptionFault { key: KIND.to_owned(), what })
            }
        }
    }

    fn steps(&self, _inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        plan(&self.0, Some(&outputs(Path::new(""), demand))).map_err(|why| why.to_string())
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts { led: Some(false), forces: Some(self.0.is_force()), ..Facts::default() }
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (48_000_000, 0.1 + 2e-6 * self.0.rows() + 1e-3 * self.0.whole_s())
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let outputs = outputs(work.folder, order.demand);
        let report = work.run(order.said, |watch| run(&self.0, &outputs, watch))?;
        Ok(report.made(Vec::new()))
    }
}
