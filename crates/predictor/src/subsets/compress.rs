//! Two sets of rows in two small triangles that hold all that linear models of any photodiodes can tell of them.
//!
//! In: training and validation rows. Out: the triangles of [voltages | targets], both centred at the *training* means
//! and scaled by powers of two, so that the norm of a training column is from 1 to 2. Means are taken as two doubles:
//! an offset of 2^20 V under a signal of 2^-10 V costs the signal nothing.

use ndarray::{Array2, ArrayView1, ArrayView2, Axis, concatenate};

use crate::Dataset;
use crate::algebra::small::norm;
use crate::evaluate::sum::{exact_mean, largest, power_of_two};
use crate::least_squares::{rounding, triangle};

/// What is left of training and validation rows.
pub(super) struct Compressed {
    /// Training columns, photodiodes first, then targets, of the triangle; all of one length.
    pub(super) train: Vec<Vec<f64>>,
    /// Validation columns, in the same scales.
    pub(super) validate: Vec<Vec<f64>>,
    /// How many columns are photodiodes.
    pub(super) inputs: usize,
    /// How much of a photodiode's column may be rounding.
    pub(super) limits: Vec<f64>,
    /// What a target's numbers are to be multiplied with, in two factors whose product may not be a double.
    pub(super) unit: Vec<[f64; 2]>,
    pub(super) train_rows: usize,
    pub(super) validate_rows: usize,
}

/// What brings a column of voltages or targets to size 1 and mean 0.
struct Centre {
    /// A power of two near the largest training value.
    size: f64,
    /// That largest value in units of it.
    most: f64,
    /// The mean in units of it, and what the double leaves over.
    mean: (f64, f64),
    constant: bool,
}

impl Centre {
    fn of(column: ArrayView1<f64>) -> Self {
        let most = largest(column.iter().copied());
        let size = power_of_two(most);
        let mean = exact_mean(column.iter().map(|value| value / size));
        Self { size, most: most / size, mean, constant: column.iter().all(|value| *value == column[0]) }
    }

    fn apply(&self, value: f64) -> f64 {
        (value / self.size - self.mean.0) - self.mean.1
    }
}

impl Compressed {
    /// Both sets have rows, and the same columns.
    pub(super) fn new(train: &Dataset, validate: &Dataset) -> Self {
        let inputs = train.inputs().len();
        let columns = |data: &Dataset| -> Array2<f64> {
            concatenate(Axis(1), &[data.x().view(), data.y().view()]).expect("as many targets as voltages, row by row")
        };
        let (mut train_all, mut validate_all) = (columns(train), columns(validate));
        let centres: Vec<Centre> = train_all.columns().into_iter().map(Centre::of).collect();
        for (k, centre) in centres.iter().enumerate() {
            let mut own = train_all.column_mut(k);
            own.mapv_inplace(|value| if centre.constant { 0.0 } else { centre.apply(value) });
            validate_all.column_mut(k).mapv_inplace(|value| centre.apply(value));
        }
        let rows = train.rows();
        let mut result = Self {
            train: split(train_all.view()),
            validate: split(validate_all.view()),
            inputs,
            limits: Vec::new(),
            unit: Vec::new(),
            train_rows: rows,
            validate_rows: validate.rows(),
        };
        for (k, centre) in centres.iter().enumerate() {
            result.scale(k, centre);
        }
        result
    }

    /// Brings a training column's norm to 1..2, and its validation column along.
    fn scale(&mut self, k: usize, centre: &Centre) {
        let own = norm(&self.train[k]);
        let scale = if own > 0.0 { power_of_two(own) } else { 1.0 };
        for column in [&mut self.train[k], &mut self.validate[k]] {
            column.iter_mut().for_each(|value| *value /= scale);
        }
        if k < self.inputs {
            self.limits.push(rounding(self.train_rows) * centre.most / scale);
        } else {
            self.unit.push([scale, centre.size]);
        }
    }
}

/// The columns of a triangle.
fn split(rows: ArrayView2<f64>) -> Vec<Vec<f64>> {
    triangle(rows).columns().into_iter().map(|column| column.to_vec()).collect()
}
