//! The time from row to row.
//!
//! In: steps between rows, and the resolution of the clock that gave them. Out: the mean of the steps that are no gaps,
//! which a coarse clock does not bias, as it does their median: of 700 rows a second a clock of whole milliseconds has
//! steps of one and of two.

/// So many steps are looked at together.
const STEPS: usize = 32;

/// The mean is of so many steps at most, then older ones count half.
const MOST_STEPS: f64 = 1024.0;

/// A longer step holds lost rows, in periods.
const LOST_PERIODS: f64 = 1.5;

/// Rows may be later by so many ticks of a coarse clock; the tenth is for a mean of 32 steps, known to 1/32 tick.
const TICKS: f64 = 1.1;

/// A clock ticks with the rows where 32 steps are the same to this part: a step of two ticks is then a lost row. Of 950
/// rows a second and whole milliseconds 30 or 31 of 32 are (*measured*); 970 and more look like 1000.
const SAME_PART: f64 = 0.01;

/// A mean of 32 steps that differs from that before by this part, beyond what the resolution does, is another rate
/// (*assumed*).
const OTHER_PART: f64 = 0.1;

/// The mean step between rows, without gaps; nothing is allocated.
#[derive(Debug, Clone, Default)]
pub struct Period {
    steps_s: [f64; STEPS],
    filled: usize,
    /// The clock's resolution, seconds; zero where it is not known.
    resolution_s: f64,
    /// The step that nearly all are, where the clock ticks with the rows.
    even_s: Option<f64>,
    sum_s: f64,
    count: f64,
    /// The mean step, seconds; none before three steps.
    pub(crate) mean_s: Option<f64>,
}

impl Period {
    /// Adds a step, seconds, and what the clock's resolution is so far. A step that is not positive says nothing, but
    /// that several rows fall into a tick where rows are as dense.
    pub fn push(&mut self, step_s: f64, resolution_s: f64) {
        self.resolution_s = resolution_s;
        if step_s.is_nan() || step_s < 0.0 || step_s == 0.0 && resolution_s == 0.0 {
            return;
        }
        self.steps_s[self.filled] = step_s;
        self.filled += 1;
        // The first mean early, later ones of whole blocks.
        if self.filled == STEPS {
            self.learn();
            self.filled = 0;
        } else if self.mean_s.is_none() && self.filled >= 3 {
            self.mean_s = self.block().map(|(sum_s, count)| sum_s / count);
        }
    }

    /// The longest step in which no row is lost, seconds; none before the period is known.
    #[must_use]
    pub fn longest_s(&self) -> Option<f64> {
        self.mean_s.map(|mean_s| self.reach_s(mean_s))
    }

    fn reach_s(&self, period_s: f64) -> f64 {
        let ticks = if self.even_s.is_some() { 0.0 } else { TICKS };
        (LOST_PERIODS * period_s).max(period_s + ticks * self.resolution_s)
    }

    /// Adds a whole block to the mean, or begins with it where the rate is another.
    fn learn(&mut self) {
        let steps_s = self.steps_s;
        self.even_s = median(&steps_s).filter(|&median_s| {
            let same = |other_s: f64| (other_s - median_s).abs() <= SAME_PART * median_s;
            steps_s.iter().all(|step_s| same(*step_s)) || self.even_s.is_some_and(same)
        });
        let Some((sum_s, count)) = self.block() else { return };
        let block_s = sum_s / count;
        let most_s = OTHER_PART * block_s + 2.0 * self.resolution_s / STEPS as f64;
        if self.count == 0.0 || (block_s - self.sum_s / self.count).abs() > most_s {
            (self.sum_s, self.count) = (0.0, 0.0);
        }
        self.sum_s += sum_s;
        self.count += count;
        self.mean_s = Some(self.sum_s / self.count);
        if self.count > MOST_STEPS {
            self.sum_s /= 2.0;
            self.count /= 2.0;
        }
    }

    /// The sum of the steps that are no gaps, and how many they are; none where no step is positive.
    fn block(&self) -> Option<(f64, f64)> {
        let mut sorted = self.steps_s;
        let mut steps_s = &mut sorted[..self.filled];
        steps_s.sort_unstable_by(f64::total_cmp);
        let still = steps_s.partition_point(|step_s| *step_s <= 0.0);
        // Longer ones are rows that came twice, not rows in one tick.
        if steps_s.get(still)? > &(LOST_PERIODS * self.resolution_s) {
            steps_s = &mut steps_s[still..];
        }
        let within = |most_s: f64| {
            let count = steps_s.partition_point(|step_s| *step_s <= most_s);
            (steps_s[..count].iter().sum::<f64>(), count as f64)
        };
        let (sum_s, count) = within(self.reach_s(steps_s[steps_s.len() / 2]));
        // Once more: the median may be a tick away from the mean.
        Some(within(self.reach_s(sum_s / count)))
    }
}

fn median(steps_s: &[f64; STEPS]) -> Option<f64> {
    let mut sorted = *steps_s;
    sorted.sort_unstable_by(f64::total_cmp);
    Some(sorted[STEPS / 2]).filter(|median_s| *median_s > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_and_repeats_do_not_move_the_mean() {
        for resolution_s in [0.0, 1e-6] {
            let mut period = Period::default();
            assert_eq!(period.mean_s, None);
            for row in 0..1000 {
                period.push(if row % 7 == 0 { 5.0 } else { 0.001 }, resolution_s);
                period.push(0.0, resolution_s);
                period.push(f64::NAN, resolution_s);
            }
            assert!((period.mean_s.unwrap() - 0.001).abs() <= 1e-12, "{period:?}");
        }
    }

    #[test]
    fn a_clock_of_whole_milliseconds_does_not_bias_the_rate() {
        for rate_hz in [5.0, 60.0, 150.0, 300.0, 400.0, 600.0, 700.0, 800.0, 900.0, 950.0, 1000.0, 2000.0, 4000.0] {
            let mut period = Period::default();
            let mut last_ms = 0.0;
            for row in 1..4000 {
                let ms = (f64::from(row) * 1e3 / rate_hz).floor();
                let step_s = (ms - last_ms) / 1e3;
                last_ms = ms;
                assert!(period.longest_s().is_none_or(|longest_s| step_s <= longest_s), "{rate_hz}, {row}");
                period.push(step_s, 1e-3);
            }
            let found_hz = period.mean_s.unwrap().recip();
            // The worst is that of 2000 rows a second: 0.2 %.
            assert!((found_hz / rate_hz - 1.0).abs() <= 0.005, "{rate_hz}: {found_hz}");
        }
    }

    #[test]
    fn another_rate_is_learned_at_once() {
        let mut period = Period::default();
        (0..1000).for_each(|_| period.push(0.01, 1e-6));
        (0..64).for_each(|_| period.push(0.005, 1e-6));
        assert!((period.mean_s.unwrap() - 0.005).abs() <= 1e-12, "{period:?}");
    }
}
