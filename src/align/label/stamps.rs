//! How far a log's time stamps lie off even steps.
//!
//! In: the rows' times, ascending. Out: the standard deviation of the stamps about even steps, seconds. A row that a
//! buffer or an operating system stamps late has another moment's label: of stamps with an exponential delay of 8 ms
//! labels of 0.5 Hz bending were 0.5 degrees off, said to be 0.07. Whether stamps are off or rows come unevenly can't
//! be seen in them, and a delay that all of them share neither.

use crate::median::median_of;

/// Rows that are compared with even steps of their own: drift and steps of another length between such stretches are no
/// scatter, and one lost row is in one of them.
const STRETCH: usize = 32;

/// The median over stretches of the SD about their line; 0 of fewer rows than a stretch has.
pub(in crate::align) fn scatter_s(times_s: &[f64]) -> f64 {
    median_of(times_s.chunks_exact(STRETCH).map(off_line_s)).unwrap_or(0.0)
}

/// The SD of times about the line through them.
fn off_line_s(times_s: &[f64]) -> f64 {
    let (n, first_s) = (times_s.len() as f64, times_s[0]);
    let middle = 0.5 * (n - 1.0);
    let mean_s = times_s.iter().map(|t| t - first_s).sum::<f64>() / n;
    let rows = || times_s.iter().enumerate().map(|(k, t)| (k as f64 - middle, t - first_s - mean_s));
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
        let lost: Vec<f64> = even.iter().copied().enumerate().filter(|(k, _)| k % 97 != 5).map(|(_, t)| t).collect();
        assert!(scatter_s(&lost) < 1e-9);
        // A bus that hands rows over every 16 ms: evenly between 0 and 16 ms late.
        let late: Vec<f64> = even.iter().map(|t| (t / 0.016).ceil() * 0.016).collect();
        assert!((scatter_s(&late) - 0.016 / 12.0_f64.sqrt()).abs() < 4e-4, "{}", scatter_s(&late));
    }
}
