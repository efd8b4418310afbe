//! The same models and problems by numpy and scikit-learn.

use std::path::Path;

use anyhow::{Context, ensure};
use lunula_predictor::Dataset;
use ndarray::{Array2, ArrayView2};

use super::{FIT, MODEL, PROBLEM_ROWS, SOLVER, Settings, TELL, mean_rmse, problem, worst};
use crate::tradeoff::measure::rows::{Measured, Row};
use crate::tradeoff::measure::timing::Timing;
use crate::tradeoff::peers::{Answer, PeerReport, Script};

const NAME: &str = "numpy and scikit-learn";
const PACKAGES: [(&str, &str); 2] = [("numpy", "numpy"), ("sklearn", "scikit-learn")];
const SCRIPT: Script = Script { files: &[("models.py", include_str!("../../../benches/peers/models.py"))] };

/// Measures them, where they are to be measured and there.
pub(super) fn measure(
    train: &Dataset,
    test: &Dataset,
    problems: &[(i32, Dataset)],
    settings: &Settings,
    measured: &mut Measured,
) -> anyhow::Result<()> {
    if let Err(missing) = settings.python.has(NAME, &PACKAGES) {
        measured.peers.push(missing);
        return Ok(());
    }
    let rows = || -> anyhow::Result<Vec<Row>> {
        let folder = tempfile::tempdir()?;
        let write = |name: &str, values: ArrayView2<'_, f64>| {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            std::fs::write(folder.path().join(format!("{name}.f64")), bytes)
        };
        write("train_x", train.x().view())?;
        write("train_y", train.y().view())?;
        write("test_x", test.x().view())?;
        for (bits, data) in problems {
            write(&format!("exact_{bits}_x"), data.x().view())?;
            write(&format!("exact_{bits}_y"), data.y().view())?;
        }
        let (inputs, targets) = (train.inputs().len(), train.targets().len());
        let counts = [inputs, targets, settings.effort.repeats.max(1)].map(|count| count.to_string());
        let arguments = [".", &counts[0], &counts[1], &counts[2]];
        let answers = settings.python.answers(SCRIPT, folder.path(), &arguments, &settings.effort)?;
        let mut rows = Vec::new();
        for answer in answers {
            rows.extend(rows_of(answer, folder.path(), (inputs, targets), train, test)?);
        }
        Ok(rows)
    };
    let outcome = rows();
    settings.effort.check()?;
    measured.peers.push(match outcome {
        Ok(rows) => {
            measured.rows.extend(rows.into_iter().map(Row::peer));
            PeerReport::measured(NAME, "the same rows to fit and to predict, the same problems with an exact solution")
        }
        Err(why) => PeerReport::missing(NAME, format!("{why:#}")),
    });
    Ok(())
}

/// The rows of one answer; errors are computed here.
fn rows_of(
    answer: Answer,
    folder: &Path,
    size: (usize, usize),
    train: &Dataset,
    test: &Dataset,
) -> anyhow::Result<Vec<Row>> {
    let (inputs, targets) = size;
    let Answer { name, problem: of, fit_s, row_s, predicted, coefficients, .. } = answer;
    let fit_time = Timing::of(fit_s);
    if let Some(file) = predicted {
        let predicted = Array2::from_shape_vec((test.rows(), targets), numbers(&folder.join(file))?)?;
        let error = mean_rmse(test, predicted.view());
        let fit = Row::own(MODEL, &name, (error, FIT), fit_time, train.rows() as u64);
        return Ok(vec![fit, Row::own(MODEL, &name, (error, TELL), Timing::of(row_s), 1)]);
    }
    let (file, of) = coefficients.zip(of).context("an answer without a file")?;
    let mut numbers = numbers(&folder.join(file))?;
    ensure!(numbers.len() == (inputs + 1) * targets, "{name}: {} coefficients", numbers.len());
    let offsets = numbers.split_off(inputs * targets);
    let error = worst(Array2::from_shape_vec((targets, inputs), numbers)?.view(), &offsets);
    let unit = problem(of.parse().with_context(|| format!("the problem `{of}`"))?);
    Ok(vec![Row::own(SOLVER, &name, (error, &unit), fit_time, PROBLEM_ROWS as u64)])
}

/// Raw little-endian doubles.
fn numbers(path: &Path) -> anyhow::Result<Vec<f64>> {
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    let (eights, rest) = bytes.as_chunks::<8>();
    ensure!(rest.is_empty(), "{}: is no table of doubles", path.display());
    Ok(eights.iter().map(|eight| f64::from_le_bytes(*eight)).collect())
}
