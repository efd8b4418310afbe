//! Sets and models that the tests of evaluation share.

use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::splits::baseline::nearest;
use crate::{Dataset, Recording};

/// One recording: y = row, x = 2 row + 1.
pub(crate) fn line(rows: usize) -> Dataset {
    let x = Array2::from_shape_fn((rows, 1), |(row, _)| 2.0 * row as f64 + 1.0);
    let y = Array2::from_shape_fn((rows, 1), |(row, _)| row as f64);
    Dataset::plain(vec!["P1".into()], vec!["J2_deg".into()], x, y, 0.04).unwrap()
}

/// Recordings (name, session, subject, rows) of two photodiodes and two targets, with a level and a sensitivity that
/// each recording has of its own, as a sensor has that was taken off in between, and a drift within. Normal noise of
/// 0.03.
pub(crate) fn recordings(all: &[(&str, &str, &str, usize)]) -> Dataset {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
    let n: usize = all.iter().map(|one| one.3).sum();
    let (mut x, mut y, mut time) = (Array2::zeros((n, 2)), Array2::zeros((n, 2)), Vec::new());
    let (mut start, mut kept) = (0, Vec::new());
    for &(name, session, subject, rows) in all {
        let levels = [0.3 * normal(), 0.3 * normal()];
        for k in 0..rows {
            let (row, phase) = (start + k, 7.0 * k as f64 / rows as f64);
            let force = [phase.sin(), -1.0 - (0.7 * phase).cos()];
            for column in 0..2 {
                y[[row, column]] = force[column];
                x[[row, column]] = 2.5 + force[column] + 0.5 * force[1 - column] + levels[column] + 0.03 * normal();
            }
            time.push(0.04 * k as f64);
        }
        kept.push(Recording {
            name: name.into(),
            session: session.into(),
            subject: subject.into(),
            rows: start..start + rows,
        });
        start += rows;
    }
    let names = |all: [&str; 2]| all.map(str::to_owned).to_vec();
    Dataset::new(names(["P1", "P2"]), names(["Fx_N", "Fz_N"]), time, x, y, kept).unwrap()
}

/// What the nearest training row had: it remembers all, so rows nearby in time flatter it.
pub(crate) struct Nearest(pub(crate) Dataset);

impl Nearest {
    pub(crate) fn fit(data: &Dataset) -> Result<Self, String> {
        if data.rows() == 0 { Err("no rows".to_owned()) } else { Ok(Self(data.clone())) }
    }

    pub(crate) fn predict(&self, data: &Dataset) -> Array2<f64> {
        nearest(&self.0, data)
    }
}

/// The mean of the training rows.
pub(crate) fn mean_of(data: &Dataset) -> Result<Vec<f64>, String> {
    data.y().mean_axis(ndarray::Axis(0)).map(|mean| mean.to_vec()).ok_or_else(|| "no rows".to_owned())
}

/// That mean, row by row.
pub(crate) fn repeat(mean: &[f64], data: &Dataset) -> Array2<f64> {
    Array2::from_shape_fn(data.y().dim(), |(_, column)| mean[column])
}
