//! `lunula train`: recordings to a model file (5.2.4: built from one set of recordings, validated on another).
//!
//! In: recordings to train on; optionally others to report on, which also tell the prediction intervals; optionally
//! others on which a network stops early. Out: the model file and what it reaches. Rows that are reported are never
//! those that training has seen.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use lunula_predictor::{
    Dataset, Intervals, Kind, Predictor, Recipe, Report as FitReport, calibrate, recording_hashes, repeated_paths,
    score, shared, with_lags,
};
use serde::Serialize;

use crate::files::{Places, WriteError};
use crate::job::{Report, Watch};
use crate::predictor::data::{DataFile, FileRows, Read, RowOptions, Wanted, persons, read_files};
use crate::predictor::error::PredictorError;
use crate::predictor::jobs::learning;
use crate::predictor::merit::doubts::{doubts, outside_cone};
use crate::predictor::merit::figures::{ByTarget, Merit, merit_without_cone};
use crate::predictor::merit::table::{MeritRows, merit_table};
use crate::stages::{Stages, Step, left_out};

/// What a model is made from.
#[derive(Debug, Clone, Args)]
pub struct TrainInputs {
    /// Recordings to train on (.csv, .csv.gz where a log, .parquet)
    #[arg(required = true, value_name = "DATA", value_parser = DataFile::parser(), value_hint = ValueHint::AnyPath)]
    pub data: Vec<DataFile>,
    /// Recordings to report on
    #[arg(long, value_name = "DATA", num_args = 1.., value_parser = DataFile::parser())]
    #[arg(value_hint = ValueHint::AnyPath)]
    pub validate: Vec<DataFile>,
    /// Recordings on which the network's training stops early [default: every fifth of 20 blocks of each training
    /// recording]
    #[arg(long, value_name = "DATA", num_args = 1.., value_parser = DataFile::parser())]
    #[arg(value_hint = ValueHint::AnyPath)]
    pub stop_on: Vec<DataFile>,
}

impl TrainInputs {
    fn all(&self) -> impl Iterator<Item = &DataFile> {
        self.data.iter().chain(&self.validate).chain(&self.stop_on)
    }

    /// The step of plans that says whether their ambient light is taken away.
    #[must_use]
    pub fn ambient_step(&self, rows: &RowOptions) -> Step {
        DataFile::ambient_step(self.all(), rows)
    }
}

/// How it is made.
#[derive(Debug, Clone)]
pub struct TrainOptions {
    /// Which columns, and what to do with rows that are not as they should be.
    pub wanted: Wanted,
    /// The model.
    pub recipe: Recipe,
    /// The share of rows that prediction intervals are to hold.
    pub level: f64,
}

/// Where results go.
#[derive(Debug, Clone)]
pub struct TrainOutputs {
    /// The model file.
    pub model: PathBuf,
    /// A table of the error against how much was trained on; a picture of it goes beside.
    pub learning_curve: Option<PathBuf>,
    /// A table of the errors on the rows trained on and reported on.
    pub merit: Option<PathBuf>,
}

/// What the model reaches.
pub type TrainReport = Report<TrainFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct TrainFigures {
    /// The model file.
    pub model: PathBuf,
    /// What it reads.
    pub inputs: Vec<String>,
    /// What it reports.
    pub targets: Vec<String>,
    /// What was fitted.
    pub recipe: Recipe,
    /// The recordings trained on.
    pub data: Vec<FileRows>,
    /// How the fit went.
    pub fit: FitReport,
    /// On the rows trained on: how well the model can follow, not how well it predicts.
    pub training: Merit,
    /// The recordings reported on.
    pub validate: Vec<FileRows>,
    /// On the recordings reported on.
    pub validation: Option<Merit>,
    /// The same without an option that was asked for, on the recordings reported on.
    pub without: Vec<Without>,
    /// Half the width of the prediction intervals, a target each.
    pub half_width: Option<ByTarget<f64>>,
    /// The share of rows that they are to hold.
    pub level: f64,
}

/// What a model reaches without an option.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Without {
    /// Which option.
    pub without: &'static str,
    /// On the recordings reported on.
    pub validation: Merit,
}

