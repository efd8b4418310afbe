//! How far a log's time stamps lie off even steps.
//!
//! In: the rows' times, ascending. Out: the standard deviation of the stamps about even steps, seconds. A row that a
//! buffer or an operating system stamps late has another moment's label: of stamps with an exponential delay of 8 ms
//! labels of 0.5 Hz bending were 0.5 degrees off, said to be 0.07. Whether stamps are off or rows come unevenly can't
//! be seen in them, and a delay that all of them share neither.

use crate::median::median_of;

/// Rows that are compared with even steps of their own: drift and steps of another length between such stretches are no
/// scatter.
const STRETCH: usize = 32;
/// Rows that lie this near to whole steps, of a step, are rows of which others are lost; where stamps are off by more,
/// late ones and lost ones can't be told apart.
const WHOLE: f64 = 0.1;

/// The median over stretches of the SD about their line; 0 of fewer rows than a stretch has.
pub(in crate::align) fn scatter_s(times_s: &[f64]) -> f64 {
    let Some(step_s) = median_of(times_s.windows(2).map(|pair| pair[1] - pair[0])) else { return 0.0 };
    let scatter = |steps: &dyn Fn(&[f64]) -> f64| {
        let off = |times_s: &[f64]| {
            let places = times_s.windows(2).scan(0.0, |at, pair| {
                *at += steps(pair);
                Some(*at)
            });
            off_line_s(&std::iter::once(0.0).chain(places).zip(times_s.iter().copied()).collect::<Vec<_>>())
        };
        median_of(times_s.chunks_exact(STRETCH).map(off)).unwrap_or(0.0)
    };
    let of_whole_s = scatter(&|pair| ((pair[1] - pair[0]) / step_s).round().max(1.0));
    if of_whole_s <= WHOLE * step_s { of_whole_s } else { scatter(&|_| 1.0) }
}

/// The SD of times about the line through them, of rows at so many steps.
fn off_line_s(rows: &[(f64, f64)]) -> f64 {
    let (n, first_s) = (rows.len() as f64, rows[0].1);
    let middle = rows.iter().map(|(place, _)| place).sum::<f64>() / n;
    let mean_s = rows.iter().map(|(_, t)| t - first_s).sum::<f64>() / n;
    let rows = || rows.iter().map(|(place, t)| (place - middle, t - first_s - mean_s));
    let [along, across] = rows().fold([0.0, 0.0], |[x2, xy], (x, y)| [x2 + x * x, xy + x * y]);
    let step_s = across / along;
    let squares: f64 = rows().map(|(x, y)| (y - step_s * x).powi(2)).sum();
    (squares / (n - 2.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_rows_do_not_scatter_and_late_stamps_do() {
        let even: Vec<f64> = (0..1000).map(|k| 60.0 + 0.01 * f64::from(k)).collect();
        assert!(scatter_s(&even) < 1e-9 && scatter_s(&even[..20]) == 0.0);
        let lost: Vec<f64> = even.iter().copied().enumerate().filter(|(k, _)| k % 9 != 5).map(|(_, t)| t).collect();
        assert!(scatter_s(&lost) < 1e-9);
        // A bus that hands rows over every 16 ms: evenly between 0 and 16 ms late.
        let late: Vec<f64> = even.iter().map(|t| (t / 0.016).ceil() * 0.016).collect();
        assert!((scatter_s(&late) - 0.016 / 12.0_f64.sqrt()).abs() < 4e-4, "{}", scatter_s(&late));
    }
}
