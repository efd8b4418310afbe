//! A photodiode's output over the driving signal, averaged over cycles, rising and falling apart (Fig. 25, 28, 31, 34).
//!
//! The range is cut into bins of one width. Of each leg, the outputs and the driving values of a bin are averaged, and
//! the way from bin to bin is taken as straight; what that says at the bin's middle is the leg's value there. Mean and
//! SD (n - 1) are over legs. A bin in which a leg has no row is missing for that leg.

use super::cycles::Leg;

/// One place of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    /// The mean over legs.
    pub(crate) mean: f64,
    /// The standard deviation over legs; none of fewer than two.
    pub(crate) sd: Option<f64>,
    pub(crate) legs: usize,
}

/// What an output does over the driving signal.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Curve {
    /// The bins' middles, ascending.
    pub(crate) at: Vec<f64>,
    /// As the driving signal rises; none where no leg is known.
    pub(crate) rising: Vec<Option<Point>>,
    pub(crate) falling: Vec<Option<Point>>,
}

/// Legs of a recording, its driving signal and one output.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Source<'a> {
    /// Parts in which the driving signal rises or falls.
    pub(crate) legs: &'a [Leg],
    /// The driving signal.
    pub(crate) drive: &'a [f64],
    /// One value per row.
    pub(crate) output: &'a [f64],
}

impl Curve {
    /// Averages over the legs of all sources, in `bins` bins of `range`.
    #[must_use]
    pub(crate) fn of(sources: &[Source<'_>], [low, high]: [f64; 2], bins: usize) -> Self {
        let width = (high - low) / bins as f64;
        let at: Vec<f64> = (0..bins).map(|k| low + (k as f64 + 0.5) * width).collect();
        let mut legs: [Vec<Vec<Option<f64>>>; 2] = [Vec::new(), Vec::new()];
        for source in sources {
            for leg in source.legs {
                legs[usize::from(!leg.rising)].push(along(source, leg, &at, width));
            }
        }
        let [rising, falling] =
            legs.map(|legs| (0..bins).map(|k| over(legs.iter().filter_map(|leg| leg[k]))).collect());
        Self { at, rising, falling }
    }

    /// The middle between rising and falling where both are known: place and value.
    #[must_use]
    pub(crate) fn middle(&self) -> Vec<[f64; 2]> {
        let both = self.at.iter().zip(self.rising.iter().zip(&self.falling));
        both.filter_map(|(&at, (up, down))| Some([at, 0.5 * ((*up)?.mean + (*down)?.mean)])).collect()
    }
}

/// A leg's value at each bin's middle.
fn along(source: &Source<'_>, leg: &Leg, at: &[f64], width: f64) -> Vec<Option<f64>> {
    let mut sums = vec![[0.0_f64; 3]; at.len()];
    let low = at[0] - 0.5 * width;
    for row in leg.rows.clone() {
        let (drive, output) = (source.drive[row], source.output[row]);
        let bin = ((drive - low) / width).floor();
        if output.is_finite() && bin >= 0.0 && bin < at.len() as f64 {
            let sum = &mut sums[bin as usize];
            *sum = [sum[0] + 1.0, sum[1] + drive, sum[2] + output];
        }
    }
    let means: Vec<Option<[f64; 2]>> =
        sums.into_iter().map(|[n, drive, output]| (n > 0.0).then(|| [drive / n, output / n])).collect();
    let value = |k: usize| -> Option<f64> {
        let [x, y] = means[k]?;
        let toward = if at[k] >= x { k.checked_add(1) } else { k.checked_sub(1) };
        match toward.and_then(|next| *means.get(next)?) {
            Some([other_x, other_y]) if other_x != x => Some(y + (at[k] - x) * (other_y - y) / (other_x - x)),
            _ => Some(y),
        }
    };
    (0..at.len()).map(value).collect()
}

fn over(values: impl Iterator<Item = f64>) -> Option<Point> {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let sd = (values.len() > 1).then(|| (squares / (n - 1.0)).sqrt());
    (!values.is_empty()).then_some(Point { mean, sd, legs: values.len() })
}

#[cfg(test)]
mod tests {
    use super::super::cycles::Cycles;
    use super::*;
    use std::f64::consts::TAU;

    /// The curve of an output of row and drive over the first legs of five cycles.
    fn curve(legs: usize, bins: usize, output: impl Fn(usize, f64) -> f64) -> Curve {
        let time_s: Vec<f64> = (0..1250).map(|k| f64::from(k) / 12.5).collect();
        let drive: Vec<f64> = time_s.iter().map(|t| 2.0 * (TAU * 0.05 * t).cos()).collect();
        let output: Vec<f64> = drive.iter().enumerate().map(|(row, drive)| output(row, *drive)).collect();
        let mut cycles = Cycles::of(&time_s, &drive);
        cycles.legs.truncate(legs);
        Curve::of(&[Source { legs: &cycles.legs, drive: &drive, output: &output }], [-2.0, 2.0], bins)
    }

    #[test]
    fn a_straight_response_comes_back_straight_and_the_same_both_ways() {
        let curve = curve(10, 20, |_, drive| 1.0 + 0.3 * drive);
        for (k, &at) in curve.at.iter().enumerate() {
            let (up, down) = (curve.rising[k].unwrap(), curve.falling[k].unwrap());
            // At the ends, half a bin from what is known, it is off by up to that.
            let most = if (1..19).contains(&k) { 1e-9 } else { 0.02 };
            assert!((up.mean - 1.0 - 0.3 * at).abs() <= most && (up.mean - down.mean).abs() <= most, "{at}");
            assert_eq!((up.legs, down.legs), (5, 5));
        }
    }

    #[test]
    fn the_spread_over_cycles_is_found() {
        // Each cycle has an offset of its own.
        let curve = curve(10, 10, |row, drive| drive + [0.0, 0.1, -0.1, 0.2, -0.2][row / 250]);
        let sd = curve.rising[4].unwrap().sd.unwrap();
        assert!((sd - 0.025_f64.sqrt()).abs() < 2e-3, "{sd}");
    }

    #[test]
    fn missing_outputs_are_missing_and_one_leg_has_no_spread() {
        let curve = curve(1, 4, |_, drive| if drive > 1.0 { f64::NAN } else { drive });
        assert_eq!(curve.falling[3], None);
        assert_eq!(curve.falling[0].unwrap().sd, None);
        assert!(curve.rising.iter().all(Option::is_none) && curve.middle().is_empty());
    }
}
