//! `lunula evaluate`: how far off a model is on recordings, and how far off its recipe is on recordings that are held
//! out (5.3, 5.4).
//!
//! In: a model file and recordings. Out: errors by target, recording and magnitude; where the model has prediction
//! intervals, how many rows they hold. With a part to be held out ([`By`]), the recipe is fitted again without each
//! trajectory, session or subject in turn. Shuffled rows only when asked for, and then beside whole trajectories, with
//! how much they flatter.

mod report;
mod results;
mod splits;

use std::path::Path;

use lunula_predictor::{
    By, ByMagnitude, Dataset, Kind, Predictor, Recipe, by_magnitude, coverage, cross_coverage, cross_validate,
    magnitude_edges, nested_coverage, predict, score, with_lags,
};
use ndarray::{Array2, Axis};

use crate::job::{Outputs, Report, Watch};
use crate::predictor::data::{DataFile, RowOptions, Wanted, read_files};
use crate::predictor::error::PredictorError;
use crate::predictor::merit::doubts::{doubts, outside_cone};
use crate::predictor::merit::figures::{BinMerit, ByTarget, Merit, merit_without_cone};
use crate::predictor::options::choices::LEVEL;
use crate::predictor::outputs::end;
use crate::predictor::{open_models, seen_by_intervals, seen_in_training};
use crate::stages::{Stages, Step, left_out};
use report::Predicted;
pub use report::{EvaluateFigures, EvaluateReport, HeldOut, Magnitudes, Part, RecordingMerit, Splits};
pub use splits::way;

/// Up to this many parts, each part's coverage is of intervals that have not seen it; it takes fits as many as parts,
/// squared.
const MOST_NESTED: usize = 30;

/// About how many bins of force or angle errors are binned into.
const BINS: usize = 6;

/// How to evaluate.
#[derive(Debug, Clone)]
pub struct EvaluateOptions {
    /// Which rows count.
    pub rows: RowOptions,
    /// What is held out in turn; none: only the model itself is evaluated.
    pub by: Option<By>,
    /// Ways to hold out that are set beside each other.
    pub splits: Option<[By; 5]>,
    /// The share of rows that intervals of held-out parts are to hold.
    pub level: f64,
    /// What pictures call the model; none: its file, as its path is written.
    pub title: Option<String>,
}

impl Default for EvaluateOptions {
    fn default() -> Self {
        Self { rows: RowOptions::default(), by: None, splits: None, level: LEVEL, title: None }
    }
}

/// Evaluates a model; writes tables and pictures where `out` names a folder.
///
/// # Errors
/// [`PredictorError`] where there is nothing to tell.
pub fn evaluate(
    model: &Path,
    data: &[DataFile],
    options: &EvaluateOptions,
    out: Option<&Outputs>,
    watch: &Watch<'_>,
) -> Result<EvaluateReport, PredictorError> {
    let stages = Stages::default();
    let (predictor, mut warnings) = open_models(&[model.to_owned()])?.one();
    let wanted = Wanted {
        inputs: Some(predictor.input_names()),
        targets: predictor.target_names(),
        rows: options.rows.clone(),
        cells: predictor.reads_hidden(),
        photodiodes_too: predictor.reads_hidden() && options.splits.is_some(),
        ..Wanted::default()
    };
    let mut read = stages.time("read", || read_files(data, &wanted))?;
    watch.go_on()?;
    // Photodiodes beside the model's own inputs are for the splits alone.
    let with_photodiodes = read.data.clone();
    let own: Vec<usize> = (0..predictor.inputs().len()).collect();
    read.data = read.data.only_inputs(&own);
    warnings.extend(read.warnings.iter().cloned());
    let flattered = seen_in_training(&predictor, &read.data);
    let (seen, values) = stages.time("predict", || predictor.predict(&read.data))?;
    warnings.extend(not_predicted(&predictor, &values)?);
    warnings.extend(doubts(&predictor, &read.data, &seen, &values));
    warnings.extend(predictor.cone().and_then(|cone| outside_cone(cone, seen.y().view())));
    let half_width = predictor.intervals().map(|intervals| (intervals.half_width.clone(), intervals.level));
    let title = options.title.clone().unwrap_or_else(|| model.display().to_string());
    let shown = Predicted { title, data: seen.into_owned(), values, half_width };
    let merit = merit_of(&shown, None);
    warnings.extend(merit.warning());
    let held_out = options.by.map(|by| {
        stages.time("hold out", || hold_out(&predictor, &read.data, by, options.level, watch, &mut warnings))
    });
    // Once stopped, what could not be held out is no fault of the request.
    watch.go_on()?;
    let held_out = held_out.transpose()?;
    let mut notes: Vec<String> = read.notes().chain(seen_by_intervals(&predictor, &read.data)).collect();
    // To hold parts out, all recordings are named.
    if options.by.is_some() && !flattered.is_empty() {
        notes
            .push("the model's own errors are of what it was trained on, and flatter; those held out don't".to_owned());
    } else {
        warnings.extend(flattered);
    }
    let splits = match options.splits {
        None => None,
        Some(ways) => Some(stages.time("splits", || {
            splits::splits(&predictor, &with_photodiodes, &ways, watch, [&mut warnings, &mut notes])
        })?),
    };
    watch.go_on()?;
    if predictor.reads_hidden() && (options.by.is_some_and(|by| by != By::Path) || splits.is_some()) {
        warnings.extend(splits::same_path(&read.data));
    }
    let intervals = predictor.intervals();
    let figures = EvaluateFigures {
        model: model.to_owned(),
        data: read.files,
        recordings: recordings(&shown),
        by_magnitude: magnitudes(&shown),
        coverage: intervals.map(|intervals| {
            let found = coverage((&shown.values - shown.data.y()).view(), intervals, "all");
            ByTarget::new(shown.data.targets(), found.reached)
        }),
        within_own: predictor.eigennails().map(|model| splits::within_own(model, &shown)),
        without_friction: predictor.cone().map(|_| merit_without_cone(&predictor, &shown.data)),
        merit,
        held_out,
        splits,
    };
    let ambient = DataFile::ambient_step(data, &options.rows);
    let left_out = left_out(evaluate_plan(data.len(), ambient, options, Some(intervals.is_some()), out));
    let mut report = Report { left_out, warnings, notes, ..Report::new("evaluate", watch, figures) };
    if options.by.is_none() && options.splits.is_none() {
        report.unused(&["folds", "seed", "level"], "nothing is held out without --by or --splits");
    }
    let eigennails = predictor.eigennails();
    end(report, out, |report, out| results::write(report, &shown, eigennails, out, &stages), &stages)
}

