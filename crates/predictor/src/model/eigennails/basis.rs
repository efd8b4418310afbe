//! Eigennails: the modes in which the cells of a nail change together.
//!
//! In: rows x cells of the normalized nail, in the unit of the cells. Out: mean, modes (each of length 1) and how far
//! each spreads; of a row its scores, (cells - mean) along each mode, in the cells' unit. The modes are the right
//! singular vectors of the centred rows; of each the largest component is positive, of equal ones the first.
//!
//! A row may lack cells (NaN: hidden). Its scores are then least squares onto the modes at the cells that are there,
//! with the spread of each mode as what was known before: a mode whose cells are all hidden comes out at 0 with its
//! whole spread. How well the scores are known then is handed out as a covariance.

use ndarray::{Array2, ArrayView2, Axis, Slice};
use serde::Serialize;

use super::super::{ModelFault, finite, finite_matrix, inverses, sizes};
use crate::algebra::cholesky::Cholesky;
use crate::algebra::svd::modes;
use crate::least_squares::triangle;

/// Of fewer known cells than this share a row has no scores; assumed.
const LEAST_KNOWN: f64 = 0.5;
/// The least noise of a cell over the first mode's spread, squared: it keeps hidden modes solvable where rows have no
/// noise; assumed.
const LEAST_NOISE: f64 = 1e-12;

/// Modes of the cells.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Basis {
    mean: Vec<f64>,
    #[serde(serialize_with = "crate::model::rows")]
    modes: Array2<f64>,
    spread: Vec<f64>,
    noise: f64,
}

/// Scores of a row.
#[derive(Debug, Clone, PartialEq)]
pub struct Projection {
    /// A mode each, the cells' unit.
    pub scores: Vec<f64>,
    /// Covariance of the scores, modes x modes, the cells' unit squared; none where all cells are known: then what the
    /// noise does to the scores is part of what the regression does not explain.
    pub hidden: Option<Array2<f64>>,
}

impl Basis {
    /// `mean`: a cell each; `modes`: modes x cells, of length 1; `spread`: SD of the scores, a mode each, above 0;
    /// `noise`: variance of a cell that no mode explains. All in the cells' unit.
    pub fn new(mean: Vec<f64>, modes: Array2<f64>, spread: Vec<f64>, noise: f64) -> Result<Self, ModelFault> {
        sizes(&[("cells of the modes", modes.ncols(), mean.len()), ("modes", modes.nrows(), spread.len())])?;
        finite(&[("mean", &mean), ("noise", &[noise])])?;
        finite_matrix("modes", &modes)?;
        inverses("spread", &spread)?;
        if noise < 0.0 {
            return Err(ModelFault::Number("noise"));
        }
        Ok(Self { mean, modes: modes.as_standard_layout().into_owned(), spread, noise })
    }

    /// The modes of rows x cells, all finite, at most `most` and no more than the rows determine; and the share of the
    /// variance that each explains. None where no cell changes.
    #[must_use]
    pub fn fit(x: ArrayView2<'_, f64>, most: usize) -> Option<(Self, Vec<f64>)> {
        let (rows, cells) = x.dim();
        let mean = x.mean_axis(Axis(0))?;
        let centred = &x - &mean;
        // The triangle of tall rows has their singular values and modes, and is smaller.
        let small = if rows > cells { triangle(centred.view()) } else { centred };
        let found = modes(small.t());
        let largest = x.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        // Rounding of the mean and of the sums leaves so much where nothing changes.
        let rounding = f64::EPSILON * (rows.max(cells) as f64) * largest * (rows as f64).sqrt().min(1e3);
        let rank = found.sigma.iter().take_while(|sigma| **sigma > rounding).count();
        let count = rank.min(most);
        if count == 0 {
            return None;
        }
        let degrees = (rows as f64 - 1.0).max(1.0);
        let variances: Vec<f64> = found.sigma.iter().map(|sigma| sigma * sigma / degrees).collect();
        let all: f64 = variances.iter().sum();
        let rest: f64 = variances[count..].iter().sum();
        let noise = if cells > count { rest / (cells - count) as f64 } else { 0.0 };
        let spread = variances[..count].iter().map(|variance| variance.sqrt()).collect();
        let modes = Array2::from_shape_fn((count, cells), |(mode, cell)| found.left[[cell, mode]]);
        let basis = Self::new(mean.to_vec(), modes, spread, noise).ok()?;
        Some((basis, variances[..count].iter().map(|variance| variance / all).collect()))
    }

