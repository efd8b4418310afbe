//! How much an explanation is worth, given how few independent samples there are.

/// What is known of a model before any lag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Judge {
    /// Seconds that count as one independent sample.
    pub(super) each_s: f64,
    /// Its free numbers, without the mean.
    pub(super) free: f64,
}

impl Judge {
    /// Independent samples that are left for an error, of an overlap.
    pub(super) fn samples(&self, overlap_s: f64) -> f64 {
        (overlap_s / self.each_s - 1.0 - self.free).max(0.0)
    }

    /// Twice how much an explanation raises the logarithm of the likelihood, less its free numbers; `left` is the
    /// logarithm of the share that it leaves over.
    pub(super) fn gain(&self, overlap_s: f64, left: f64) -> f64 {
        -self.samples(overlap_s) * left - self.free
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_numbers_cost_and_few_samples_prove_nothing() {
        let judge = Judge { each_s: 2.0, free: 5.0 };
        assert_eq!((judge.samples(60.0), judge.samples(8.0)), (24.0, 0.0));
        assert!(judge.gain(60.0, -3.0) > 60.0 && judge.gain(8.0, -9.0) < 0.0 && judge.gain(60.0, -0.1) < 0.0);
    }
}