/// What to say of predictions that are no finite numbers, which no figure of merit counts.
///
/// # Errors
/// All are.
pub(in crate::predictor) fn not_predicted(
    predictor: &Predictor,
    values: &Array2<f64>,
) -> Result<Option<String>, PredictorError> {
    let (lost, rows) =
        (values.outer_iter().filter(|row| row.iter().any(|value| !value.is_finite())).count(), values.nrows());
    let (what, help) = if predictor.reads_hidden() {
        (
            format!("the model gives nothing for {lost} of {rows} rows: most of the nail is hidden in them"),
            "it needs half of the cells",
        )
    } else {
        (
            format!("what the model gives for {lost} of {rows} rows is beyond 1e308"),
            "these voltages are not in the unit of those it was trained on",
        )
    };
    match lost {
        0 => Ok(None),
        lost if lost == rows => Err(PredictorError::Request(format!("{what}: there is no error to tell; {help}"))),
        _ if predictor.reads_hidden() => Ok(Some(format!("{what}; they are not counted"))),
        _ => Ok(Some(format!("{what}; they are not counted. Perhaps {help}"))),
    }
}

/// Errors of all rows, or of some.
fn merit_of(shown: &Predicted, rows: Option<std::ops::Range<usize>>) -> Merit {
    let rows = rows.unwrap_or(0..shown.data.rows());
    let part = |values: &Array2<f64>| values.select(Axis(0), &rows.clone().collect::<Vec<_>>());
    Merit::from(&score(part(shown.data.y()).view(), part(&shown.values).view(), shown.data.targets()))
}

fn recordings(shown: &Predicted) -> Vec<RecordingMerit> {
    let one = |recording: &lunula_predictor::Recording| RecordingMerit {
        recording: recording.name.clone(),
        session: recording.session.clone(),
        subject: recording.subject.clone(),
        merit: merit_of(shown, Some(recording.rows.clone())),
    };
    shown.data.recordings().iter().map(one).collect()
}

/// Errors by size; none where the targets have no size, or only one.
fn magnitudes(shown: &Predicted) -> Option<Magnitudes> {
    let (measured, names) = (shown.data.y().view(), shown.data.targets());
    let edges = magnitude_edges(measured, names, BINS).ok()??;
    let ByMagnitude { of, bins, .. } = by_magnitude(measured, shown.values.view(), names, &edges).ok()?;
    let bins = bins.iter().map(|bin| BinMerit { from: bin.from, to: bin.to, merit: Merit::from(&bin.scores) });
    Some(Magnitudes { of, bins: bins.collect() })
}

