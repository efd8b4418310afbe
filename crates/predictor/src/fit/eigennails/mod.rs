//! A [`Dataset`] of cells to [`Eigennails`]: modes by singular values, ridge or a Gaussian process on their scores.
//!
//! Rows that lack a cell are counted and not trained on; those to be predicted may lack some. Modes, shrinkage and the
//! SDs are chosen on rows left out: whole paths where there are several ([`paths`]), else recordings, else five blocks
//! of time, and the report says which. The modes themselves are those of all rows, as they need no targets.

mod directions;
mod process;
mod ridge;
#[cfg(test)]
mod tests;

use ndarray::{Array2, Axis};
use serde::{Deserialize, Serialize};

use super::FitFault;
use super::report::unchanging;
use crate::data::path::paths;
use crate::model::{Basis, Covariance, Eigennails, Regression, Ridge};
use crate::{Dataset, FORCES};
pub use directions::Directions;
use ridge::{Choice, choose};

/// The most modes that are found where none are asked for.
const MOST_MODES: usize = 32;
/// Rows with all cells that a fit needs: two for each of five blocks left out; assumed.
const LEAST_ROWS: usize = 10;
/// Blocks of time that a single recording is cut into.
const BLOCKS: usize = 5;

/// What is fitted to the scores.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OnScores {
    /// Linear, shrunk.
    Ridge,
    /// A Gaussian process.
    Process,
}

/// How a fit of eigennails went.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EigennailsReport {
    /// Rows trained on: those with all cells.
    pub rows: usize,
    /// Rows left out, as they lack a cell.
    pub hidden: usize,
    /// Modes in use.
    pub modes: usize,
    /// The share of the cells' variance that each explains, 0 to 1.
    pub explained: Vec<f64>,
    /// What was left out to choose by: `paths`, `recordings` or `blocks of time`.
    pub left_out: String,
    /// RMSE of a ridge on what was left out, a target each in its unit.
    pub left_out_rmse: Vec<f64>,
    /// Shrinkage, a target each, the cells' unit squared; of ridge.
    pub lambda: Vec<f64>,
    /// Of a process, a target each.
    pub covariances: Vec<Covariance>,
    /// How well directions are recognized, where the targets are the forces.
    pub directions: Option<Directions>,
    /// Why there are none.
    pub no_directions: Option<String>,
    /// What to look at, in words.
    pub warnings: Vec<String>,
}

/// Fits modes (`asked`, or as many as do best on what is left out) and a regression on their scores.
pub fn fit_eigennails(
    data: &Dataset,
    on_scores: OnScores,
    asked: Option<usize>,
) -> Result<(Eigennails, EigennailsReport), FitFault> {
    let whole = whole_rows(data)?;
    let (x, y) = (data.x().select(Axis(0), &whole), data.y().select(Axis(0), &whole));
    let (basis, explained) = Basis::fit(x.view(), asked.unwrap_or(MOST_MODES)).ok_or(FitFault::Unchanging)?;
    let mut warnings = Vec::new();
    if let Some(asked) = asked.filter(|asked| *asked > explained.len()) {
        let (rows, cells, found) = (whole.len(), data.inputs().len(), explained.len());
        warnings.push(format!(
            "{asked} modes were asked for, and {rows} rows of {cells} cells determine {found}; these are used"
        ));
    }
    let hidden = data.rows() - whole.len();
    if 2 * hidden > data.rows() {
        warnings.push(format!("{hidden} of {} rows lack a cell and are not trained on", data.rows()));
    }
    warnings.extend(unchanging(data.targets(), &y));
    let scores = (&x - &ndarray::ArrayView1::from(basis.mean())).dot(&basis.modes().t());
    let (left_out, groups) = groups(data, &whole);
    let Choice { modes, lambda, residuals } =
        choose(scores.view(), y.view(), &groups, asked).ok_or(FitFault::Unchanging)?;
    let basis = basis.first(modes);
    let scores = scores.select(Axis(1), &(0..modes).collect::<Vec<_>>());
    let whitened = &scores / &ndarray::ArrayView1::from(basis.spread());
    let left_out_rmse: Vec<f64> =
        residuals.columns().into_iter().map(|column| column.mapv(|r| r * r).mean().unwrap_or(0.0).sqrt()).collect();
    let (regression, lambda, covariances) = match on_scores {
        OnScores::Ridge => {
            let ridge = fit_ridge(&scores, &y, &lambda, &left_out_rmse, basis.spread())?;
            (Regression::Ridge(ridge), lambda, Vec::new())
        }
        OnScores::Process => {
            let process = process::fit(&whitened, y.view(), &groups, basis.spread())?;
            let covariances = process.covariances().to_vec();
            (Regression::Process(process), Vec::new(), covariances)
        }
    };
    let place = |force: &str| data.targets().iter().position(|target| target == force);
    let found = match FORCES.map(place) {
        [Some(fx), Some(fy), Some(fz)] => directions::directions(&whitened, &y.select(Axis(1), &[fx, fy, fz]), &groups),
        _ => Err(format!("the targets are not {}", FORCES.join(", "))),
    };
    let ranges = scores.columns().into_iter().map(|column| {
        column.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &s| [s.min(low), s.max(high)])
    });
    let model = Eigennails::new(basis, regression, ranges.collect())?;
    let report = EigennailsReport {
        rows: whole.len(),
        hidden,
        modes,
        explained: explained[..modes].to_vec(),
        left_out: left_out.to_owned(),
        left_out_rmse,
        lambda,
        covariances,
        no_directions: found.as_ref().err().cloned(),
        directions: found.ok(),
        warnings,
    };
    Ok((model, report))
}