/// Trains, reports and writes the model file.
///
/// # Errors
/// [`PredictorError`] where there is no model.
pub fn train(
    inputs: &TrainInputs,
    options: &TrainOptions,
    outputs: &TrainOutputs,
    watch: &Watch<'_>,
) -> Result<TrainReport, PredictorError> {
    let stages = Stages::default();
    if outputs.learning_curve.is_some() && inputs.validate.is_empty() {
        let what = "a learning curve shows errors on recordings that are not trained on; name some with --validate";
        return Err(PredictorError::Request(what.to_owned()));
    }
    let mut places = Places::not_over(inputs.all().map(|file| &file.path));
    let out = &outputs.model;
    places.check(std::iter::once(out).chain(&outputs.learning_curve).chain(&outputs.merit))?;
    let mut read = stages.time("read", || read_files(&inputs.data, &options.wanted))?;
    let mut notes = Vec::new();
    if options.wanted.cells {
        notes.extend(leave_out_unseen(&mut read)?);
    }
    let same_inputs = Wanted { inputs: Some(read.data.inputs().to_vec()), ..options.wanted.clone() };
    let others = |files: &[DataFile]| (!files.is_empty()).then(|| read_files(files, &same_inputs)).transpose();
    let validate = stages.time("read", || others(&inputs.validate))?;
    let stop_on = stages.time("read", || others(&inputs.stop_on))?;
    watch.go_on()?;
    if let Some((held, early)) = validate.as_ref().zip(stop_on.as_ref()) {
        let hashes = recording_hashes(&early.data);
        let both =
            held.data.recordings().iter().zip(recording_hashes(&held.data)).find(|(_, hash)| hashes.contains(hash));
        if let Some((recording, _)) = both {
            return Err(PredictorError::Request(format!(
                "{}: training can't stop on what is reported (--stop-on and --validate), its errors would flatter; \
                 name another",
                recording.name
            )));
        }
    }
    let all = || std::iter::once(&read).chain(&validate).chain(&stop_on);
    notes.extend(all().flat_map(Read::notes));
    let failed: Vec<String> = all().flat_map(|read| read.failed.iter().map(|file| file.why.clone())).collect();
    let recipe = &options.recipe;
    let early = stop_on.as_ref().map(|read| &read.data);
    let predictor = stages.time("fit", || Predictor::fit(&read.data, early, recipe))?;
    // Of the files that were to be trained on: what a model has seen is kept with it.
    let predictor = predictor.without(read.failed.iter().map(|file| file.name.clone()).collect());
    watch.go_on()?;
    let training = stages.time("score", || merit(&predictor, &read.data))?;
    let mut warnings = read.warnings.clone();
    let without_past = read.data.rows() - training.rows - training.not_finite;
    if !recipe.lags_s.is_empty() && without_past > 0 {
        let what = format!(
            "{without_past} of {} rows have no reading of the past that --lags needs, and are not trained on",
            read.data.rows()
        );
        // A begin of a recording is no loss.
        if 10 * without_past > read.data.rows() { warnings.push(what) } else { notes.push(what) }
    }
    warnings.extend(validate.iter().chain(&stop_on).flat_map(|read| read.warnings.clone()));
    warnings.extend(fit_warnings(&predictor.training().report).iter().cloned());
    warnings.extend(predictor.cone().and_then(|cone| outside_cone(cone, read.data.y().view())));
    if let Some(held) = &validate {
        warnings.extend(crate::predictor::seen_in_training(&predictor, &held.data));
        warnings.extend(parts(&read.data, &held.data, "validate on"));
    }
    let is_network = matches!(recipe.kind, Kind::Network { .. });
    if let Some(early) = early.filter(|_| is_network) {
        warnings.extend(parts(&read.data, early, "stop on"));
        let seen = crate::predictor::again(&predictor.training().recordings, early);
        warnings.extend(seen.map(|names| {
            format!("{names}: --stop-on names what is trained on, whose error only falls; name other recordings")
        }));
    }
    let validation =
        validate.as_ref().map(|read| stages.time("score", || merit(&predictor, &read.data))).transpose()?;
    if let Some(held) = validate.as_ref().filter(|_| options.wanted.cells) {
        warnings.extend(repeated(&read.data, &held.data));
    }
    warnings.extend(validation.iter().chain([&training]).filter_map(Merit::warning));
    warnings.extend(training.of_nothing());
    notes.extend(several_persons(&read.data, &inputs.data));
    let without = match &validate {
        Some(held) => stages.time("fit without options", || without(&predictor, &read.data, early, &held.data))?,
        None => Vec::new(),
    };
    watch.go_on()?;
    let predictor = match &validate {
        Some(held) => {
            let found = intervals(&predictor, &held.data, options.level, &mut warnings)?;
            predictor.with_intervals(found, &held.data)
        }
        None => predictor,
    };
    let half_width =
        predictor.intervals().map(|found| ByTarget::new(&predictor.target_names(), found.half_width.iter().copied()));
    let at = places.place(out)?;
    let written = stages.time("write", || std::fs::write(&at, predictor.to_json()));
    written.map_err(|why| WriteError::File { path: out.to_owned(), why: why.to_string() })?;
    let mut pictures = Vec::new();
    if let Some((curve, held)) = outputs.learning_curve.as_ref().zip(validate.as_ref()) {
        let points = stages.time("learning curve", || learning::points(recipe, &read.data, &held.data, early))?;
        pictures.push(stages.time("write", || learning::write(&points, curve, &mut places))?);
    }
    if let Some(path) = &outputs.merit {
        let mut merits = vec![MeritRows::new("training", &training)];
        merits.extend(validation.iter().map(|merit| MeritRows::new("validation", merit)));
        merit_table(&places.place(path)?, path, &merits)?;
    }
    watch.go_on()?;
    places.commit()?;
    let figures = TrainFigures {
        model: out.to_owned(),
        inputs: predictor.input_names(),
        targets: predictor.target_names(),
        recipe: recipe.clone(),
        data: read.files,
        fit: predictor.training().report.clone(),
        training,
        validate: validate.map_or_else(Vec::new, |read| read.files),
        validation,
        without,
        half_width,
        level: options.level,
    };
    let ambient = inputs.ambient_step(&options.wanted.rows);
    let left_out = left_out(train_plan(inputs, ambient, recipe, outputs.learning_curve.is_some()));
    let mut report = Report { left_out, warnings, notes, failed, pictures, ..Report::new("train", watch, figures) };
    if !is_network {
        report.unused(&["hidden", "seed", "restarts", "epochs"], "the model is no network");
        report.unused_input("stop_on", !inputs.stop_on.is_empty(), "the model is no network");
    }
    let is_eigennails = matches!(recipe.kind, Kind::Eigennails { .. });
    if !is_eigennails {
        report.unused(&["modes", "regression"], "the model is not of eigennails");
    }
    if is_network || is_eigennails {
        report.unused(&["deficient"], "only least squares need photodiodes that add something");
    }
    if inputs.validate.is_empty() {
        report.unused(&["level"], "intervals come from the recordings of --validate");
    }
    Ok(report.timed(&stages))
}

