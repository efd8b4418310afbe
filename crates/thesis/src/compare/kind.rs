//! `compare` in a pipeline: models and sets of recordings over several people (5.4, Fig. 105-113).
//!
//! Recordings of one person are those whose key `subject` is the same; each role has one recording of each person. A
//! person who lacks one is left out and reported.

use std::collections::BTreeSet;
use std::path::PathBuf;

use super::options::CompareChoices;
use super::{Person, compare, compare_plan};
use lunula::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Role, Takes, Work};
use lunula::log::{LogReading, ReadingCost, ambient_step};
use lunula::stages::Step;

const SUBJECT: &str = "subject";

impl Job for CompareChoices {
    const KIND: Kind = Kind::of::<Self>(
        "compare",
        &[
            Role::new("set1", Takes::Many, "the touch protocol's first repetition, of each subject"),
            Role::new("set2", Takes::Many, "the second, which is trained on as well"),
            Role::new("set3", Takes::Many, "the third, which validates"),
            Role::new("random", Takes::Many, "random touching"),
            Role::new("bending", Takes::Many, "bending, with J2"),
            Role::new("bending_random", Takes::Many, "random bending, with J2"),
        ],
        &[Part::new("table", "comparisons.csv"), Part::pictures("")],
    );

    fn demand(&self, role: &str, own: &Demand) -> Demand {
        let bends = role == "bending" || role == "bending_random";
        let joints = bends.then(|| "J2".to_owned()).into_iter().collect();
        Demand { parts: BTreeSet::new(), joints: Some(joints), clock: own.clock }
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let people: BTreeSet<_> = inputs.iter().filter_map(|input| input.keys.get(SUBJECT)).collect();
        let out = demand.outputs("");
        let mut steps = compare_plan(people.len(), &self.options(), Some(&out));
        let roles: Vec<&str> = Self::KIND.roles.iter().map(|role| role.name).collect();
        steps.insert(1, ambient_step(inputs, &roles, &LogReading::default()));
        Ok(steps)
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let ReadingCost { memory, seconds, rows } = ReadingCost::of(inputs);
        let fit_s = if self.has_network() { self.network.cost_s(rows) } else { 1e-5 * rows };
        (memory, seconds + 0.5 + fit_s)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let subjects: BTreeSet<&str> = work.inputs.iter().filter_map(|at| at.keys.get(SUBJECT)).collect();
        let (mut people, mut failed) = (Vec::new(), Vec::new());
        for subject in subjects {
            match person(work, subject) {
                Ok(one) => people.push(one),
                Err(why) => failed.push(why),
            }
        }
        anyhow::ensure!(
            !people.is_empty() || !failed.is_empty(),
            "no recording has the key `{SUBJECT}`, which says whose it is"
        );
        anyhow::ensure!(!people.is_empty(), "nobody has all six recordings: {}", failed.join("; "));
        let out = order.demand.outputs(work.folder);
        let options = self.options();
        let mut report = work.run(order.said, |watch| compare(&people, &options, Some(&out), watch))?;
        report.failed = failed;
        Ok(report.made(Vec::new()))
    }
}

/// One person's recordings; else what is wrong with them.
fn person(work: &Work<'_>, subject: &str) -> Result<Person, String> {
    let one = |role: &str| -> Result<PathBuf, String> {
        let mut own = work.of(role).filter(|at| at.keys.get(SUBJECT) == Some(subject));
        match (own.next(), own.next()) {
            (Some(at), None) => Ok(at.path.clone()),
            (Some(at), Some(other)) => {
                Err(format!("{role} is {} as well as {}: narrow it with `where`", at.name, other.name))
            }
            (None, _) => Err(format!("there is no {role}")),
        }
    };
    let all = || -> Result<Person, String> {
        Ok(Person {
            name: subject.to_owned(),
            touch: [one("set1")?, one("set2")?, one("set3")?],
            touch_random: one("random")?,
            bending: one("bending")?,
            bending_random: one("bending_random")?,
        })
    };
    all().map_err(|why| format!("subject {subject}: {why}"))
}
