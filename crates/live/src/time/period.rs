//! The time from row to row.

/// So many steps are looked at together.
const STEPS: usize = 32;

/// The median step between rows, of the latest 32 or more; nothing is allocated.
#[derive(Debug, Clone, Default)]
pub struct Period {
    steps_s: [f64; STEPS],
    filled: usize,
    /// The median step, seconds; none before three steps.
    pub(crate) median_s: Option<f64>,
}

impl Period {
    /// Adds a step, seconds; one that is not positive says nothing.
    pub fn push(&mut self, step_s: f64) {
        if step_s.is_nan() || step_s <= 0.0 {
            return;
        }
        self.steps_s[self.filled] = step_s;
        self.filled += 1;
        // The first median early, later ones of whole blocks.
        if self.filled == STEPS || self.median_s.is_none() && self.filled == 3 {
            let mut sorted = self.steps_s;
            let sorted = &mut sorted[..self.filled];
            sorted.sort_unstable_by(f64::total_cmp);
            self.median_s = Some(sorted[self.filled / 2]);
        }
        if self.filled == STEPS {
            self.filled = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_and_repeats_do_not_move_the_median() {
        let mut period = Period::default();
        assert_eq!(period.median_s, None);
        for row in 0..1000 {
            period.push(if row % 7 == 0 { 5.0 } else { 0.001 });
            period.push(0.0);
            period.push(f64::NAN);
        }
        assert_eq!(period.median_s, Some(0.001));
    }
}