/// What to say where one model is of several persons.
fn several_persons(data: &Dataset, files: &[DataFile]) -> Option<String> {
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    let persons = persons(data, &names);
    (persons.len() > 1).then(|| {
        format!(
            "one model of {} persons ({}): each one's own is mostly better; name files of one person, or write each = \
             [\"subject\"] in a pipeline",
            persons.len(),
            persons.into_iter().collect::<Vec<_>>().join(", ")
        )
    })
}

/// Leaves out the cells that a recording never has: those outside of its nail. Returns what to say of it.
fn leave_out_unseen(read: &mut Read) -> Result<Option<String>, PredictorError> {
    let data = &read.data;
    let seen = |cell: &usize| {
        let column = data.x().column(*cell);
        data.recordings().iter().all(|one| one.rows.clone().any(|row| !column[row].is_nan()))
    };
    let all = data.inputs().len();
    let kept: Vec<usize> = (0..all).filter(seen).collect();
    if kept.is_empty() {
        let what = "no cell is known in all recordings; name recordings of nails in one frame, of as many cells";
        return Err(PredictorError::Request(what.to_owned()));
    }
    let note = (kept.len() < all).then(|| {
        format!(
            "{} of {all} cells are used; of the others some recording has no value (outside of the nail)",
            kept.len()
        )
    });
    read.data = read.data.only_inputs(&kept);
    Ok(note)
}

/// Recordings that are to be others than those trained on, and are parts of them; whole ones are named elsewhere.
pub(in crate::predictor) fn parts(train: &Dataset, others: &Dataset, what: &str) -> Vec<String> {
    let say = |(other, of): (usize, usize)| {
        let [other, of] = [&others.recordings()[other].name, &train.recordings()[of].name];
        format!(
            "{other}: its rows are, or lie between, those of {of}, by time and voltages, which is trained on: parts of \
             one recording? Errors and intervals flatter then; {what} another recording"
        )
    };
    if train.inputs() != others.inputs() {
        return Vec::new();
    }
    let (whole, hashes) = (recording_hashes(train), recording_hashes(others));
    let is_part = |&(other, _): &(usize, usize)| !whole.contains(&hashes[other]);
    shared(train, others).into_iter().filter(is_part).map(say).collect()
}

