//! `section` in a pipeline: the simulations of section 4.3 with the thesis' values (Fig. 76 to 78, 88); and `presses`:
//! its experiments on recorded people (Fig. 79 to 82).

use clap::Args;
use serde::Serialize;

use super::presses::{PressFile, read_presses};
use super::{SectionText, section_presses, section_simulations};
use crate::numbers::Numbers;
use lunula::files::write_whole;
use lunula::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Role, Takes, Work};
use lunula::stages::Step;

#[derive(Debug, Serialize)]
struct SectionFigures {
    numbers: Numbers,
}

/// Runs `work`; its text goes to `<name>.md`, its numbers to `numbers.json`.
fn make<J: Job>(
    order: &Order<'_>,
    task: &Work<'_>,
    work: impl FnOnce() -> anyhow::Result<SectionText> + Send,
) -> anyhow::Result<Made> {
    let name = J::KIND.name;
    let report = task.report::<J, _>(order.said, name, || {
        let SectionText { text, numbers } = work()?;
        write_whole(&task.folder.join(format!("{name}.md")), text.as_bytes())?;
        write_whole(&task.folder.join("numbers.json"), numbers.to_text().as_bytes())?;
        Ok(SectionFigures { numbers })
    })?;
    Ok(report.made(Vec::new()))
}

/// A stage that simulates.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct SectionJob {}

impl Job for SectionJob {
    const KIND: Kind = Kind::of::<Self>("section", &[], &[Part::new("section", "")]).revision(2);

    fn steps(&self, _inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(vec![
            Step::new("tune", true, "stiffness and damping to the measured time constants".to_owned()),
            Step::new("steps", true, "of ten loads, two sets of values, two places".to_owned()),
            Step::new("steady states", true, "along the load".to_owned()),
            Step::new("lag", true, "under a load that grows".to_owned()),
        ])
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (64_000_000, 12.0)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        make::<Self>(order, work, || section_simulations(work.folder))
    }
}

/// A stage that fits the model to recorded people.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct PressesJob {}

impl Job for PressesJob {
    const KIND: Kind = Kind::of::<Self>(
        "presses",
        &[Role::new("data", Takes::Many, "presses as `lunula fit` reads them; slow ones have no time_s")],
        &[Part::new("presses", "")],
    );

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        Ok(vec![
            Step::new("static curves", true, format!("of those of {} files without time_s", inputs.len())),
            Step::new("fit", true, "stiffness and damping to all quick presses".to_owned()),
        ])
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        (64_000_000, 0.5 * inputs.len() as f64)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        make::<Self>(order, work, || {
            let files: Vec<PressFile<'_>> = work
                .of("data")
                .map(|at| PressFile { path: &at.path, name: &at.name, subject: at.keys.get("subject").unwrap_or("") })
                .collect();
            section_presses(&read_presses(&files)?, work.folder)
        })
    }
}