/// Fits the model's recipe again without each part.
fn hold_out(
    predictor: &Predictor,
    data: &Dataset,
    by: By,
    level: f64,
    watch: &Watch<'_>,
    warnings: &mut Vec<String>,
) -> Result<HeldOut, PredictorError> {
    let recipe: &Recipe = &predictor.training().recipe;
    let lags = recipe.lags(data)?;
    let seen = with_lags(data, lags.as_ref())?;
    let fit = |data: &Dataset| {
        watch.go_on().map_err(|why| why.to_string())?;
        recipe.fit(data, None).map(|fitted| fitted.model).map_err(|why| why.to_string())
    };
    let tell = |model: &lunula_predictor::Model, data: &Dataset| predict(model, predictor.cone(), data.x().view());
    let found = cross_validate(&seen, by, fit, tell)?;
    let groups: Vec<(String, Vec<usize>)> =
        found.folds.iter().map(|fold| fold.name.clone()).zip(found.rows.iter().cloned()).collect();
    let shuffled = matches!(by, By::Rows { .. });
    let shared: usize = found.folds.iter().map(|fold| fold.shared_rows).sum();
    if shared > 0 && !shuffled {
        let rows = seen.rows();
        warnings.push(format!(
            "{shared} of {rows} rows stand in other parts as well, digit by digit: where a recording was given twice, \
             holding it out hides nothing, and the errors flatter"
        ));
    }
    if let Some(why) = found.flattery.as_ref().and_then(|flattery| flattery.fault.as_ref()) {
        warnings.push(format!("how much shuffled rows flatter is not known: {why}"));
    }
    // Fits as many times as there are parts, squared: for networks or many parts that is hours.
    let covered = if !shuffled && (matches!(recipe.kind, Kind::Network { .. }) || groups.len() > MOST_NESTED) {
        warnings.push(
            "the coverage with parts held out is of intervals from models that have seen the part: it may flatter"
                .to_owned(),
        );
        cross_coverage(found.residuals(&seen).view(), &groups, level)
    } else {
        nested_coverage(&seen, by, level, fit, tell)
    };
    let (coverage, no_coverage) = match covered {
        Ok(covered) => (Some(covered), None),
        Err(why) => (None, Some(why.to_string())),
    };
    let part = |fold: &lunula_predictor::FoldResult| Part {
        name: fold.name.clone(),
        merit: fold.scores.as_ref().map(Merit::from),
        fault: fold.fault.clone(),
    };
    Ok(HeldOut {
        by,
        pooled: Merit::from(&found.pooled),
        parts: found.folds.iter().map(part).collect(),
        flattery: found.flattery.as_ref().map(|f| ByTarget::new(data.targets(), f.ratio.iter().copied())),
        by_trajectory: found.flattery.and_then(|f| f.by_trajectory).as_ref().map(Merit::from),
        coverage,
        no_coverage,
    })
}

/// What would be done and what not; `files`: recordings; `ambient`: their step of [`DataFile::ambient_step`];
/// `intervals`: whether the model has prediction intervals, none where it is not known yet.
#[must_use]
pub fn evaluate_plan(
    files: usize,
    ambient: Step,
    options: &EvaluateOptions,
    intervals: Option<bool>,
    out: Option<&Outputs>,
) -> Vec<Step> {
    let covered = match intervals {
        Some(false) => "the model has none (train it with --validate)",
        Some(true) => "on all rows",
        None => "where the model has them",
    };
    let held_out = match options.by {
        None => "no --by".to_owned(),
        Some(By::Trajectory) => "a trajectory at a time".to_owned(),
        Some(By::Path) => "a path at a time".to_owned(),
        Some(By::Session) => "a session at a time".to_owned(),
        Some(By::Subject) => "a subject at a time".to_owned(),
        Some(By::Rows { folds, .. }) => format!("{folds} parts of shuffled rows"),
    };
    let rows = out.is_some_and(|out| out.rows);
    let why = match out {
        None => "no --out",
        Some(_) if rows => "a row each",
        Some(_) => "not asked for",
    };
    vec![
        Step::new("read", true, format!("{files} files")),
        ambient,
        Step::new("errors", true, "on all rows, by recording and by size".to_owned()),
        Step::new("coverage of prediction intervals", intervals != Some(false), covered.to_owned()),
        Step::new("fits with parts held out", options.by.is_some(), held_out),
        Step::new(
            "splits",
            options.splits.is_some(),
            if options.splits.is_some() { "by rows, trajectory, path, session, subject" } else { "no --splits" }
                .to_owned(),
        ),
        Outputs::table_step(out, "errors"),
        Step::new("predicted rows", rows, why.to_owned()),
        Outputs::figures_step(out, "predicted and measured over time, as scatter, errors by size"),
    ]
}