/// Recordings validated on that repeat a path trained on.
fn repeated(train: &Dataset, held: &Dataset) -> Option<String> {
    let all = repeated_paths(train, held);
    let pairs: Vec<String> = all
        .iter()
        .map(|&(test, train_at)| {
            format!("{} that of {}", held.recordings()[test].name, train.recordings()[train_at].name)
        })
        .collect();
    (!pairs.is_empty()).then(|| {
        format!(
            "recordings to validate on follow a path that was trained on ({}): their errors are nearly those of \
             shuffled rows. Validate on another path",
            pairs.join(", ")
        )
    })
}

/// How far off a predictor is on recordings.
pub(in crate::predictor) fn merit(predictor: &Predictor, data: &Dataset) -> Result<Merit, PredictorError> {
    let (seen, predicted) = predictor.predict(data)?;
    Ok(Merit::from(&score(seen.y().view(), predicted.view(), seen.targets())))
}

/// What is reached without each option of the recipe.
fn without(
    predictor: &Predictor,
    data: &Dataset,
    early: Option<&Dataset>,
    held: &Dataset,
) -> Result<Vec<Without>, PredictorError> {
    let recipe = &predictor.training().recipe;
    let mut all = Vec::new();
    if predictor.cone().is_some() {
        let seen = with_lags(held, predictor.lags())?;
        all.push(Without { without: "the cone of friction", validation: merit_without_cone(predictor, &seen) });
    }
    if !recipe.lags_s.is_empty() {
        let plain = Predictor::fit(data, early, &Recipe { lags_s: Vec::new(), ..recipe.clone() })?;
        all.push(Without { without: "lags", validation: merit(&plain, held)? });
    }
    Ok(all)
}

/// Half widths from the errors on recordings that were not trained on; why there are none goes to the warnings.
fn intervals(
    predictor: &Predictor,
    data: &Dataset,
    level: f64,
    warnings: &mut Vec<String>,
) -> Result<Option<Intervals>, PredictorError> {
    let (seen, predicted) = predictor.predict(data)?;
    warnings.extend(
        crate::predictor::jobs::evaluate::not_predicted(predictor, &predicted)
            .unwrap_or_else(|why| Some(why.to_string())),
    );
    warnings.extend(doubts(predictor, data, &seen, &predicted));
    let found = calibrate((&predicted - seen.y()).view(), level);
    Ok(found.map_err(|why| warnings.push(format!("no prediction intervals: {why}"))).ok())
}

fn fit_warnings(report: &FitReport) -> &[String] {
    match report {
        FitReport::LeastSquares(report) => &report.warnings,
        FitReport::Network(report) => &report.warnings,
        FitReport::Eigennails(report) => &report.warnings,
    }
}

/// What would be done and what not, from the request alone; `ambient`: the step of [`TrainInputs::ambient_step`];
/// `curve`: whether a learning curve is asked for.
#[must_use]
pub fn train_plan(inputs: &TrainInputs, ambient: Step, recipe: &Recipe, curve: bool) -> Vec<Step> {
    let network = matches!(recipe.kind, Kind::Network { .. });
    let validated = !inputs.validate.is_empty();
    let stop = match (network, inputs.stop_on.is_empty()) {
        (false, _) if matches!(recipe.kind, Kind::Eigennails { .. }) => "eigennails need none",
        (false, _) => "a least-squares fit needs none",
        (true, true) => "on a fifth of the rows of each recording, which is set aside",
        (true, false) => "on the recordings given",
    };
    let reason = |yes: bool, why: &'static str, why_not: &'static str| (if yes { why } else { why_not }).to_owned();
    let reported = |yes| reason(yes, "on the recordings to validate on", "no recordings to validate on");
    vec![
        Step::new("read", true, format!("{} files", inputs.all().count())),
        ambient,
        Step::new("lags", !recipe.lags_s.is_empty(), reason(!recipe.lags_s.is_empty(), "asked for", "none asked for")),
        Step::new("fit", true, format!("{:?}", recipe.kind)),
        Step::new("early stopping", network, stop.to_owned()),
        Step::new(
            "cone of friction",
            recipe.friction_mu.is_some(),
            reason(recipe.friction_mu.is_some(), "asked for", "no coefficient given"),
        ),
        Step::new("validation", validated, reported(validated)),
        Step::new("prediction intervals", validated, reported(validated)),
        Step::new("learning curve", curve, reason(curve, "asked for", "no --learning-curve")),
    ]
}
