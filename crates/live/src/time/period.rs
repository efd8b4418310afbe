//! The time from row to row.
//!
//! In: steps between rows, and the resolution of the clock that gave them. Out: the mean of the steps that are no gaps,
//! which a coarse clock does not bias, as it does their median: of 700 rows a second a clock of whole milliseconds has
//! steps of one and of two.
//!
//! Rows of one stamp share a tick of the clock where it ticks about as fast as they come; otherwise they were stamped
//! together, as a packet, and the mean step is by their number.

use std::ops::RangeInclusive;

/// So many steps are looked at together.
const STEPS: usize = 32;

/// The mean is of so many steps at most, then older ones count half.
const MOST_STEPS: f64 = 1024.0;

/// A longer step holds lost rows, in periods: one and a half, and as much more as the mean may be off, since that of a
/// late row among 500 a second in whole milliseconds is just that.
const LOST_PERIODS: f64 = 1.52;

/// Rows may be later by so many ticks of a coarse clock; the tenth is for a mean of 32 steps, known to 1/32 tick.
const TICKS: f64 = 1.1;

/// A clock ticks with the rows where 32 steps are the same to this part: a step of two ticks is then a lost row. Of 950
/// rows a second and whole milliseconds 30 or 31 of 32 are (*measured*); 970 and more look like 1000.
const SAME_PART: f64 = 0.01;

/// A mean of 32 steps that differs from that before by this part, beyond what the resolution does, is another rate
/// (*assumed*).
const OTHER_PART: f64 = 0.1;

/// After a step that is shorter than the others by a tick, as of a row that shares one, a clock does not tick with the
/// rows for so many blocks of 32 steps: as many as the mean is of.
const UNEVEN_BLOCKS: u32 = 32;

/// Rows of one stamp share its tick where the step before it has so many ticks at most: where rows come as fast as
/// ticks, one that is late by jitter has two before it and none behind it. Otherwise they are a packet.
const SHARED_TICKS: f64 = 2.5;

/// Packets are looked at together until they have so many rows (*assumed*), of which one more or less hardly counts.
const PACKET_ROWS: u32 = 32;

/// Other steps say nothing of a period, seconds (*assumed*).
const PERIODS_S: RangeInclusive<f64> = 1e-9..=1e9;

/// The mean step between rows, without gaps; nothing is allocated.
#[derive(Debug, Clone, Default)]
pub struct Period {
    steps_s: [f64; STEPS],
    filled: usize,
    /// The latest, and how many rows the one before it had.
    stamp: Stamp,
    rows_before: u32,
    /// Where rows are stamped together.
    packets: Option<Packets>,
    rows_of_packet: f64,
    uneven_blocks: u32,
    /// The clock's resolution, seconds; zero where it is not known.
    resolution_s: f64,
    /// The step that nearly all are, where the clock ticks with the rows.
    even_s: Option<f64>,
    sum_s: f64,
    count: f64,
    /// The mean step, seconds; none before three steps.
    pub(crate) mean_s: Option<f64>,
}

/// The step before a stamp, seconds, and how many rows have it.
#[derive(Debug, Clone, Copy, Default)]
struct Stamp {
    step_s: f64,
    rows: u32,
}

/// Stamps that are looked at together.
#[derive(Debug, Clone, Default)]
struct Packets {
    long_s: f64,
    rows: u32,
    stamps: u32,
}

impl Period {
    /// Adds the step to a row, seconds, and what the clock's resolution is so far; of 0 where the row has the stamp of
    /// the one before it.
    pub fn push(&mut self, step_s: f64, resolution_s: f64) {
        self.resolution_s = resolution_s;
        if step_s == 0.0 {
            self.share();
        } else if step_s > 0.0 {
            self.packed();
            self.rows_before = self.stamp.rows;
            self.stamp = Stamp { step_s, rows: 1 };
            if self.packets.is_none() && PERIODS_S.contains(&step_s) {
                self.add(step_s);
            }
        }
    }

    /// A row has the stamp of the one before it.
    fn share(&mut self) {
        if self.stamp.rows == 0 {
            return;
        }
        self.stamp.rows = self.stamp.rows.saturating_add(1);
        if self.packets.is_some() {
            return;
        }
        if !self.is_packet() {
            self.add(0.0);
        } else {
            // Its step is that of all its rows.
            self.filled = self.filled.saturating_sub(1);
            self.packets = Some(Packets::default());
        }
    }

    /// The latest stamp has all its rows.
    fn packed(&mut self) {
        let Some(packets) = self.packets.as_mut().filter(|_| PERIODS_S.contains(&self.stamp.step_s)) else { return };
        packets.long_s += self.stamp.step_s;
        packets.rows = packets.rows.saturating_add(self.stamp.rows);
        packets.stamps += 1;
        if packets.rows < PACKET_ROWS {
            return;
        }
        let Packets { long_s, rows, stamps } = *packets;
        self.packets = (rows > stamps).then(Packets::default);
        self.rows_of_packet = f64::from(rows) / f64::from(stamps);
        self.add(long_s / f64::from(rows));
    }

