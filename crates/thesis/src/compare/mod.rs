//! The comparisons of section 5.4 (Fig. 105-113): models and sets of recordings over several people.
//!
//! In: of each person three repetitions of the touch protocol, a random touch recording and bending labelled with J2.
//! Out: for each figure a [`Comparison`], RMSE by person with their mean and SD; as a table, as pictures, as Markdown.
//!
//! The first two repetitions are trained on, the third validates; of the bending, the first half of its time is trained
//! on and the second validates. What is reported was never trained on, and no network stops on it (5.3.1 validates on
//! spiral 3 and stops on it too).

mod comparison;
mod halves;
mod kind;
mod measure;
mod options;
mod report;
mod results;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

pub(crate) use halves::HalvesJob;
use lunula::job::{Outputs, Report, Watch};
use lunula::predictor::{PredictorError, end};
use lunula::stages::{Stages, Step, left_out};
use measure::measure;
pub(crate) use measure::rmse;

pub use comparison::{Comparison, Spread};
pub use options::{CompareChoices, CompareOptions, Person};
pub use report::{CompareFigures, CompareReport};

/// Compares models and sets; writes a table, pictures and `run.json` where `out` names a folder.
///
/// # Errors
/// [`PredictorError`] where there is nothing to tell. A model that can't be fitted to somebody's rows is a warning, and
/// missing.
pub fn compare(
    people: &[Person],
    options: &CompareOptions,
    out: Option<&Outputs>,
    watch: &Watch<'_>,
) -> Result<CompareReport, PredictorError> {
    let stages = Stages::default();
    if people.is_empty() || options.models.is_empty() {
        return Err(PredictorError::Request("nothing is compared; name people and models".to_owned()));
    }
    let kinds: Vec<String> = options.models.iter().map(|recipe| recipe.kind.to_string()).collect();
    if let Some(again) = (0..kinds.len()).find(|&k| kinds[..k].contains(&kinds[k])) {
        return Err(PredictorError::Request(format!("the model `{}` is there twice", kinds[again])));
    }
    let measured: Vec<_> = people.par_iter().map(|person| measure(person, options, &stages, watch)).collect();
    let measured = measured.into_iter().collect::<Result<Vec<_>, _>>()?;
    watch.go_on()?;
    let (found, warnings): (Vec<_>, Vec<_>) = measured.into_iter().unzip();
    let comparisons = comparison::over_people(found).map_err(PredictorError::Request)?;
    let figures = CompareFigures { people: people.iter().map(|person| person.name.clone()).collect(), comparisons };
    let left_out = left_out(compare_plan(people.len(), options, out));
    let report = Report { left_out, warnings: warnings.concat(), ..Report::new("compare", watch, figures) };
    end(report, out, |report, out| results::write(report, out, &stages), &stages)
}

/// What would be done and what not, of so many people.
#[must_use]
pub fn compare_plan(people: usize, options: &CompareOptions, out: Option<&Outputs>) -> Vec<Step> {
    let models = options.models.len();
    vec![
        Step::new("read", true, format!("6 files of each of {people} people")),
        Step::new("fit", true, format!("{models} models of touch by 3 sets, {models} of posture, of each")),
        Step::new("subsets", true, "the linear model of each, of each".to_owned()),
        Outputs::table_step(out, "comparisons"),
        Outputs::figures_step(out, "Fig. 105 to 113"),
    ]
}
