//! One person's part of the comparisons.

use std::path::PathBuf;

use lunula_predictor::{Dataset, FORCES, Kind, Predictor, Recipe, every_subset, score};

use crate::compare::comparison::{Comparison, figure_of};
use crate::compare::options::{CompareOptions, Person};
use lunula::job::Watch;
use lunula::predictor::{POSTURE, PredictorError, Wanted, read_data};
use lunula::stages::Stages;

/// Recordings by their place: two repetitions, the third, the random one.
const SETS: [(&str, &[usize]); 3] = [("set 1", &[0]), ("set 2", &[1]), ("both sets", &[0, 1])];
const BOTH: usize = 2;
const THIRD: usize = 2;
const RANDOM: usize = 3;

/// Fits to a person's rows, with what could not be fitted.
struct Fits<'a> {
    person: &'a str,
    stages: &'a Stages,
    watch: &'a Watch<'a>,
    warnings: Vec<String>,
}

impl Fits<'_> {
    /// A model, or none and a warning.
    fn fit(&mut self, recipe: &Recipe, data: &Dataset) -> Result<Option<Predictor>, PredictorError> {
        self.watch.go_on()?;
        Ok(match self.stages.time("fit", || Predictor::fit(data, None, recipe)) {
            Ok(predictor) => Some(predictor),
            Err(why) => {
                self.warnings.push(format!("{}: no {} model: {why}", self.person, recipe.kind));
                None
            }
        })
    }
}

/// The RMSE of each target on rows.
pub(crate) fn rmse(predictor: Option<&Predictor>, data: &Dataset) -> Result<Vec<Option<f64>>, PredictorError> {
    let Some(predictor) = predictor else { return Ok(vec![None; data.targets().len()]) };
    let (seen, predicted) = predictor.predict(data)?;
    let scores = score(seen.y().view(), predicted.view(), seen.targets());
    Ok(scores.targets.iter().map(|target| Some(target.rmse)).collect())
}

/// All figures of one person, and what should be known.
pub(super) fn measure(
    person: &Person,
    options: &CompareOptions,
    stages: &Stages,
    watch: &Watch<'_>,
) -> Result<(Vec<Comparison>, Vec<String>), PredictorError> {
    let mut fits = Fits { person: &person.name, stages, watch, warnings: Vec::new() };
    let mut found = touch(person, options, &mut fits)?;
    found.insert(found.len() - 1, posture(person, options, &mut fits)?);
    Ok((found, fits.warnings))
}

/// Reads files that are to be one recording each.
fn read(paths: Vec<PathBuf>, targets: &[&str], fits: &mut Fits<'_>) -> Result<Dataset, PredictorError> {
    let wanted = Wanted { targets: targets.iter().map(|&name| name.to_owned()).collect(), ..Wanted::default() };
    let read = fits.stages.time("read", || read_data(&paths, &wanted))?;
    fits.warnings.extend(read.warnings);
    if read.data.recordings().len() != paths.len() {
        let names = paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
        return Err(PredictorError::Request(format!("{names}: each file has to be one recording; split what is more")));
    }
    if read.data.time_s().iter().any(|time_s| time_s.is_nan()) {
        return Err(PredictorError::Request(format!("{}: rows without a time; sets are parted by time", fits.person)));
    }
    Ok(read.data)
}

/// The rows of a time, known from the first and the last time of their recording.
fn only_times(data: &Dataset, keep: impl Fn(f64, [f64; 2]) -> bool) -> Dataset {
    let time_s = data.time_s();
    let kept = data.recordings().iter().flat_map(|one| {
        let ends_s = [time_s[one.rows.start], time_s[one.rows.end - 1]];
        let keep = &keep;
        one.rows.clone().filter(move |&row| keep(time_s[row], ends_s))
    });
    data.only_rows(&kept.collect::<Vec<_>>())
}

