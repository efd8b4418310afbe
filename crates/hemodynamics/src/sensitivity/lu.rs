//! Dense linear systems of a few unknowns, by rows scaled to their largest entry and partial pivoting. The same digits
//! on every machine, and no memory allocated again: there is one for every step of a fit's every transient.

/// A factorized square matrix; its memory is kept from one factorization to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lu {
    n: usize,
    /// Row-major; the multipliers below the diagonal.
    values: Vec<f64>,
    pivots: Vec<usize>,
    scales: Vec<f64>,
}

impl Lu {
    /// Room for a matrix of `n` rows, all zero, to be filled row by row.
    pub(crate) fn clear(&mut self, n: usize) -> &mut [f64] {
        self.n = n;
        self.values.clear();
        self.values.resize(n * n, 0.0);
        &mut self.values
    }

    /// Factorizes what was filled in; false where the matrix is singular or not finite.
    pub(crate) fn factorize(&mut self) -> bool {
        let n = self.n;
        self.scales.clear();
        self.pivots.clear();
        for row in self.values.chunks_exact_mut(n) {
            let largest = row.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            if !(largest > 0.0 && largest.is_finite()) {
                return false;
            }
            let scale = 1.0 / largest;
            row.iter_mut().for_each(|value| *value *= scale);
            self.scales.push(scale);
        }
        for k in 0..n {
            let mut pivot = k;
            for i in k + 1..n {
                if self.values[i * n + k].abs() > self.values[pivot * n + k].abs() {
                    pivot = i;
                }
            }
            self.pivots.push(pivot);
            if pivot != k {
                let (upper, lower) = self.values.split_at_mut(pivot * n);
                upper[k * n..(k + 1) * n].swap_with_slice(&mut lower[..n]);
            }
            let (upper, lower) = self.values.split_at_mut((k + 1) * n);
            let row = &upper[k * n..];
            let diagonal = row[k];
            if !(diagonal.abs() > 0.0 && diagonal.is_finite()) {
                return false;
            }
            for below in lower.chunks_exact_mut(n) {
                let factor = below[k] / diagonal;
                below[k] = factor;
                for (value, of) in below[k + 1..].iter_mut().zip(&row[k + 1..]) {
                    *value -= factor * of;
                }
            }
        }
        true
    }

    pub(crate) fn solve(&self, b: &mut [f64]) {
        let n = self.n;
        for (value, scale) in b.iter_mut().zip(&self.scales) {
            *value *= scale;
        }
        for (k, &pivot) in self.pivots.iter().enumerate() {
            b.swap(k, pivot);
        }
        for i in 1..n {
            let (done, rest) = b.split_at_mut(i);
            for (value, of) in done.iter().zip(&self.values[i * n..]) {
                rest[0] -= value * of;
            }
        }
        for i in (0..n).rev() {
            let (head, done) = b.split_at_mut(i + 1);
            let row = &self.values[i * n..(i + 1) * n];
            for (value, of) in done.iter().zip(&row[i + 1..]) {
                head[i] -= value * of;
            }
            head[i] /= row[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_rows_of_very_different_size() {
        let rows = [[0.0, 2.0, 1.0, 4.0], [1e9, 3e9, -2e9, 1e8], [1e-9, 0.0, 5e-9, 1e-9], [3.0, 1.0, 1.0, 0.5]];
        let x = [1.0, -2.0, 3.0, 0.25];
        let mut b: Vec<f64> = rows.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
        let mut lu = Lu::default();
        lu.clear(4).copy_from_slice(&rows.concat());
        assert!(lu.factorize());
        lu.solve(&mut b);
        for (got, expected) in b.iter().zip(&x) {
            // Rounding: measured 6e-16.
            assert!((got - expected).abs() <= 1e-14, "{b:?}");
        }
    }

    #[test]
    fn a_singular_matrix_is_reported() {
        let mut lu = Lu::default();
        for values in [[1.0, 2.0, 2.0, 4.0], [0.0, 0.0, 1.0, 1.0], [f64::NAN, 1.0, 1.0, 1.0]] {
            lu.clear(2).copy_from_slice(&values);
            assert!(!lu.factorize(), "{values:?}");
        }
    }
}
