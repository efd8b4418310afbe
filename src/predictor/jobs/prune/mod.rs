//! `lunula prune`: which photodiodes could be removed (5.5, Fig. 113), for every subset rather than for one at a time.
//!
//! In: recordings to train on and others to validate on. Out: the linear model's errors on both for every subset of the
//! photodiodes, the best of each size, and Fig. 113's bars. Of more photodiodes than can be tried in every way, the one
//! that is missed least is removed again and again.

mod report;
mod results;

use lunula_predictor::{MOST_INPUTS, Subset, backward_elimination, every_subset, row_hashes, shared_rows};

use crate::job::{Outputs, Report, Watch};
use crate::predictor::data::{DataFile, Wanted, read_files, units};
use crate::predictor::error::PredictorError;
use crate::predictor::jobs::train::parts;
use crate::predictor::merit::figures::ByTarget;
use crate::predictor::outputs::end;
use crate::stages::{Stages, Step, left_out};
pub use report::{PruneFigures, PruneReport, PruneRow};

/// Compares subsets; writes a table and pictures where `out` names a folder.
///
/// # Errors
/// [`PredictorError`] where there is nothing to tell.
pub fn prune(
    data: &[DataFile],
    validate: &[DataFile],
    wanted: &Wanted,
    out: Option<&Outputs>,
    watch: &Watch<'_>,
) -> Result<PruneReport, PredictorError> {
    let stages = Stages::default();
    let train = stages.time("read", || read_files(data, wanted))?;
    let inputs = train.data.inputs().to_vec();
    let same = Wanted { inputs: Some(inputs.clone()), ..wanted.clone() };
    let compared = stages.time("read", || read_files(validate, &same))?;
    watch.go_on()?;
    let targets = train.data.targets().to_vec();
    let row = |subset: &Subset| row(subset, &inputs, &targets);
    let notes = train.notes().chain(compared.notes()).collect();
    let mut warnings = [train.warnings, compared.warnings].concat();
    warnings.extend(units([&train.data, &compared.data]).filter(|unit| !warnings.contains(unit)));
    let shared = shared_rows(&row_hashes(&train.data), &row_hashes(&compared.data));
    if shared > 0 {
        warnings.push(format!(
            "{shared} of {} rows to compare on are among those trained on; their errors flatter. Name recordings that \
             are not",
            compared.data.rows()
        ));
    }
    warnings.extend(parts(&train.data, &compared.data, "compare on"));
    let mut figures = PruneFigures {
        data: train.files,
        validate: compared.files,
        inputs: inputs.clone(),
        targets: targets.clone(),
        ..PruneFigures::default()
    };
    let ambient = DataFile::ambient_step(data.iter().chain(validate), &wanted.rows);
    let mut left_out = left_out(prune_plan([data.len(), validate.len()], ambient, out));
    if inputs.len() > MOST_INPUTS {
        let path = stages.time("subsets", || backward_elimination(&train.data, &compared.data))?;
        figures.all = path.iter().map(row).collect();
        figures.best_of_size = figures.all.iter().rev().cloned().collect();
        left_out.push(format!(
            "most subsets: {} photodiodes have 2^{0} of them; the one missed least was removed again and again",
            inputs.len()
        ));
    } else {
        let found = stages.time("subsets", || every_subset(&train.data, &compared.data))?;
        figures.all = found.all.iter().map(row).collect();
        figures.best_of_size = found.best_of_size.iter().flatten().map(|&k| figures.all[k].clone()).collect();
        figures.without_one = found.without_one.iter().map(|one| figures.all[one.subset].clone()).collect();
        figures.none = Some(ByTarget::new(&targets, found.none.validate_rmse.iter().copied()));
    }
    figures.subsets = figures.all.len();
    if figures.best_of_size.is_empty() {
        let what = "no subset has a model: the photodiodes do not change, or there are too few rows to train on";
        warnings.push(what.to_owned());
    }
    warnings.extend(no_better(&figures));
    watch.go_on()?;
    let report = Report { left_out, warnings, notes, ..Report::new("prune", watch, figures) };
    end(report, out, |report, out| results::write(report, out, &stages), &stages)
}

/// That even all photodiodes say less of what is compared on than none of them, by the targets.
fn no_better(figures: &PruneFigures) -> Option<String> {
    let all = figures.best_of_size.iter().find(|row| row.inputs.len() == figures.inputs.len())?;
    let (with, without) = (all.validate_rmse.as_ref()?, figures.none.as_ref()?);
    let worse = with.0.iter().zip(&without.0).filter(|((_, with), (_, without))| with >= without);
    let worse: Vec<String> =
        worse.map(|((name, with), (_, without))| format!("{name} ({with:.3}, {without:.3})")).collect();
    (!worse.is_empty()).then(|| {
        format!(
            "the errors with all photodiodes are as large as with none of them: {}; what is compared on is another \
             finger's or sensor's, or its columns or times are others': no subset means anything",
            worse.join(", ")
        )
    })
}

/// What would be done and what not; `files`: how many to train and to validate on; `ambient`: their step of
/// [`DataFile::ambient_step`].
#[must_use]
pub fn prune_plan(files: [usize; 2], ambient: Step, out: Option<&Outputs>) -> Vec<Step> {
    vec![
        Step::new("read", true, format!("{} files to train on, {} to compare on", files[0], files[1])),
        ambient,
        Step::new("subsets", true, "the linear model of each".to_owned()),
        Step::new("quadratic and network models", false, "a fit of each subset would take hours".to_owned()),
        Outputs::table_step(out, "subsets"),
        Outputs::figures_step(out, "without one photodiode, the best of each number"),
    ]
}

fn row(subset: &Subset, inputs: &[String], targets: &[String]) -> PruneRow {
    let errors = subset.errors.as_ref();
    let by = |values: &[f64]| ByTarget::new(targets, values.iter().copied());
    PruneRow {
        inputs: subset.inputs.iter().map(|&k| inputs[k].clone()).collect(),
        rank: subset.rank,
        train_rmse: errors.map(|errors| by(&errors.train_rmse)),
        validate_rmse: errors.map(|errors| by(&errors.validate_rmse)),
        score: errors.and_then(|errors| errors.score),
    }
}
