//! The straight line through pairs of angles that both have errors.
//!
//! Deming's regression (1943; Fuller 1987, doi:10.1002/9780470316665, section 1.3): the line whose distances, in both
//! angles' mean standard errors, have the least sum of squares. Rows are fed one after the other; no row is kept.

use crate::posture::Angle;

/// Sums of the pairs, centred as they come (Welford 1962, doi:10.1080/00401706.1962.10490022).
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pairs {
    pub(super) count: u64,
    mean: [f64; 2],
    /// Sums of squares and products: xx, xy, yy.
    squares: [f64; 3],
    variances: [f64; 2],
}

/// y = intercept + slope x, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CouplingLine {
    /// Pairs of angles.
    pub count: u64,
    /// Degrees of y for one of x.
    pub slope: f64,
    /// y where x is 0.
    pub intercept_deg: f64,
    /// Pearson's correlation.
    pub correlation: f64,
}

impl Pairs {
    pub(super) fn push(&mut self, x: Angle, y: Angle) {
        self.count += 1;
        let n = self.count as f64;
        let value = [x.rad.to_degrees(), y.rad.to_degrees()];
        let before = [value[0] - self.mean[0], value[1] - self.mean[1]];
        self.mean = [self.mean[0] + before[0] / n, self.mean[1] + before[1] / n];
        let after = [value[0] - self.mean[0], value[1] - self.mean[1]];
        self.squares[0] += before[0] * after[0];
        self.squares[1] += before[0] * after[1];
        self.squares[2] += before[1] * after[1];
        self.variances[0] += x.sd_rad * x.sd_rad;
        self.variances[1] += y.sd_rad * y.sd_rad;
    }

    /// None where fewer than three pairs, or pairs without a spread, tell no line; none either where it stands upright.
    pub(super) fn line(&self) -> Option<CouplingLine> {
        let [xx, xy, yy] = self.squares;
        // Rounding leaves some spread to angles that are all the same.
        let least = 1e-18 * self.count as f64 * (1.0 + self.mean[0].abs() + self.mean[1].abs()).powi(2);
        if self.count < 3 || xx <= least {
            return None;
        }
        // The variance of y's errors over that of x's; angles without errors are alike.
        let ratio = self.variances[1] / self.variances[0];
        let ratio = if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 };
        let apart = yy - ratio * xx;
        let root = apart.hypot(2.0 * ratio.sqrt() * xy);
        // Of both forms of the root, the one without cancellation.
        let slope = if apart >= 0.0 { (apart + root) / (2.0 * xy) } else { 2.0 * ratio * xy / (root - apart) };
        let correlation = if yy > least { xy / (xx * yy).sqrt() } else { 0.0 };
        slope.is_finite().then(|| CouplingLine {
            count: self.count,
            slope,
            intercept_deg: self.mean[1] - slope * self.mean[0],
            correlation,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::normals;

    fn angle(deg: f64, sd_deg: f64) -> Angle {
        Angle { rad: deg.to_radians(), sd_rad: sd_deg.to_radians(), lasting_sd_rad: 0.0 }
    }

    #[test]
    fn an_exact_line_is_found() {
        let mut pairs = Pairs::default();
        for k in 0..100 {
            let x = f64::from(k) - 10.0;
            pairs.push(angle(x, 0.1), angle(3.0 - 0.45 * x, 0.3));
        }
        let line = pairs.line().unwrap();
        // Measured 1e-16 and 2e-14.
        assert!((line.slope + 0.45).abs() <= 1e-12 && (line.intercept_deg - 3.0).abs() <= 1e-11);
        assert!((line.correlation + 1.0).abs() <= 1e-12 && line.count == 100);
    }

    #[test]
    fn errors_of_both_angles_do_not_flatten_the_line() {
        let mut normal = normals(1);
        let (mut pairs, mut flat) = (Pairs::default(), [0.0; 2]);
        for k in 0..20_000 {
            let x = 10.0 * (f64::from(k) * 0.01).sin();
            let seen = [x + 5.0 * normal(), 0.7 * x + 10.0 * normal()];
            flat = [flat[0] + seen[0] * seen[1], flat[1] + seen[0] * seen[0]];
            pairs.push(angle(seen[0], 5.0), angle(seen[1], 10.0));
        }
        let line = pairs.line().unwrap();
        // The standard error is 0.013; measured 0.0001. The line of least squares in y alone: 0.47.
        assert!((line.slope - 0.7).abs() <= 0.04, "{}", line.slope);
        assert!(flat[0] / flat[1] < 0.5);
    }

    #[test]
    fn pairs_without_a_line_have_none() {
        assert_eq!(Pairs::default().line(), None);
        let mut constant = Pairs::default();
        let mut level = Pairs::default();
        let mut upright = Pairs::default();
        for k in 0..50 {
            constant.push(angle(37.1, 0.1), angle(12.3, 0.1));
            level.push(angle(f64::from(k), 0.1), angle(12.3, 0.1));
            upright.push(angle(12.3, 0.1), angle(f64::from(k), 0.1));
        }
        assert_eq!((constant.line(), upright.line()), (None, None));
        let line = level.line().unwrap();
        assert!(line.slope.abs() <= 1e-12 && line.correlation.abs() <= 1e-6, "{line:?}");
        let mut exact = Pairs::default();
        (0..5).for_each(|k| exact.push(angle(f64::from(k), 0.0), angle(2.0 * f64::from(k), 0.0)));
        assert!((exact.line().unwrap().slope - 2.0).abs() <= 1e-12, "angles without errors");
    }
}
