//! Errors by how hard the finger presses, or how far it bends.
//!
//! In: measured and predicted rows. Out: scores of each bin. Rows are sorted into bins by what was *measured*: the
//! normal force N = -Fz where the targets hold `Fz_N`, else the one target there is (an angle). A bin holds its lower
//! edge and not its upper, the last bin both.

use ndarray::ArrayView2;
use serde::Serialize;
use thiserror::Error;

use super::score::{Scores, score_rows};
use super::sum::power_of_two;

/// One bin's scores.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bin {
    /// Its lower edge, newtons of normal force or the target's unit.
    pub from: f64,
    /// Its upper edge.
    pub to: f64,
    /// Of the rows in it.
    pub scores: Scores,
}

/// Scores by magnitude.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ByMagnitude {
    /// Magnitude of what: `-Fz_N`, or a target's name.
    pub of: String,
    /// Bin by bin.
    pub bins: Vec<Bin>,
    /// Rows below the first edge, above the last, or not measured.
    pub outside: usize,
}

/// Why rows are not sorted into bins.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum MagnitudeFault {
    #[error("the edges of bins must be at least two finite numbers that ascend")]
    Edges,
    #[error("there is neither a target Fz_N nor only one target to sort rows by")]
    Target,
}

/// Scores rows x targets by the magnitude of what was measured.
///
/// # Errors
/// [`MagnitudeFault`].
///
/// # Panics
/// Where the sizes do not agree.
pub fn by_magnitude(
    measured: ArrayView2<f64>,
    predicted: ArrayView2<f64>,
    names: &[String],
    edges: &[f64],
) -> Result<ByMagnitude, MagnitudeFault> {
    // Also refuses NaN.
    let ascend = edges.windows(2).all(|pair| pair[0] < pair[1]);
    if edges.len() < 2 || !ascend || edges.iter().any(|edge| !edge.is_finite()) {
        return Err(MagnitudeFault::Edges);
    }
    let (of, magnitudes) = magnitudes(measured, names)?;
    let last = edges.len() - 2;
    let mut rows = vec![Vec::new(); edges.len() - 1];
    let mut outside = 0;
    for (row, &size) in magnitudes.iter().enumerate() {
        let above = edges.partition_point(|&edge| edge <= size);
        match above.checked_sub(1) {
            Some(bin) if bin <= last => rows[bin].push(row),
            Some(_) if size == edges[last + 1] => rows[last].push(row),
            _ => outside += 1,
        }
    }
    let bins = rows.iter().zip(edges.windows(2)).map(|(rows, edges)| Bin {
        from: edges[0],
        to: edges[1],
        scores: score_rows(measured, predicted, names, rows),
    });
    Ok(ByMagnitude { of, bins: bins.collect(), outside })
}

/// Round edges of about `bins` bins of one width that hold every measured row; none where nothing is measured or all is
/// alike.
///
/// # Errors
/// [`MagnitudeFault::Target`].
pub fn magnitude_edges(
    measured: ArrayView2<f64>,
    names: &[String],
    bins: usize,
) -> Result<Option<Vec<f64>>, MagnitudeFault> {
    let (_, mut sizes) = magnitudes(measured, names)?;
    sizes.retain(|size| size.is_finite());
    let (least, most) = sizes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &v| (a.min(v), b.max(v)));
    let wide = (most - least) / bins.max(1) as f64;
    if !(wide.is_finite() && wide > power_of_two(least.abs().max(most.abs())) * f64::EPSILON) {
        return Ok(None);
    }
    // A step of 1, 2, 5 or 10 tens. A power of ten below 1 is divided by its inverse, which is exact: 3 / 10 is 0.3, 3
    // * 0.1 is not.
    let power = wide.log10().floor();
    let (ten, inverse) = (10f64.powf(power.max(0.0)), 10f64.powf((-power).max(0.0)));
    let size = |tens: f64| tens * ten / inverse;
    let slack = 1.0 + 8.0 * f64::EPSILON;
    let step = [1.0, 2.0, 5.0].into_iter().find(|&step| size(step) * slack >= wide).unwrap_or(10.0);
    let first = (least / size(step)).floor();
    let count = ((most / size(step)).ceil() - first).max(1.0) as usize;
    let edges: Vec<f64> = (0..=count).map(|k| size((first + k as f64) * step)).collect();
    Ok(edges.windows(2).all(|pair| pair[0] < pair[1] && pair[1].is_finite()).then_some(edges))
}

fn magnitudes(measured: ArrayView2<f64>, names: &[String]) -> Result<(String, Vec<f64>), MagnitudeFault> {
    match (names.iter().position(|name| name == "Fz_N"), names) {
        (Some(column), _) => Ok(("-Fz_N".to_owned(), measured.column(column).iter().map(|fz| -fz).collect())),
        (None, [one]) => Ok((one.clone(), measured.column(0).to_vec())),
        _ => Err(MagnitudeFault::Target),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn rows_go_where_they_were_measured() {
        let names = vec!["Fx_N".to_owned(), "Fz_N".to_owned()];
        let measured = array![[0.0, 0.0], [0.0, -0.5], [0.0, -1.0], [0.0, -2.0], [0.0, 0.1], [0.0, f64::NAN]];
        let predicted = array![[0.0, 0.0], [0.0, 0.5], [0.0, -1.0], [1.0, -2.0], [9.0, 0.0], [0.0, 0.0]];
        let all = by_magnitude(measured.view(), predicted.view(), &names, &[0.0, 1.0, 2.0]).unwrap();
        assert_eq!((all.of.as_str(), all.outside), ("-Fz_N", 2));
        assert_eq!(all.bins.iter().map(|bin| bin.scores.rows).collect::<Vec<_>>(), [2, 2]);
        assert_eq!(all.bins[0].scores.targets[1].bias, 0.5);
        assert_eq!(all.bins[1].scores.targets[0].bias, 0.5);
    }

    #[test]
    fn an_angle_has_bins_of_its_own_and_bad_edges_none() {
        let (names, rows) = (vec!["J2_deg".to_owned()], array![[-5.0], [75.0], [30.0]]);
        let edges = magnitude_edges(rows.view(), &names, 4).unwrap().unwrap();
        assert_eq!(edges, [-20.0, 0.0, 20.0, 40.0, 60.0, 80.0]);
        let fine = magnitude_edges(array![[0.0], [0.9]].view(), &names, 9).unwrap().unwrap();
        assert_eq!(fine[3], 0.3, "no 0.30000000000000004");
        let all = by_magnitude(rows.view(), rows.view(), &names, &edges).unwrap();
        assert_eq!((all.of.as_str(), all.outside), ("J2_deg", 0));
        for edges in [&[1.0][..], &[1.0, 1.0], &[2.0, 1.0], &[0.0, f64::NAN], &[0.0, f64::INFINITY]] {
            assert_eq!(by_magnitude(rows.view(), rows.view(), &names, edges), Err(MagnitudeFault::Edges));
        }
        assert_eq!(magnitude_edges(array![[1.0], [1.0]].view(), &names, 4), Ok(None));
        let two = vec!["Fx_N".to_owned(), "Fy_N".to_owned()];
        let pair = array![[1.0, 2.0]];
        assert_eq!(by_magnitude(pair.view(), pair.view(), &two, &[0.0, 1.0]), Err(MagnitudeFault::Target));
    }
}
