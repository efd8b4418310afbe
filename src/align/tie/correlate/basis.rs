//! What the channels are made of: each angle by itself, bent as need be, or all of them together.
//!
//! A photodiode answers to an angle along a curve (it is flat beyond 25 to 30 degrees, section 3.3.5). A curve is a
//! broken line with its knots between the angle's quantiles and even steps of it; the columns are its hats but for the
//! first, which the mean stands for.

/// Some of the video's columns as regressors.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Model {
    /// Which column, and its knots, ascending; two knots are a straight line.
    curves: Vec<(usize, Vec<f64>)>,
}

impl Model {
    /// Each column alone with up to `most` free numbers, and all of them together with as many altogether, if there are
    /// several.
    pub(super) fn all(columns: &[Vec<f64>], most: usize) -> Vec<Self> {
        let curve = |k: usize, free: usize| (k, knots(&columns[k], free.max(1)));
        let mut models: Vec<Self> = (0..columns.len()).map(|k| Self { curves: vec![curve(k, most)] }).collect();
        if columns.len() > 1 {
            let free = most / columns.len();
            models.push(Self { curves: (0..columns.len()).map(|k| curve(k, free)).collect() });
        }
        models
    }

    /// How many regressors.
    pub(super) fn columns(&self) -> usize {
        self.curves.iter().map(|(_, knots)| knots.len() - 1).sum()
    }

    /// The regressors of a row, appended to `out`.
    pub(super) fn row(&self, row: &[f64], out: &mut Vec<f64>) {
        for (column, knots) in &self.curves {
            let value = row[*column].clamp(knots[0], knots[knots.len() - 1]);
            let after = knots[1..knots.len() - 1].partition_point(|knot| *knot <= value);
            let share = (value - knots[after]) / (knots[after + 1] - knots[after]);
            out.extend((0..knots.len() - 1).map(|k| {
                if k == after {
                    share
                } else if k + 1 == after {
                    1.0 - share
                } else {
                    0.0
                }
            }));
        }
    }
}

/// Both ends, and between them the middles of quantiles and even steps; `free` + 1 of them, fewer where quantiles are
/// the same.
fn knots(column: &[f64], free: usize) -> Vec<f64> {
    let mut sorted = column.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len() - 1;
    let mut knots: Vec<f64> = Vec::with_capacity(free + 1);
    let least = 1e-3 * (sorted[last] - sorted[0]);
    let mut before = f64::NEG_INFINITY;
    for k in 0..free {
        let quantile = sorted[k * last / free];
        if quantile - before > least && (k == 0 || sorted[last] - quantile > least) {
            let even = sorted[0] + (sorted[last] - sorted[0]) * k as f64 / free as f64;
            knots.push(0.5 * (quantile + even));
            before = quantile;
        }
    }
    knots.push(sorted[last]);
    knots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_add_up_to_a_line_through_the_knots() {
        let column: Vec<f64> = (0..=100).map(f64::from).collect();
        let model = &Model::all(&[column], 4)[0];
        assert_eq!(model.curves[0].1, [0.0, 25.0, 50.0, 75.0, 100.0]);
        for x in [0.0, 10.0, 25.0, 60.0, 100.0, -5.0, 130.0] {
            let mut row = Vec::new();
            model.row(&[x], &mut row);
            let line: f64 = row.iter().zip([25.0, 50.0, 75.0, 100.0]).map(|(hat, at)| hat * at).sum();
            assert!((line - x.clamp(0.0, 100.0)).abs() < 1e-9, "{x} {row:?}");
        }
    }

    #[test]
    fn a_column_of_few_values_has_few_knots() {
        let steps: Vec<f64> = (0..100).map(|k| f64::from(k / 60)).collect();
        let models = Model::all(&[steps.clone(), steps], 6);
        assert_eq!(models.iter().map(Model::columns).collect::<Vec<_>>(), [1, 1, 2]);
    }
}
