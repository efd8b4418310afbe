//! Numbers of the predictors: of one subject's evaluations and modes (Fig. 94 to 104), of the comparison over subjects
//! (Fig. 105 to 113); and of trials (Fig. 123, 124).
//!
//! In: the tables `merit.csv`, `predicted.csv`, `modes.csv`, `comparisons.csv` that evaluate, analyse and compare
//! write, and performance's `performance.json`. Out: [`Numbers`]; what a table lacks is not reported.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use serde_json::Value;

use super::Numbers;
use super::responses::is_photodiode;
use lunula::table::{Table, TableError};

fn texts(table: &Table, name: &str) -> Result<Vec<String>, TableError> {
    Ok(table.texts(name)?.into_iter().map(Option::unwrap_or_default).collect())
}

/// Of an evaluation's folder: by target `rmse`, `r2`; from its predictions `rmse_over_sd` and `rmse_bending`, that of
/// rows without any force.
pub(crate) fn evaluation_numbers(folder: &Path) -> Result<Numbers, TableError> {
    let mut numbers = Numbers::default();
    let merit = folder.join("merit.csv");
    if merit.is_file() {
        let table = Table::read(&merit)?;
        let (of, target) = (texts(&table, "of")?, texts(&table, "target")?);
        for name in ["rmse", "r2", "bias"] {
            let values = table.numbers_or_nan(name)?;
            for row in (0..table.rows()).filter(|&row| of[row] == "all") {
                numbers.set(format!("{}.{name}", target[row]), values[row]);
            }
        }
    }
    let predicted = folder.join("predicted.csv");
    if predicted.is_file() {
        let table = Table::read(&predicted)?;
        let targets: Vec<&String> = table
            .names()
            .iter()
            .filter(|name| table.names().iter().any(|other| *other == format!("{name}_predicted")))
            .collect();
        let measured = targets.iter().map(|name| table.values(name)).collect::<Result<Vec<_>, _>>()?;
        let untouched: Vec<bool> =
            (0..table.rows()).map(|row| measured.iter().all(|values| values[row].abs() < REST_N)).collect();
        for (target, own) in targets.iter().zip(&measured) {
            let found = table.values(&format!("{target}_predicted"))?;
            let errors = |keep: &dyn Fn(usize) -> bool| {
                let rows = (0..own.len()).filter(|&row| keep(row) && own[row].is_finite() && found[row].is_finite());
                let squares: Vec<f64> = rows.map(|row| (own[row] - found[row]).powi(2)).collect();
                (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
            };
            let known: Vec<f64> = own.iter().copied().filter(|value| value.is_finite()).collect();
            let mean = known.iter().sum::<f64>() / known.len() as f64;
            let sd = (known.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / known.len() as f64).sqrt();
            numbers.set(format!("{target}.rmse_over_sd"), errors(&|_| true).map(|rmse| rmse / sd));
            if target.ends_with("_N") {
                numbers.set(format!("{target}.rmse_bending"), errors(&|row| untouched[row]));
            }
        }
    }
    Ok(numbers)
}

/// Forces below this are none: a transducer's noise, newtons.
const REST_N: f64 = 0.05;

/// Of an analysis' folder: `least_over_greatest` of the singular values, `least_dominance`, the least share that a
/// mode's greatest force has of the mode, `different_forces`, how many forces dominate one, `greatest_photodiode`, the
/// greatest share that one photodiode has of a mode.
pub(crate) fn modes_numbers(folder: &Path) -> Result<Numbers, TableError> {
    let mut numbers = Numbers::default();
    let path = folder.join("modes.csv");
    if !path.is_file() {
        return Ok(numbers);
    }
    let table = Table::read(&path)?;
    let column = |name: &str| -> Result<Vec<f64>, TableError> {
        Ok(table.numbers(name)?.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
    };
    let values = column("singular_value")?;
    let ends = values.iter().fold([f64::INFINITY, 0.0_f64], |[low, high], &value| [low.min(value), high.max(value)]);
    numbers.set("least_over_greatest", ends[0] / ends[1]);
    let greatest = |of: &dyn Fn(&str) -> bool| -> Result<Vec<Option<(usize, f64)>>, TableError> {
        let names: Vec<&String> = table.names().iter().filter(|name| of(name)).collect();
        let columns = names.iter().map(|name| column(name)).collect::<Result<Vec<_>, _>>()?;
        let row = |row: usize| {
            let squares: Vec<f64> = columns.iter().map(|column| column[row] * column[row]).collect();
            let sum: f64 = squares.iter().sum();
            let most = (0..squares.len()).max_by(|&a, &b| squares[a].total_cmp(&squares[b]))?;
            Some((most, squares[most] / sum))
        };
        Ok((0..table.rows()).map(row).collect())
    };
    let forces: Vec<(usize, f64)> = greatest(&|name| name.ends_with("_N"))?.into_iter().flatten().collect();
    numbers.set("least_dominance", forces.iter().map(|(_, share)| *share).reduce(f64::min));
    let which: std::collections::BTreeSet<usize> = forces.iter().map(|(which, _)| *which).collect();
    numbers.set("different_forces", (!which.is_empty()).then_some(which.len() as f64));
    let shares = greatest(&is_photodiode)?.into_iter().flatten().map(|(_, share)| share);
    numbers.set("greatest_photodiode", shares.reduce(f64::max));
    Ok(numbers)
}

/// Of a comparison's folder: `<figure>.<group>.<series>`, RMSE, mean over people, networks called `network`; and what
/// 5.4 and 5.5 say of them together.
pub(crate) fn compare_numbers(folder: &Path) -> Result<Numbers, TableError> {
    let mut numbers = Numbers::default();
    let path = folder.join("comparisons.csv");
    if !path.is_file() {
        return Ok(numbers);
    }
    let table = Table::read(&path)?;
    let [figure, group, series] = ["figure", "group", "series"].map(|name| texts(&table, name));
    let (figure, group, series) = (figure?, group?, series?);
    let (mean, people) = (table.numbers_or_nan("rmse_mean")?, table.numbers("people")?);
    let mut pruned: BTreeMap<&str, BTreeMap<&str, f64>> = BTreeMap::new();
    for row in 0..table.rows() {
        let own = if series[row].starts_with("network") { "network" } else { &series[row] };
        let Some(value) = mean[row].filter(|value| value.is_finite()) else { continue };
        numbers.set(format!("{}.{}.{own}", figure[row], group[row]), value);
        if figure[row] == "113" {
            pruned.entry(&group[row]).or_default().insert(own, value);
        }
    }
    numbers.set("people", people.into_iter().flatten().reduce(f64::max));
    for target in ["Fx_N", "Fy_N", "Fz_N"] {
        let get = |figure: u32, series: &str| numbers.get(&format!("{figure}.{target}.{series}"));
        let over = |a: Option<f64>, b: Option<f64>| Some(a? / b?);
        let random = over(get(110, "linear"), get(109, "linear"));
        let quadratic = over(get(109, "quadratic"), get(109, "linear"));
        numbers.set(format!("110.{target}.linear over 109"), random);
        numbers.set(format!("109.{target}.quadratic over linear"), quadratic);
    }
    if let Some(whole) = pruned.remove("none") {
        let mut greatest: BTreeMap<&str, f64> = BTreeMap::new();
        for (removed, own) in &pruned {
            let losses = own.iter().filter_map(|(target, value)| Some((*target, value / whole.get(target)? - 1.0)));
            let losses: Vec<(&str, f64)> = losses.collect();
            numbers.set(format!("113.{removed}.greatest_loss"), losses.iter().map(|(_, loss)| *loss).reduce(f64::max));
            for (target, loss) in losses {
                numbers.set(format!("113.{removed}.{target}_loss"), loss);
                let most = greatest.entry(target).or_insert(loss);
                *most = most.max(loss);
            }
        }
        numbers.set("113.greatest_loss", greatest.values().copied().reduce(f64::max));
        for (target, loss) in greatest {
            numbers.set(format!("113.greatest_loss_{target}"), loss);
        }
    }
    Ok(numbers)
}

/// Of a performance's folder: `operators`; `first_over`, the time per decision of the first trial over the baseline's;
/// `level_over`, the trials to level off over the baseline's; `mean_over`, over all trials; of the first method that is
/// compared.
pub(crate) fn performance_numbers(folder: &Path) -> anyhow::Result<Numbers> {
    let mut numbers = Numbers::default();
    let path = folder.join("performance.json");
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let found: Value = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
    let compared = &found["comparisons"][0];
    numbers.set("operators", found["operators"].as_array().map(|all| all.len() as f64));
    numbers.set("first_over", compared["initially"]["ratio"].as_f64());
    numbers.set("level_over", compared["to_level_off"]["ratio"].as_f64());
    numbers.set("mean_over", compared["overall"]["ratio_of_means"].as_f64());
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        folder
    }

    #[test]
    fn an_evaluation_is_reported_by_target() {
        let merit = "of,name,session,subject,target,rows,rmse,bias,r2,mae,within\n\
                     all,,,,Fz_N,4,0.5,0,0.9,0.4,\nrecording,a,1,1,Fz_N,4,0.7,0,0.9,0.4,\n";
        let predicted = "time_s,Fz_N,Fz_N_predicted,recording\n0,0,0.2,a\n1,0,-0.2,a\n2,-2,-2,a\n3,,1,a\n";
        let folder = folder(&[("merit.csv", merit), ("predicted.csv", predicted)]);
        let found = evaluation_numbers(folder.path()).unwrap();
        assert_eq!(found.get("Fz_N.rmse"), Some(0.5));
        assert!((found.get("Fz_N.rmse_bending").unwrap() - 0.2).abs() < 1e-12, "{found:?}");
        let sd = (8.0_f64 / 9.0).sqrt();
        assert!((found.get("Fz_N.rmse_over_sd").unwrap() - (0.08_f64 / 3.0).sqrt() / sd).abs() < 1e-12);
        assert_eq!(evaluation_numbers(Path::new("nowhere")).unwrap(), Numbers::default());
    }

    #[test]
    fn modes_tell_who_dominates() {
        let text = "mode,singular_value,Fx_N,Fy_N,Fz_N,P1,P2\n1,10,1,0,0,0.6,0.8\n2,5,0,0.8,0.6,0.8,-0.6\n";
        let found = modes_numbers(folder(&[("modes.csv", text)]).path()).unwrap();
        assert_eq!((found.get("least_over_greatest"), found.get("different_forces")), (Some(0.5), Some(2.0)));
        assert!((found.get("least_dominance").unwrap() - 0.64).abs() < 1e-12);
        assert!((found.get("greatest_photodiode").unwrap() - 0.64).abs() < 1e-12);
    }

    #[test]
    fn a_comparison_gives_the_cost_of_a_removed_photodiode() {
        let text = "figure,group,series,unit,rmse_mean,rmse_sd,people\n\
                    109,Fz_N,linear,N,0.4,0.1,7\n110,Fz_N,linear,N,0.8,0.1,7\n\
                    109,Fz_N,network of 8,N,0.5,0.1,7\n\
                    113,none,Fz_N,N,0.4,,7\n113,P1,Fz_N,N,0.5,,7\n113,P2,Fz_N,N,0.4,,6\n";
        let found = compare_numbers(folder(&[("comparisons.csv", text)]).path()).unwrap();
        assert_eq!((found.get("109.Fz_N.network"), found.get("110.Fz_N.linear over 109")), (Some(0.5), Some(2.0)));
        assert!((found.get("113.P1.Fz_N_loss").unwrap() - 0.25).abs() < 1e-12);
        assert!((found.get("113.greatest_loss").unwrap() - 0.25).abs() < 1e-12);
        assert_eq!((found.get("people"), found.get("113.P2.greatest_loss")), (Some(7.0), Some(0.0)));
    }
}
