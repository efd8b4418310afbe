//! In which of six directions a finger presses, by the picture of its nail (as Sun, Hollerbach and Mascaro, ICRA 2007).
//!
//! In: whitened scores and forces. Out: how often the direction of a row is recognized by a linear discriminant (one
//! covariance for all classes, priors as frequent as the classes) that has not seen the row's group.
//!
//! Classes are by the force: `none` below [`TOUCH_N`]; `press` where the shear is less than [`PRESS`] of the pressing;
//! from [`SHEAR`] of it on the larger component of the shear with its sign, where it is twice the smaller. Rows in
//! between have no clear direction and are not counted. That rule is ours: the source's six were separate presses.

use ndarray::{Array2, ArrayView1};
use serde::{Deserialize, Serialize};

use crate::algebra::cholesky::Cholesky;

/// Below this force nothing is pressed, newtons: that of the gate (equation 9); assumed.
const TOUCH_N: f64 = 0.5;
/// Shear over pressing up to which a press is straight, and from which on it is sideways; assumed.
const PRESS: f64 = 0.15;
const SHEAR: f64 = 0.3;
/// The classes.
const NAMES: [&str; 6] = ["none", "press", "+Fx", "-Fx", "+Fy", "-Fy"];

/// How well directions are recognized.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Directions {
    /// The classes that there are.
    pub classes: Vec<String>,
    /// Rows of each, of clear direction.
    pub rows: Vec<usize>,
    /// Share recognized by a discriminant that has not seen the row's group, 0 to 1.
    pub accuracy: f64,
    /// The share of the most frequent class: what a guess without the picture reaches.
    pub guess: f64,
    /// Rows of a class (down) taken for another (across).
    pub confusion: Vec<Vec<usize>>,
}

/// A linear discriminant.
#[derive(Debug, Clone)]
pub(crate) struct Discriminant {
    /// Class, its mean, the log of its share.
    classes: Vec<(usize, Vec<f64>, f64)>,
    factor: Cholesky,
}

/// The class of a force, newtons; none where its direction is not clear.
fn class([fx, fy, fz]: [f64; 3]) -> Option<usize> {
    let shear = (fx * fx + fy * fy).sqrt();
    if (shear * shear + fz * fz).sqrt() < TOUCH_N {
        Some(0)
    } else if shear < PRESS * fz.abs() {
        Some(1)
    } else if shear < SHEAR * fz.abs() {
        None
    } else if fx.abs() >= 2.0 * fy.abs() {
        Some(if fx > 0.0 { 2 } else { 3 })
    } else if fy.abs() >= 2.0 * fx.abs() {
        Some(if fy > 0.0 { 4 } else { 5 })
    } else {
        None
    }
}

/// Recognizes directions; `forces`: rows x Fx, Fy, Fz; `groups`: rows each, left out in turn.
pub(super) fn directions(
    whitened: &Array2<f64>,
    forces: &Array2<f64>,
    groups: &[Vec<usize>],
) -> Result<Directions, String> {
    let labels: Vec<Option<usize>> = forces.rows().into_iter().map(|row| class([row[0], row[1], row[2]])).collect();
    let there: Vec<usize> = (0..NAMES.len()).filter(|class| labels.contains(&Some(*class))).collect();
    if there.is_empty() {
        return Err("no row has a clear direction".to_owned());
    }
    if let [only] = there[..] {
        return Err(format!("all rows of clear direction are of one, {}; record others as well", NAMES[only]));
    }
    let place = |class: usize| there.iter().position(|one| *one == class);
    let mut confusion = vec![vec![0; there.len()]; there.len()];
    for group in groups {
        let rest: Vec<usize> =
            (0..labels.len()).filter(|row| labels[*row].is_some() && group.binary_search(row).is_err()).collect();
        let Some(found) = Discriminant::fit(whitened, &labels, &rest) else { continue };
        for &row in group {
            if let (Some(is), Some(taken)) = (labels[row].and_then(place), place(found.class(whitened.row(row)))) {
                confusion[is][taken] += 1;
            }
        }
    }
    let judged: usize = confusion.iter().flatten().sum();
    if judged == 0 {
        return Err("no group leaves two directions to tell apart".to_owned());
    }
    let right: usize = (0..there.len()).map(|k| confusion[k][k]).sum();
    let rows: Vec<usize> =
        there.iter().map(|class| labels.iter().filter(|label| **label == Some(*class)).count()).collect();
    Ok(Directions {
        classes: there.iter().map(|&class| NAMES[class].to_owned()).collect(),
        accuracy: right as f64 / judged as f64,
        guess: rows.iter().copied().max().unwrap_or_default() as f64 / rows.iter().sum::<usize>() as f64,
        rows,
        confusion,
    })
}

impl Discriminant {
    /// Of some rows; none where they are of one class, or nothing spreads within classes.
    pub(crate) fn fit(x: &Array2<f64>, labels: &[Option<usize>], rows: &[usize]) -> Option<Self> {
        let size = x.ncols();
        let there: Vec<usize> =
            (0..NAMES.len()).filter(|class| rows.iter().any(|&row| labels[row] == Some(*class))).collect();
        if there.len() < 2 {
            return None;
        }
        let mut covariance = vec![0.0; size * size];
        let mut classes = Vec::new();
        for class in there {
            let own: Vec<usize> = rows.iter().copied().filter(|&row| labels[row] == Some(class)).collect();
            let mean: Vec<f64> =
                (0..size).map(|k| own.iter().map(|&row| x[[row, k]]).sum::<f64>() / own.len() as f64).collect();
            for &row in &own {
                for i in 0..size {
                    for j in i..size {
                        covariance[i * size + j] +=
                            (x[[row, i]] - mean[i]) * (x[[row, j]] - mean[j]) / rows.len() as f64;
                    }
                }
            }
            classes.push((class, mean, (own.len() as f64 / rows.len() as f64).ln()));
        }
        let trace: f64 = (0..size).map(|k| covariance[k * size + k]).sum();
        let factor = Cholesky::of(covariance.clone(), size, 0.0);
        // Where few rows leave the covariance flat, a little roundness keeps it solvable.
        let factor = factor.or_else(|| Cholesky::of(covariance, size, 1e-6 * trace / size as f64))?;
        Some(Self { classes, factor })
    }

    /// The likeliest class.
    pub(crate) fn class(&self, x: ArrayView1<'_, f64>) -> usize {
        let all = self.classes.iter().zip(self.log_likelihoods(x));
        all.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(one, _)| one.0)
    }

    /// Of each class, without what they have in common.
    pub(crate) fn log_likelihoods(&self, x: ArrayView1<'_, f64>) -> Vec<f64> {
        let one = |(_, mean, share): &(usize, Vec<f64>, f64)| {
            let mut apart: Vec<f64> = x.iter().zip(mean).map(|(x, mean)| x - mean).collect();
            share - 0.5 * self.factor.square(&mut apart)
        };
        self.classes.iter().map(one).collect()
    }
}
