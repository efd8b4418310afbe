//! Householder's factorization of small matrices kept column by column, with and without pivoting, and what is solved
//! with it.

pub(crate) type Column = Vec<f64>;

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Reflects rows j.. so that column j vanishes below row j; the columns after it go along.
fn eliminate(columns: &mut [Column], j: usize) {
    let (head, rest) = columns.split_at_mut(j + 1);
    let v = &mut head[j][j..];
    let length = norm(v);
    if length == 0.0 {
        return;
    }
    let beta = if v[0] > 0.0 { -length } else { length };
    v[0] -= beta;
    let half = -beta * v[0];
    for column in rest {
        let w = dot(v, &column[j..]) / half;
        column[j..].iter_mut().zip(&*v).for_each(|(value, v)| *value -= w * v);
    }
    v.fill(0.0);
    v[0] = beta;
}

/// The first `count` columns to an upper triangle, those after it (right-hand sides) along.
pub(crate) fn triangulate(columns: &mut [Column], count: usize) {
    for j in 0..count.min(columns.first().map_or(0, Vec::len)) {
        eliminate(columns, j);
    }
}

/// The same with pivoting: what is left of a column is measured by its limit, how long a part of it may be rounding.
/// The column with the most of that comes next, of equals the first, and one whose rest is no longer than its limit
/// never. Columns known to few digits so come after those known to many: one that is another seen on a large offset
/// depends on that other, not the other way round. Returns the order of the columns and how many were taken (the rank).
pub(crate) fn pivot(columns: &mut [Column], limits: &[f64]) -> (Vec<usize>, usize) {
    let mut order: Vec<usize> = (0..columns.len()).collect();
    for j in 0..columns.len() {
        let mut best = (0.0, None);
        for k in j..columns.len() {
            let rest = norm(&columns[k][j..]);
            let limit = limits[order[k]];
            if rest > limit && rest / limit > best.0 {
                best = (rest / limit, Some(k));
            }
        }
        let Some(k) = best.1 else { return (order, j) };
        // Those passed over keep their order.
        columns[j..=k].rotate_right(1);
        order[j..=k].rotate_right(1);
        eliminate(columns, j);
    }
    let rank = columns.len();
    (order, rank)
}

/// x of F x = b, F the upper triangle in the first columns.
pub(crate) fn back(f: &[Column], b: &[f64]) -> Vec<f64> {
    let mut x = b[..f.len()].to_vec();
    for j in (0..f.len()).rev() {
        x[j] /= f[j][j];
        let known = x[j];
        x[..j].iter_mut().zip(&f[j]).for_each(|(x, f)| *x -= f * known);
    }
    x
}

/// x of F^T x = b.
pub(crate) fn forward(f: &[Column], b: &[f64]) -> Vec<f64> {
    let mut x = b.to_vec();
    for j in 0..f.len() {
        x[j] = (x[j] - dot(&f[j][..j], &x[..j])) / f[j][j];
    }
    x
}

/// Length of each row of F's inverse: square roots of the diagonal of (F^T F)^-1.
pub(crate) fn inverse_rows(f: &[Column]) -> Vec<f64> {
    let mut squares = vec![0.0; f.len()];
    for j in 0..f.len() {
        let mut unit = vec![0.0; j + 1];
        unit[j] = 1.0;
        for (sum, x) in squares.iter_mut().zip(back(&f[..=j], &unit)) {
            *sum += x * x;
        }
    }
    squares.into_iter().map(f64::sqrt).collect()
}

/// Orthonormal columns that span the same as `columns`, which are independent.
pub(crate) fn orthonormal(columns: &[Column]) -> Vec<Column> {
    let mut out: Vec<Column> = Vec::new();
    for column in columns {
        let mut v = column.clone();
        // Twice is enough (Kahan, in Parlett's The Symmetric Eigenvalue Problem, 6.9).
        for _ in 0..2 {
            for q in &out {
                let w = dot(q, &v);
                v.iter_mut().zip(q).for_each(|(v, q)| *v -= w * q);
            }
        }
        let length = norm(&v);
        v.iter_mut().for_each(|v| *v /= length);
        out.push(v);
    }
    out
}
