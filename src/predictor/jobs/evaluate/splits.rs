//! What a recipe reaches by shuffled rows, and what by whole recordings, paths, sessions and subjects; beside it the
//! mean, the nearest row and, of a model of cells, a linear model of the photodiodes in the same rows.

use lunula_predictor::{
    By, Dataset, Eigennails, Kind, Method, Predict, Predictor, Recipe, compare_splits, flatteries, leaks, paths,
    predict, unit_of, with_lags,
};

use crate::job::Watch;
use crate::predictor::error::PredictorError;
use crate::predictor::jobs::evaluate::report::{Predicted, Splits};
use crate::predictor::merit::figures::ByTarget;

/// Of a normal distribution this many SDs hold 95 %.
const SDS_OF_95: f64 = 1.96;

/// A way to hold out, by a word.
#[must_use]
pub fn way(by: By) -> &'static str {
    match by {
        By::Trajectory => "trajectory",
        By::Path => "path",
        By::Session => "session",
        By::Subject => "subject",
        By::Rows { .. } => "rows",
    }
}

/// Judges the predictor's recipe by each way; `data` may hold photodiodes after the predictor's own inputs.
pub(super) fn splits(
    predictor: &Predictor,
    data: &Dataset,
    ways: &[By],
    watch: &Watch<'_>,
    [warnings, notes]: [&mut Vec<String>; 2],
) -> Result<Splits, PredictorError> {
    let recipe = &predictor.training().recipe;
    let lags = recipe.lags(data)?;
    let seen = with_lags(data, lags.as_ref())?;
    let own: Vec<usize> = (0..predictor.seen_names().len()).collect();
    let photodiodes: Vec<usize> = (own.len()..seen.inputs().len()).collect();
    let fit = |train: &Dataset| -> Result<Predict<'_>, String> {
        watch.go_on().map_err(|why| why.to_string())?;
        let fitted = recipe.fit(&train.only_inputs(&own), None).map_err(|why| why.to_string())?;
        let own = own.clone();
        Ok(Box::new(move |test| predict(&fitted.model, predictor.cone(), test.only_inputs(&own).x().view())))
    };
    let mut methods = vec![Method { name: recipe.kind.to_string(), fit: Box::new(fit) }];
    if !photodiodes.is_empty() {
        methods.push(linear(&photodiodes, &seen));
    }
    let ways = compare_splits(&seen, &own, ways, methods);
    let leaks = leaks(&ways);
    warnings.extend(leaks.iter().map(|leak| {
        let unit = unit_of(&leak.target);
        format!(
            "{}: by shuffled rows {} is off by {:.3} {unit}, but with whole paths held out nothing is surely better \
             than the mean ({:.3} {unit}; {} {:.3} {unit}): rows of one recording on both sides leak, and these inputs \
             say nothing of {}",
            leak.target, leak.method, leak.by_rows, leak.mean, leak.method, leak.by_paths, leak.target
        )
    }));
    let of = |target: &String| {
        let own = flatteries(&ways).into_iter().filter(|(name, _, _)| name == target);
        let each: Vec<String> = own.map(|(_, method, ratio)| format!("{method} {ratio:.2}")).collect();
        (!each.is_empty()).then(|| format!("{target}: shuffled rows flatter, times: {}", each.join(", ")))
    };
    notes.extend(seen.targets().iter().filter_map(of));
    Ok(Splits { ways, leaks })
}

/// A linear model of photodiodes; rows that lack one are not known to it.
fn linear<'a>(photodiodes: &[usize], data: &Dataset) -> Method<'a> {
    let names: Vec<&str> = photodiodes.iter().map(|&k| data.inputs()[k].as_str()).collect();
    let ends = [names[0], names[names.len() - 1]].join("-");
    let columns = photodiodes.to_vec();
    let fit = move |train: &Dataset| -> Result<Predict<'a>, String> {
        let train = train.only_inputs(&columns);
        let rows = train.x().rows().into_iter().enumerate();
        let whole: Vec<usize> =
            rows.filter(|(_, row)| row.iter().all(|value| value.is_finite())).map(|(k, _)| k).collect();
        let fitted = Recipe::new(Kind::Linear).fit(&train.only_rows(&whole), None).map_err(|why| why.to_string())?;
        let columns = columns.clone();
        Ok(Box::new(move |test| predict(&fitted.model, None, test.only_inputs(&columns).x().view())))
    };
    Method { name: format!("{ends} linear"), fit: Box::new(fit) }
}

/// What to say of recordings that follow one path.
pub(super) fn same_path(data: &Dataset) -> Option<String> {
    let first = paths(data);
    let name = |k: usize| data.recordings()[k].name.as_str();
    let repeated: Vec<String> = (0..first.len())
        .filter(|&k| first[k] != k)
        .map(|k| format!("{} that of {}", name(k), name(first[k])))
        .collect();
    (!repeated.is_empty()).then(|| {
        format!(
            "recordings follow one prompted path ({}): held out against each other they leak nearly as much as \
             shuffled rows; --by path holds them out together",
            repeated.join(", ")
        )
    })
}

/// The share of rows within 1.96 of the model's own SDs; none of no rows.
pub(super) fn within_own(model: &Eigennails, shown: &Predicted) -> ByTarget<Option<f64>> {
    let sds = model.sd(shown.data.x().view());
    let errors = &shown.values - shown.data.y();
    let share = |target: usize| {
        let pairs = errors.column(target).into_iter().zip(sds.column(target));
        let known: Vec<bool> =
            pairs.filter(|(e, sd)| e.is_finite() && sd.is_finite()).map(|(e, sd)| e.abs() <= SDS_OF_95 * sd).collect();
        let within = known.iter().filter(|within| **within).count();
        (!known.is_empty()).then(|| within as f64 / known.len() as f64)
    };
    ByTarget::new(shown.data.targets(), (0..shown.data.targets().len()).map(share))
}