    /// Mean of each cell.
    #[must_use]
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// Modes x cells.
    #[must_use]
    pub fn modes(&self) -> &Array2<f64> {
        &self.modes
    }

    /// SD of the scores of the training rows, a mode each.
    #[must_use]
    pub fn spread(&self) -> &[f64] {
        &self.spread
    }

    /// The first `count` modes; what the others explained is noise then.
    #[must_use]
    pub fn first(&self, count: usize) -> Self {
        let (cells, all) = (self.mean.len(), self.spread.len());
        let lost: f64 = self.spread[count..].iter().map(|spread| spread * spread).sum();
        let rest = self.noise * (cells - all) as f64 + lost;
        Self {
            mean: self.mean.clone(),
            modes: self.modes.slice_axis(Axis(0), Slice::from(..count)).to_owned(),
            spread: self.spread[..count].to_vec(),
            noise: if cells > count { rest / (cells - count) as f64 } else { 0.0 },
        }
    }

    /// Scores of a row of cells, NaN where hidden. None where too few cells are known, or one is infinite.
    ///
    /// # Panics
    /// Where the row is not as long as the mean.
    #[must_use]
    pub fn project(&self, cells: &[f64]) -> Option<Projection> {
        assert_eq!(cells.len(), self.mean.len(), "a row of the model's size");
        let known = cells.iter().filter(|cell| cell.is_finite()).count();
        if cells.iter().any(|cell| cell.is_infinite()) || (known as f64) < LEAST_KNOWN * cells.len() as f64 {
            return None;
        }
        let apart: Vec<f64> =
            cells.iter().zip(&self.mean).map(|(cell, mean)| if cell.is_nan() { 0.0 } else { cell - mean }).collect();
        let along = |mode: ndarray::ArrayView1<'_, f64>| mode.iter().zip(&apart).map(|(m, a)| m * a).sum::<f64>();
        let mut scores: Vec<f64> = self.modes.rows().into_iter().map(along).collect();
        if known == cells.len() {
            return Some(Projection { scores, hidden: None });
        }
        let count = scores.len();
        let noise = self.noise.max(LEAST_NOISE * self.spread[0] * self.spread[0]);
        let mut normal = vec![0.0; count * count];
        for i in 0..count {
            for j in i..count {
                let both = self.modes.row(i).into_iter().zip(self.modes.row(j)).zip(cells);
                normal[i * count + j] = both.filter(|(_, cell)| !cell.is_nan()).map(|((a, b), _)| a * b).sum();
            }
            normal[i * count + i] += noise / (self.spread[i] * self.spread[i]);
        }
        let factor = Cholesky::of(normal, count, 0.0)?;
        factor.solve(&mut scores);
        let inverse = factor.inverse();
        let hidden = Array2::from_shape_fn((count, count), |(i, j)| noise * inverse[i * count + j]);
        Some(Projection { scores, hidden: Some(hidden) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest gap found to nalgebra's SVD: 2e-14.
    const SVD: f64 = 1e-10;

    fn wave(rows: usize, cells: usize) -> Array2<f64> {
        Array2::from_shape_fn((rows, cells), |(row, cell)| {
            let (t, c) = (row as f64, cell as f64);
            let noise = ((t * 12.9898 + c * 78.233).sin() * 43_758.545_3).fract();
            50.0 + (0.3 * t).sin() * (0.2 * c).cos() + 0.3 * (0.11 * t * t).cos() * (0.5 * c).sin() + 0.1 * noise
        })
    }

    #[test]
    fn modes_are_those_of_nalgebra() {
        // Tall, square, wide.
        for (rows, cells) in [(200, 16), (20, 20), (12, 36)] {
            let x = wave(rows, cells);
            let (basis, _) = Basis::fit(x.view(), 8).unwrap();
            let centred = &x - &x.mean_axis(Axis(0)).unwrap();
            let theirs = nalgebra::DMatrix::from_fn(rows, cells, |i, j| centred[[i, j]]).svd(false, true);
            let mut order: Vec<usize> = (0..theirs.singular_values.len()).collect();
            order.sort_by(|&a, &b| theirs.singular_values[b].total_cmp(&theirs.singular_values[a]));
            let v = theirs.v_t.unwrap();
            for (k, &at) in order.iter().take(8).enumerate() {
                let spread = theirs.singular_values[at] / (rows as f64 - 1.0).sqrt();
                assert!((basis.spread()[k] - spread).abs() <= SVD * spread, "{rows} x {cells}, mode {k}");
                let mode: Vec<f64> = v.row(at).iter().copied().collect();
                let most = mode.iter().fold(0.0, |most: f64, &one| if one.abs() > most.abs() { one } else { most });
                for (ours, theirs) in basis.modes().row(k).iter().zip(&mode) {
                    let gap = (ours - theirs * most.signum()).abs();
                    assert!(gap <= SVD, "{rows} x {cells}, mode {k}: {gap:e}");
                }
            }
        }
    }

    #[test]
    fn fewer_rows_than_modes_and_cells_that_do_not_change() {
        let (basis, shares) = Basis::fit(wave(5, 36).view(), 12).unwrap();
        assert_eq!((basis.spread().len(), shares.len()), (4, 4), "five centred rows span four modes");
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(Basis::fit(Array2::from_elem((700, 9), 0.1).view(), 4).is_none());
        assert!(Basis::fit(wave(1, 9).view(), 4).is_none());
    }

    #[test]
    fn hidden_cells_cost_certainty_not_the_scores() {
        let x = wave(300, 36);
        let (basis, _) = Basis::fit(x.view(), 2).unwrap();
        let whole = basis.project(x.row(40).as_slice().unwrap()).unwrap();
        assert!(whole.hidden.is_none());
        let mut some = x.row(40).to_vec();
        some[3..9].fill(f64::NAN);
        let part = basis.project(&some).unwrap();
        for k in 0..2 {
            let gap = (part.scores[k] - whole.scores[k]).abs();
            let sd = part.hidden.as_ref().unwrap()[[k, k]].sqrt();
            assert!(sd > 0.0 && gap <= 4.0 * sd, "mode {k}: {gap} of {sd}");
        }
        // More hidden, more variance.
        some[9..15].fill(f64::NAN);
        let less = basis.project(&some).unwrap();
        assert!(less.hidden.unwrap()[[0, 0]] > part.hidden.unwrap()[[0, 0]]);
        some[..20].fill(f64::NAN);
        assert_eq!(basis.project(&some), None, "more than half hidden");
        some[..20].fill(f64::INFINITY);
        assert_eq!(basis.project(&some), None);
    }

    #[test]
    fn a_mode_that_is_all_hidden_keeps_its_whole_spread() {
        // Two modes of cells of their own, 0 to 3 and 4 to 7, of whole turns over the rows.
        let turn = |row: usize, times: f64| std::f64::consts::TAU * times * row as f64 / 60.0;
        let x =
            Array2::from_shape_fn(
                (60, 8),
                |(row, cell)| {
                    if cell < 4 { 3.0 * turn(row, 7.0).sin() } else { turn(row, 11.0).cos() }
                },
            );
        let (basis, _) = Basis::fit(x.view(), 2).unwrap();
        let mut row = x.row(11).to_vec();
        row[4..].fill(f64::NAN);
        let found = basis.project(&row).unwrap();
        assert!(found.scores[1].abs() < 1e-9, "{:?}", found.scores);
        let variance = found.hidden.unwrap()[[1, 1]];
        let whole = basis.spread()[1] * basis.spread()[1];
        assert!((variance - whole).abs() <= 1e-3 * whole, "{variance} of {whole}");
    }
}
