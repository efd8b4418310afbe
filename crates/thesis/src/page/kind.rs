//! `study` in a pipeline: the page with a counterpart of every data figure of the thesis and every statement of its
//! text beside what came out.

use super::{PageOptions, Part as StudyPart, PartFolder, study_page};
use lunula::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Role, Takes, Work};
use lunula::stages::Step;
use lunula::words::Words;

/// A role for each of the study's parts, and named as it.
const ROLES: [Role; StudyPart::WORDS.len()] = {
    let mut roles = [Role { name: "", takes: Takes::AnyNumber, about: "" }; StudyPart::WORDS.len()];
    let mut k = 0;
    while k < roles.len() {
        (_, roles[k].name, roles[k].about) = StudyPart::WORDS[k];
        k += 1;
    }
    roles
};

impl Job for PageOptions {
    const KIND: Kind = Kind::of::<Self>(
        "study",
        &ROLES,
        &[
            Part::new("page", "study.html"),
            Part::new("statements", "statements.csv"),
            Part::new("numbers", "numbers.json"),
        ],
    )
    .revision(4);

    fn demand(&self, role: &str, _own: &Demand) -> Demand {
        // What the page shows of each, where that is made only if wanted.
        let parts: &[&'static str] = match role {
            "photos" => &["maps", "figures"],
            "touch_training" | "touch_validation" | "touch_test" | "posture_training" | "posture_validation" => {
                &["predicted", "pictures"]
            }
            "modes" | "compare" | "calibration" | "performance" => &["pictures"],
            _ => &[],
        };
        Demand { parts: parts.iter().copied().collect(), ..Demand::default() }
    }

    fn steps(&self, inputs: &[Foreseen], _demand: &Demand) -> Result<Vec<Step>, String> {
        let one = |part: StudyPart| {
            let count = inputs.iter().filter(|input| input.role == part.word()).count();
            let reason = if count == 0 { "no results are named".to_owned() } else { format!("{count} folders") };
            Step::new(part.word(), count > 0, reason)
        };
        Ok(StudyPart::all().map(one).collect())
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (128_000_000, 0.5)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let of = |part: StudyPart| {
            work.of(part.word()).map(move |at| PartFolder {
                part,
                folder: at.path.clone(),
                subject: at.keys.get("subject").unwrap_or_default().to_owned(),
            })
        };
        let folders: Vec<PartFolder> = StudyPart::all().flat_map(of).collect();
        let report = work.run(order.said, |watch| study_page(&folders, self, work.folder, watch))?;
        Ok(report.made(Vec::new()))
    }
}