/// Fig. 105-111 and 113.
fn touch(person: &Person, options: &CompareOptions, fits: &mut Fits<'_>) -> Result<Vec<Comparison>, PredictorError> {
    let paths: Vec<PathBuf> = person.touch.iter().chain([&person.touch_random]).cloned().collect();
    let data = read(paths, &FORCES, fits)?;
    let sets = SETS.map(|(_, recordings)| data.only(recordings));
    let (both, third, random) = (&sets[BOTH], data.only(&[THIRD]), data.only(&[RANDOM]));
    let set_names = SETS.map(|(name, _)| name.to_owned());
    let (targets, models) = (data.targets(), &options.models);
    let model_names: Vec<String> = models.iter().map(|recipe| recipe.kind.to_string()).collect();

    let mut found = Vec::new();
    // By model, then by target.
    let (mut training, mut validation, mut tested) = (Vec::new(), Vec::new(), Vec::new());
    for recipe in models {
        let fitted = sets.iter().map(|set| fits.fit(recipe, set)).collect::<Result<Vec<_>, _>>()?;
        let by_set = fitted.iter().map(|model| rmse(model.as_ref(), &third)).collect::<Result<Vec<_>, _>>()?;
        let title = format!("validation of the {} touch model by what it was trained on", recipe.kind);
        let of = |target: usize, set: usize| by_set[set][target];
        found.push(Comparison::new(figure_of(recipe.kind), title, "N", [targets, &set_names], of));
        training.push(rmse(fitted[BOTH].as_ref(), both)?);
        validation.push(by_set[BOTH].clone());
        tested.push(rmse(fitted[BOTH].as_ref(), &random)?);
    }
    for (figure, title, by_model) in [
        ("108", "touch models on the rows trained on", &training),
        ("109", "touch models on the third repetition", &validation),
        ("110", "touch models on random touching", &tested),
    ] {
        found.push(Comparison::new(figure, title, "N", [targets, &model_names], |target, model| {
            by_model[model][target]
        }));
    }

    let linear = Recipe::new(Kind::Linear);
    let unbent = |data: &Dataset| only_times(data, |time_s, [first_s, _]| time_s - first_s >= options.bending_s);
    let with = rmse(fits.fit(&linear, both)?.as_ref(), &third)?;
    let without = rmse(fits.fit(&linear, &unbent(both))?.as_ref(), &unbent(&third))?;
    let names = ["with bending", "without bending"].map(str::to_owned);
    let title = "the linear touch model trained and validated with bending and without";
    found.push(Comparison::new("111", title, "N", [targets, &names], |target, set| [&with, &without][set][target]));

    let subsets = fits.stages.time("subsets", || every_subset(both, &third))?;
    let removed = |k: Option<usize>| k.map_or_else(|| "none".to_owned(), |k| data.inputs()[k].clone());
    let groups: Vec<String> = subsets.without_one.iter().map(|one| removed(one.removed)).collect();
    let value = |group: usize, target: usize| {
        let errors = subsets.all[subsets.without_one[group].subset].errors.as_ref()?;
        Some(errors.validate_rmse[target])
    };
    let title = "validation of the linear touch model with a photodiode removed";
    found.push(Comparison::new("113", title, "N", [&groups, targets], value));
    Ok(found)
}

/// Fig. 112.
fn posture(person: &Person, options: &CompareOptions, fits: &mut Fits<'_>) -> Result<Comparison, PredictorError> {
    let data = read(vec![person.bending.clone(), person.bending_random.clone()], &[POSTURE], fits)?;
    let bending = data.only(&[0]);
    let half = |second: bool| only_times(&bending, |time_s, [from_s, to_s]| (time_s > 0.5 * (from_s + to_s)) == second);
    let (first, second, random) = (half(false), half(true), data.only(&[1]));
    let mut by_model = Vec::new();
    for recipe in &options.models {
        let model = fits.fit(recipe, &first)?;
        let by_rows = [&first, &second, &random].map(|data| rmse(model.as_ref(), data));
        by_model.push(by_rows.into_iter().collect::<Result<Vec<_>, _>>()?);
    }
    let groups = ["training", "validation", "random bending"].map(str::to_owned);
    let models: Vec<String> = options.models.iter().map(|recipe| recipe.kind.to_string()).collect();
    let title = "posture models on the first half, the second half and random bending";
    Ok(Comparison::new("112", title, "degrees", [&groups, &models], |rows, model| by_model[model][rows][0]))
}
