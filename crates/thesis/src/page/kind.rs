//! `study` in a pipeline: the page with a counterpart of every data figure of the thesis and every statement of its
//! text beside what came out.

use super::{PageOptions, Part as StudyPart, PartFolder, study_page};
use lunula::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Role, Takes, Work};
use lunula::stages::Step;

const fn role(name: &'static str, about: &'static str) -> Role {
    Role { name, takes: Takes::AnyNumber, about }
}

impl Job for PageOptions {
    /// Its roles are named as the study's parts.
    const KIND: Kind = Kind::of::<Self>(
        "study",
        &[
            role("rising", "one nail under rising force"),
            role("film_green", "a sensor and a camera on one nail, the camera's green"),
            role("film_ratio", "the same, the camera's green over red"),
            role("normal", "responses to normal force"),
            role("lateral", "responses to lateral shear"),
            role("longitudinal", "responses to longitudinal shear"),
            role("bending", "responses to bending"),
            role("typical", "one subject's coloration"),
            role("photos", "maps of photographs"),
            role("section", "the simulations of section 4.3"),
            role("presses", "its experiments"),
            role("calibration", "the trajectory that the person was prompted by"),
            role("touch_training", "the touch model evaluated on what it was trained on"),
            role("touch_validation", "on the third repetition"),
            role("touch_test", "on random touching"),
            role("modes", "the touch model analysed"),
            role("posture_training", "the posture model evaluated on the half that it was trained on"),
            role("posture_validation", "on the second half"),
            role("compare", "models compared over subjects"),
            role("performance", "trials of two methods of control"),
        ],
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
        let one = |part: &StudyPart| {
            let count = inputs.iter().filter(|input| input.role == part.name()).count();
            let reason = if count == 0 { "no results are named".to_owned() } else { format!("{count} folders") };
            Step::new(part.name(), count > 0, reason)
        };
        Ok(StudyPart::ALL.iter().map(one).collect())
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (128_000_000, 0.5)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let of = |part: StudyPart| {
            work.of(part.name()).map(move |at| PartFolder {
                part,
                folder: at.path.clone(),
                subject: at.keys.get("subject").unwrap_or_default().to_owned(),
            })
        };
        let folders: Vec<PartFolder> = StudyPart::ALL.into_iter().flat_map(of).collect();
        let report = work.run(order.said, |watch| study_page(&folders, self, work.folder, watch))?;
        Ok(report.made(Vec::new()))
    }
}