    fn add(&mut self, step_s: f64) {
        // Lost rows make none shorter.
        if self.mean_s.is_some_and(|mean_s| step_s < mean_s - 0.5 * self.resolution_s) {
            (self.even_s, self.uneven_blocks) = (None, UNEVEN_BLOCKS);
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

    /// Whether rows of the latest stamp share no tick, and were stamped together where they are several.
    #[must_use]
    pub fn is_packet(&self) -> bool {
        self.stamp.step_s > SHARED_TICKS * self.resolution_s
    }

    /// The mean step from stamp to stamp, seconds: that from row to row, but where rows are stamped together.
    #[must_use]
    pub fn of_stamps_s(&self) -> Option<f64> {
        let rows = if self.packets.is_some() { self.rows_of_packet.max(1.0) } else { 1.0 };
        self.mean_s.map(|mean_s| rows * mean_s)
    }

    /// How many rows are lost before the latest stamp, by the rows that have it so far.
    #[must_use]
    pub fn lost(&self) -> u64 {
        let (Some(mean_s), step_s) = (self.mean_s, self.stamp.step_s) else { return 0 };
        // Packets are stamped behind their rows or before them, and a row may just have missed its own.
        let (rows, missed_s) = match &self.packets {
            Some(_) => (self.stamp.rows.max(self.rows_before), mean_s),
            None => (1, 0.0),
        };
        if step_s <= self.reach_s(f64::from(rows) * mean_s) + missed_s {
            return 0;
        }
        ((step_s / mean_s).round() as u64).saturating_sub(rows.into())
    }

    fn reach_s(&self, period_s: f64) -> f64 {
        let ticks = if self.even_s.is_some() { 0.0 } else { TICKS };
        (LOST_PERIODS * period_s).max(period_s + ticks * self.resolution_s)
    }

    /// Adds a whole block to the mean, or begins with it where the rate is another.
    fn learn(&mut self) {
        let steps_s = self.steps_s;
        self.uneven_blocks = self.uneven_blocks.saturating_sub(1);
        self.even_s = median(&steps_s).filter(|&median_s| {
            let same = |other_s: f64| (other_s - median_s).abs() <= SAME_PART * median_s;
            self.uneven_blocks == 0 && (steps_s.iter().all(|step_s| same(*step_s)) || self.even_s.is_some_and(same))
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
        let shortest_s = *steps_s.get(still)?;
        // The clock's resolution has become finer since: they shared no tick.
        if shortest_s > SHARED_TICKS * self.resolution_s {
            steps_s = &mut steps_s[still..];
        }
        // Of ticks that more than half of the rows share the median is 0.
        let within = |most_s: f64| {
            let count = steps_s.partition_point(|step_s| *step_s <= most_s.max(shortest_s));
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
    use proptest::collection::vec;
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    #[test]
    fn gaps_do_not_move_the_mean() {
        for resolution_s in [0.0, 1e-6] {
            let mut period = Period::default();
            assert_eq!(period.mean_s, None);
            for row in 0..1000 {
                period.push(if row % 7 == 0 { 5.0 } else { 0.001 }, resolution_s);
                period.push(-0.0005, resolution_s);
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
                period.push(step_s, 1e-3);
                assert_eq!(period.lost(), 0, "{rate_hz}, {row}");
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

    #[test]
    fn rows_that_are_stamped_together_count() {
        for (least, most) in [(2, 2), (1, 2), (1, 3), (2, 6), (8, 8), (50, 50)] {
            // Stamped behind their rows, or before them; and once ten seconds are missing.
            for before in [false, true] {
                let mut random = ChaCha8Rng::seed_from_u64(1);
                let mut period = Period::default();
                let (mut rows, mut lost) = (1, 0);
                for packet in 0..20_000 / most {
                    let next = random.random_range(least..=most);
                    let gap_s = if packet == 15_000 / most { 10.0 } else { 0.0 };
                    let step_s = 0.004 * f64::from(if before { rows } else { next }) + gap_s;
                    rows = next;
                    period.push(step_s, 1e-6);
                    (1..rows).for_each(|_| period.push(0.0, 1e-6));
                    lost += period.lost();
                }
                let found = 0.004 / period.mean_s.unwrap();
                println!("{least} to {most}, {before}: {found:.4}, {lost} lost");
                // The worst is that of 50 rows, stamped before them, of which ten seconds are missing: 0.26 %.
                assert!((found - 1.0).abs() <= if before { 0.004 } else { 1e-9 }, "{least} to {most}: {found}");
                assert!((lost as f64 / 2500.0 - 1.0).abs() <= 0.005, "{least} to {most}: {lost}");
                assert!(period.of_stamps_s().unwrap() >= 0.004 * f64::from(least) * 0.9);
            }
        }
    }

    /// Equal, back, tiny and huge.
    fn any_step() -> impl Strategy<Value = f64> {
        prop_oneof![Just(0.0), 0.0..3e-3, Just(1e-3), Just(2e-3), Just(5e-324), -1e300..1e300]
    }

    proptest! {
        #[test]
        fn no_steps_make_a_period_of_nothing(
            steps_s in vec(any_step(), 1..300),
            resolution_s in prop_oneof![Just(0.0), Just(1e-3), Just(1e-6), Just(1.0)],
        ) {
            let mut period = Period::default();
            for step_s in steps_s {
                period.push(step_s, resolution_s);
                prop_assert!(period.mean_s.is_none_or(|mean_s| mean_s > 0.0 && mean_s.is_finite()), "{:?}", period);
                let _ = period.lost();
            }
        }
    }
}
