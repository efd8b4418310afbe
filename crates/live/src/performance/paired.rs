//! Two methods held against each other by the same operators.

use serde::Serialize;

use crate::spread::Spread;

/// A method against the baseline, over operators who did both.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Paired {
    /// Operators who did both.
    pub n: usize,
    /// The mean of the operators' differences, method less baseline, in the values' unit.
    pub difference: f64,
    /// Their standard deviation, with n - 1; none of one operator.
    pub difference_sd: Option<f64>,
    /// The 95 % interval of the mean difference (Student's t).
    pub difference_interval: Option<[f64; 2]>,
    /// The method's mean over the baseline's, over these operators; none where the baseline's is zero.
    pub ratio_of_means: Option<f64>,
    /// Its standard error, by the operators' differences from it; none of one operator.
    pub ratio_of_means_se: Option<f64>,
    /// The geometric mean of the operators' own ratios; none where a value is zero.
    pub ratio: Option<f64>,
    /// Its 95 % interval (Student's t of the logarithms).
    pub ratio_interval: Option<[f64; 2]>,
}

impl Paired {
    /// Of `[baseline, method]` of each operator, none negative; none of no operator.
    #[must_use]
    pub fn of(pairs: &[[f64; 2]]) -> Option<Self> {
        let difference = Spread::of(pairs.iter().map(|[baseline, method]| method - baseline))?;
        let sum = |k: usize| pairs.iter().map(|pair| pair[k]).sum::<f64>();
        let [baseline, method] = [sum(0), sum(1)];
        let positive = pairs.iter().flatten().all(|value| *value > 0.0);
        let logarithms = || Spread::of(pairs.iter().map(|[baseline, method]| (method / baseline).ln()));
        let ratio = if positive { logarithms() } else { None };
        let of_means = (baseline > 0.0).then(|| method / baseline);
        let of_means_se = of_means.and_then(|of_means| {
            let off = Spread::of(pairs.iter().map(|[baseline, method]| method - of_means * baseline))?;
            Some(off.sd? * (pairs.len() as f64).sqrt() / baseline)
        });
        Some(Self {
            n: difference.n,
            difference: difference.mean,
            difference_sd: difference.sd,
            difference_interval: difference.interval(),
            ratio_of_means: of_means,
            ratio_of_means_se: of_means_se,
            ratio: ratio.map(|ratio| ratio.mean.exp()),
            ratio_interval: ratio.and_then(|ratio| Some(ratio.interval()?.map(f64::exp))),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spread::t_quantile;

    #[test]
    fn three_operators_by_hand() {
        // Differences -3, -4, -5; ratios 1/2, 1/3, 1/6, whose product is 1/36.
        let paired = Paired::of(&[[6.0, 3.0], [6.0, 2.0], [6.0, 1.0]]).unwrap();
        assert_eq!((paired.n, paired.difference, paired.difference_sd), (3, -4.0, Some(1.0)));
        let half = t_quantile(2).unwrap() / 3.0_f64.sqrt();
        let [low, high] = paired.difference_interval.unwrap();
        assert!((low + 4.0 + half).abs() <= 1e-14 && (high + 4.0 - half).abs() <= 1e-14);
        assert!((paired.ratio_of_means.unwrap() - 1.0 / 3.0).abs() <= 1e-15);
        // Less a third of the baseline 1, 0 and -1: standard deviation 1, over 6 by the root of 3.
        assert!((paired.ratio_of_means_se.unwrap() - 1.0 / 108.0_f64.sqrt()).abs() <= 1e-15);
        let ratio = 36.0_f64.powf(-1.0 / 3.0);
        assert!((paired.ratio.unwrap() - ratio).abs() <= 1e-15);
        let [low, high] = paired.ratio_interval.unwrap();
        assert!((low * high - ratio * ratio).abs() <= 1e-15 && low < ratio);
    }

    #[test]
    fn what_is_not_known_is_none() {
        assert_eq!(Paired::of(&[]), None);
        let one = Paired::of(&[[2.0, 1.0]]).unwrap();
        assert_eq!((one.n, one.difference_sd, one.difference_interval, one.ratio_interval), (1, None, None, None));
        assert_eq!((one.ratio, one.ratio_of_means, one.ratio_of_means_se), (Some(0.5), Some(0.5), None));
        let zero = Paired::of(&[[0.0, 1.0], [0.0, 0.0]]).unwrap();
        assert_eq!((zero.ratio, zero.ratio_of_means, zero.difference), (None, None, 0.5));
    }
}
