//! Counters of rows: what was lost, came twice or late.

/// Rows that are so much behind the latest, or less, are late; more is a counter that was set back. The sixteen rows
/// over which logs are sorted too.
const LATE_ROWS: u64 = 16;

/// What a count says, after those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Count {
    /// The next, after so many that were lost.
    Next {
        /// Rows between it and the latest.
        lost: u64,
    },
    /// It came before.
    Again,
    /// Rows after it came already.
    Late,
    /// The counter began again.
    SetBack,
}

/// A counter that grows by one with each row and may begin again after 2^8, 2^16 or 2^32.
#[derive(Debug, Clone, Default)]
pub struct Counter {
    /// After which it begins again, where they are known.
    bits: Option<u32>,
    pub(crate) last: Option<u64>,
    /// Of the 64 counts up to the latest, which came; bit 0 is the latest.
    came: u64,
}

impl Counter {
    /// A counter of so many bits; of unknown width without.
    #[must_use]
    pub fn of_bits(bits: Option<u32>) -> Self {
        Self { bits: bits.filter(|bits| *bits < 64), ..Self::default() }
    }

    /// Begins at a count.
    pub fn set(&mut self, count: u64) {
        (self.last, self.came) = (Some(count), 1);
    }

    /// Reads a count; `rows` says how many rows fit into the time since the latest, by a clock, and `still` that the
    /// device's own clock did not advance.
    pub fn read(&mut self, count: u64, rows: Option<f64>, still: bool) -> Count {
        let Some(last) = self.last else {
            self.set(count);
            return Count::Next { lost: 0 };
        };
        if self.bits.is_some_and(|bits| count >> bits != 0) {
            self.bits = None;
        }
        let ahead = match self.bits {
            Some(bits) => Some(self.turned(count, last, bits, rows)),
            None if count >= last => Some(count - last),
            None => self.learned(count, last, rows),
        };
        let back = match self.bits {
            Some(bits) => last.wrapping_sub(count) & ((1 << bits) - 1),
            None => last.saturating_sub(count),
        };
        match ahead {
            Some(0) if still || rows.is_none() => Count::Again,
            // A counter that does not count.
            Some(0) => Count::Next { lost: 0 },
            Some(ahead) if fits(ahead, rows) || back > LATE_ROWS || back == 0 => self.on(count, ahead),
            _ if (1..=LATE_ROWS).contains(&back) => {
                if self.came >> back & 1 == 1 {
                    return Count::Again;
                }
                self.came |= 1 << back;
                Count::Late
            }
            _ => Count::SetBack,
        }
    }

    fn on(&mut self, count: u64, ahead: u64) -> Count {
        self.came = self.came.checked_shl(ahead.min(64) as u32).unwrap_or(0) | 1;
        self.last = Some(count);
        Count::Next { lost: ahead - 1 }
    }

    /// How many counts it went on, with as many turns as fit into the time.
    fn turned(&self, count: u64, last: u64, bits: u32, rows: Option<f64>) -> u64 {
        let turn = 1_u64 << bits;
        let ahead = count.wrapping_sub(last) & (turn - 1);
        let turns = rows.map_or(0.0, |rows| ((rows - ahead as f64) / turn as f64).round()).clamp(0.0, 1e6);
        (turns as u64).saturating_mul(turn).saturating_add(ahead)
    }

    /// How many counts it went on where it begins again after 8, 16 or 32 bits, if it does.
    fn learned(&mut self, count: u64, last: u64, rows: Option<f64>) -> Option<u64> {
        let bits = [8, 16, 32].into_iter().find(|&bits| {
            let turn = 1_u64 << bits;
            last < turn && {
                let ahead = turn - last + count;
                if rows.is_some() { fits(ahead, rows) } else { ahead <= turn / 8 }
            }
        })?;
        self.bits = Some(bits);
        Some((1 << bits) - last + count)
    }
}

/// Whether going on so many counts fits into the time for `rows`; a clock may be late by a few.
pub(super) fn fits(ahead: u64, rows: Option<f64>) -> bool {
    rows.is_none_or(|rows| (ahead as f64 - rows).abs() <= LATE_ROWS as f64 + rows / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_are_counted_over_the_end_of_any_width() {
        for bits in [8, 16, 32] {
            for declared in [None, Some(bits)] {
                let mut counter = Counter::of_bits(declared);
                let begin = (1_u64 << bits) - 100;
                let (mut lost, mut sent) = (0, 0);
                for n in 0..1000_u64 {
                    sent += 1;
                    // Runs of lost rows, up to 20 long.
                    if n % 50 > 30 && n % 3 != 0 && n < 990 {
                        continue;
                    }
                    let rows = Some(sent as f64);
                    sent = 0;
                    match counter.read((begin + n) % (1 << bits), rows, false) {
                        Count::Next { lost: now } => lost += now,
                        other => panic!("{bits} bits, row {n}: {other:?}"),
                    }
                }
                let skipped = (0..1000).filter(|n| n % 50 > 30 && n % 3 != 0 && *n < 990).count();
                assert_eq!((lost, counter.bits), (skipped as u64, Some(bits)));
            }
        }
    }

    #[test]
    fn whole_turns_are_lost_where_the_clock_says_so() {
        let mut counter = Counter::of_bits(Some(8));
        assert_eq!(counter.read(10, None, false), Count::Next { lost: 0 });
        assert_eq!(counter.read(10, Some(256.2), false), Count::Next { lost: 255 });
        assert_eq!(counter.read(15, Some(516.0), false), Count::Next { lost: 516 });
    }

    #[test]
    fn rows_that_come_twice_or_late_are_known() {
        for bits in [None, Some(16)] {
            let mut counter = Counter::of_bits(bits);
            let read: Vec<Count> =
                [5, 6, 6, 9, 7, 7, 8, 10].map(|n| counter.read(n, Some(1.0), true)).into_iter().collect();
            let (next, again, late) = (|lost| Count::Next { lost }, Count::Again, Count::Late);
            assert_eq!(read, [next(0), next(0), again, next(2), late, again, late, next(0)], "{bits:?}");
        }
    }

    #[test]
    fn a_counter_that_starts_again_is_no_wrap() {
        for (last, count) in [(1000, 0), (250, 3), (60_000, 0), (4_000_000_000, 2)] {
            let mut counter = Counter::default();
            counter.set(last);
            let read = counter.read(count, Some(1.0), false);
            // Six rows over the end of eight bits may be six lost ones.
            let expected = if last == 250 { Count::Next { lost: 8 } } else { Count::SetBack };
            assert_eq!(read, expected, "{last} to {count}");
        }
    }
}
