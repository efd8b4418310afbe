//! Largest magnitude and mean of each column, in one walk over the rows as they lie.

use crate::algebra::exact::{Long, two_sum};

/// So many rows are looked at side by side.
const SIDE: usize = 8;

/// What a walk over the rows found, column by column.
pub(super) struct Survey {
    /// Largest magnitudes; NaN counts for nothing here.
    pub(super) largest: Vec<f64>,
    /// Sums of twice the length; not finite where a value is not, or where all together are beyond a number.
    pub(super) sums: Vec<Long>,
}

/// Of a matrix in standard layout, `columns` wide. To be called where vector instructions are allowed.
#[inline(always)]
pub(super) fn survey(values: &[f64], columns: usize) -> Survey {
    let wide = columns * SIDE;
    let mut most = vec![0.0; wide];
    let mut high = vec![0.0; wide];
    let mut low = vec![0.0; wide];
    // A last piece that is not full fills the first places; none without columns.
    for piece in values.chunks(wide.max(1)) {
        let lanes = most.iter_mut().zip(high.iter_mut().zip(low.iter_mut()));
        for ((most, (high, low)), &value) in lanes.zip(piece) {
            let size = value.abs();
            *most = if size > *most { size } else { *most };
            let (sum, error) = two_sum(*high, value);
            *high = sum;
            *low += error;
        }
    }
    let lanes = |column: usize| (column..wide).step_by(columns.max(1));
    Survey {
        largest: (0..columns).map(|j| lanes(j).fold(0.0, |all: f64, k| all.max(most[k]))).collect(),
        sums: (0..columns).map(|j| lanes(j).fold(Long::ZERO, |sum, k| sum.plus(Long::of(high[k], low[k])))).collect(),
    }
}
