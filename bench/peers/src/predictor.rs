//! The same rows to fit and to predict, and the same problems with an exact solution, by numpy and scikit-learn.

use std::path::Path;

use anyhow::{Context, ensure};
use lunula::tradeoff::predictor::{FIT, MODEL, PREDICT, PROBLEM_ROWS, SOLVER, data, mean_rmse, problems, worst};
use lunula::tradeoff::{Job, Timing};
use ndarray::{Array2, ArrayView2};

use crate::Bench;
use crate::found::Found;
use crate::python::{Answer, Package};

const NAME: &str = "numpy and scikit-learn";
const PACKAGES: [Package; 2] = [("numpy", "numpy"), ("sklearn", "scikit-learn")];

pub(crate) fn measure(bench: &Bench, folder: &Path, found: &mut Found) -> anyhow::Result<()> {
    found.try_program(NAME, |found| {
        let version = bench.python.versions(&PACKAGES)?;
        let ([train, test], _) = data(&bench.plan.predictor(folder)?)?;
        let write = |name: &str, values: ArrayView2<'_, f64>| {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            std::fs::write(folder.join(format!("{name}.f64")), bytes)
        };
        write("train_x", train.x().view())?;
        write("train_y", train.y().view())?;
        write("test_x", test.x().view())?;
        let problems = problems();
        for (k, (_, data)) in problems.iter().enumerate() {
            write(&format!("exact_{k}_x"), data.x().view())?;
            write(&format!("exact_{k}_y"), data.y().view())?;
        }
        let (inputs, targets) = (train.inputs().len(), train.targets().len());
        let counts = [inputs, targets, bench.plan.effort.repeats.max(1)].map(|count| count.to_string());
        let arguments = [".", &counts[0], &counts[1], &counts[2]];
        for answer in bench.python.answers("models.py", folder, &arguments)? {
            let Answer { name, problem, fit_s, row_s, predicted, coefficients, .. } = answer;
            let fit_time = Timing::of(fit_s);
            let mut add = |choice: &str, error: (f64, &str), time, work: usize| {
                found.add((Job::Predictor, choice), &name, error, time, work as u64, &version);
            };
            if let Some(file) = predicted {
                let predicted = Array2::from_shape_vec((test.rows(), targets), numbers(&folder.join(file))?)?;
                let error = mean_rmse(&test, predicted.view());
                add(MODEL.1, (error, FIT), fit_time, train.rows());
                add(MODEL.1, (error, PREDICT), Timing::of(row_s), 1);
                continue;
            }
            let (file, problem) = coefficients.zip(problem).context("an answer without a file")?;
            let mut numbers = numbers(&folder.join(file))?;
            ensure!(numbers.len() == (inputs + 1) * targets, "{name}: {} coefficients", numbers.len());
            let offsets = numbers.split_off(inputs * targets);
            let error = worst(Array2::from_shape_vec((targets, inputs), numbers)?.view(), &offsets);
            let place: usize = problem.parse().with_context(|| format!("the problem `{problem}`"))?;
            let (unit, _) = problems.get(place).with_context(|| format!("the problem {place}"))?;
            add(SOLVER.1, (error, unit), fit_time, PROBLEM_ROWS);
        }
        Ok(())
    });
    Ok(())
}

/// Raw little-endian doubles.
fn numbers(path: &Path) -> anyhow::Result<Vec<f64>> {
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    let (eights, rest) = bytes.as_chunks::<8>();
    ensure!(rest.is_empty(), "{}: is not a table of doubles", path.display());
    Ok(eights.iter().map(|eight| f64::from_le_bytes(*eight)).collect())
}