fn fit_ridge(
    scores: &Array2<f64>,
    y: &Array2<f64>,
    lambda: &[f64],
    residual_sd: &[f64],
    spread: &[f64],
) -> Result<Ridge, FitFault> {
    let (rows, modes) = scores.dim();
    let every: Vec<usize> = (0..rows).collect();
    let all = ridge::Moments::of(scores.view(), y.view(), &every);
    let mut coefficients = Array2::zeros((lambda.len(), modes));
    let mut offset = Vec::new();
    for (target, &lambda) in lambda.iter().enumerate() {
        let (b, at) = all.solve(modes, lambda).ok_or(FitFault::Unchanging)?.swap_remove(target);
        coefficients.row_mut(target).iter_mut().zip(b).for_each(|(to, b)| *to = b);
        offset.push(at);
    }
    Ok(Ridge::new(coefficients, offset, lambda.to_vec(), residual_sd.to_vec(), rows, spread)?)
}

/// The rows that have all cells.
fn whole_rows(data: &Dataset) -> Result<Vec<usize>, FitFault> {
    let rows = data.x().rows().into_iter().enumerate();
    let whole: Vec<usize> = rows.filter(|(_, row)| row.iter().all(|cell| cell.is_finite())).map(|(k, _)| k).collect();
    if whole.len() >= LEAST_ROWS {
        return Ok(whole);
    }
    let lacks = |cell: usize| data.x().column(cell).iter().filter(|value| value.is_nan()).count();
    let most = (0..data.inputs().len()).rev().max_by_key(|&cell| lacks(cell));
    let cell = most.filter(|&cell| lacks(cell) > 0);
    Err(FitFault::TooFewWhole {
        whole: whole.len(),
        rows: data.rows(),
        cell: cell.map_or(String::new(), |cell| {
            format!("; {} is hidden in {} of them: leave it out of --inputs", data.inputs()[cell], lacks(cell))
        }),
        needed: LEAST_ROWS,
    })
}

/// What is left out in turn: what it is, and its places among the whole rows, ascending.
fn groups(data: &Dataset, whole: &[usize]) -> (&'static str, Vec<Vec<usize>>) {
    let path = paths(data);
    let recording = |row: usize| data.recordings().partition_point(|one| one.rows.end <= row);
    let by = |of: &dyn Fn(usize) -> usize| {
        let mut all: Vec<(usize, Vec<usize>)> = Vec::new();
        for (k, &row) in whole.iter().enumerate() {
            let key = of(row);
            match all.iter_mut().find(|(one, _)| *one == key) {
                Some((_, rows)) => rows.push(k),
                None => all.push((key, vec![k])),
            }
        }
        all.into_iter().map(|(_, rows)| rows).collect::<Vec<_>>()
    };
    let by_path = by(&|row| path[recording(row)]);
    if by_path.len() > 1 {
        return ("paths", by_path);
    }
    let by_recording = by(&recording);
    if by_recording.len() > 1 {
        return ("recordings", by_recording);
    }
    let block = |block: usize| (block * whole.len() / BLOCKS..(block + 1) * whole.len() / BLOCKS).collect();
    ("blocks of time", (0..BLOCKS).map(block).collect())
}
