//! From the rows that are kept of all frames to the traces in which presses are looked for.

use super::results::Kept;
use crate::median::median_of;
use crate::nail::Positions;
use crate::nailvideo::options::Light;
use crate::nailvideo::press::Trace;
use crate::nailvideo::sample::Sampled;

/// Of each photodiode, and what a change of all light is in their unit.
pub(super) fn traces(names: &[String], kept: &[Kept], light: Light) -> (Vec<Trace>, f64) {
    let read = |k: usize, of: &dyn Fn(&Sampled) -> f64| -> Vec<f64> {
        let reading = |row: &Kept| row.readings.get(k).and_then(|one| one.ok());
        kept.iter().map(|row| reading(row).map_or(f64::NAN, |one| of(&one))).collect()
    };
    let values: Vec<Vec<f64>> = (0..names.len()).map(|k| read(k, &|one| one.value)).collect();
    let whole = match light {
        Light::None => middle(values.iter().flatten().copied()).unwrap_or(1.0),
        Light::Red | Light::Skin => 100.0,
    };
    let red = |k: usize| read(k, &|one| whole * f64::from(one.red));
    let trace = |(k, values): (usize, Vec<f64>)| Trace { name: names[k].clone(), values, red: red(k) };
    (values.into_iter().enumerate().map(trace).collect(), whole)
}

/// Means of the photodiodes toward each end of the nail, where all of them have a value.
pub(super) fn ends(positions: &Positions, traces: &[Trace]) -> Vec<Trace> {
    let end = |name: &str, is_there: &dyn Fn(f64) -> bool| {
        let members: Vec<&Trace> =
            positions.photodiodes.iter().zip(traces).filter(|(one, _)| is_there(one.v)).map(|(_, t)| t).collect();
        let mean = |of: fn(&Trace) -> &[f64]| -> Vec<f64> {
            let rows = members.first().map_or(0, |t| of(t).len());
            (0..rows).map(|row| members.iter().map(|t| of(t)[row]).sum::<f64>() / members.len() as f64).collect()
        };
        let trace = || Trace { name: name.to_owned(), values: mean(|t| &t.values), red: mean(|t| &t.red) };
        (members.len() > 1).then(trace)
    };
    [end("distal", &|v| v > 0.0), end("proximal", &|v| v < 0.0)].into_iter().flatten().collect()
}

/// The median of what is known.
pub(super) fn middle(all: impl Iterator<Item = f64>) -> Option<f64> {
    median_of(all.filter(|value| value.is_finite()))
}
