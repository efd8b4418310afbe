//! `skill` in a pipeline: what fingers did in trials (6.3).

use super::job::{FIGURES, plan, run};
use super::options::{SkillInputs, SkillOptions};
use super::table::TABLE;
use crate::job::{At, Demand, Foreseen, Job, Kind, Made, OptionFault, Order, Part, Role, Takes, Work};
use crate::log::ReadingCost;
use crate::predictor::DataFile;
use crate::stages::Step;

/// A recording; a trial is what the key `trial` says, else the session, else all keys but the person's.
fn recording(at: &At) -> DataFile {
    let file = DataFile::from(at);
    let trial = at.keys.get("trial").map(str::to_owned);
    DataFile { session: trial.or(file.session).or_else(|| at.keys.others("subject")), ..file }
}

impl Job for SkillOptions {
    const KIND: Kind = Kind::of::<Self>(
        "skill",
        &[
            Role::new("recordings", Takes::Many, "tables or logs with time_s and FINGER.Fz_N"),
            Role::new("reference", Takes::Optional, "a trial that the others are compared with"),
        ],
        &[Part::new("skill", FIGURES), Part::new("table", TABLE), Part::pictures("")],
    )
    .revision(11);

    fn checked(self) -> Result<Self, OptionFault> {
        let faults = self.faults();
        if faults.is_empty() { Ok(self) } else { Err(OptionFault::whole(faults.join("; "))) }
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let recordings = inputs.iter().filter(|input| input.role == "recordings").count();
        let reference = Foreseen::of(inputs, "reference").is_some();
        plan(recordings, reference, self, &demand.outputs("")).map_err(|why| why.to_string())
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let ReadingCost { memory, seconds, rows } = ReadingCost::of(inputs);
        // Measured: 0.015 s for a picture, 1 us for a row, with warping.
        (memory + (16 << 20), seconds + 0.1 + 1e-6 * rows + 0.015 * inputs.len() as f64)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let inputs = SkillInputs {
            recordings: work.of("recordings").map(recording).collect(),
            reference: work.one("reference").map(recording),
        };
        let outputs = order.demand.outputs(work.folder);
        let report = work.run(order.said, |watch| run(&inputs, self, &outputs, watch))?;
        Ok(report.made(Vec::new()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Keys;

    #[test]
    fn a_trial_is_called_by_its_keys() {
        let of = |keys: &[(&str, &str)]| {
            let keys = Keys(keys.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect());
            recording(&At { role: "recordings", keys, path: "x/predicted.csv".into(), name: "p".to_owned() }).session
        };
        let (subject, repetition) = (("subject", "anna"), ("repetition", "2"));
        assert_eq!(of(&[subject, repetition, ("session", "1"), ("trial", "3")]).as_deref(), Some("3"));
        assert_eq!(of(&[subject, repetition, ("session", "1")]).as_deref(), Some("1"));
        assert_eq!(of(&[subject, repetition, ("kind", "touch")]).as_deref(), Some("touch 2"));
        assert_eq!(of(&[subject]), None);
    }
}
