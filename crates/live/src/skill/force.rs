//! The force of one finger over time.

/// A time step of so many usual ones is a gap (assumed: two rows lost in a row are none, three are).
const GAP: f64 = 3.5;

/// A step that all but this share of itself fits is a whole one: stamps are rounded, those of a day's time to 1e-11 s.
const ROUNDED: f64 = 1e-3;

/// The share of the whole time that the sum of its steps may lack by rounding.
const SUMMED: f64 = 1e-9;

/// How many whole steps a time holds.
pub(super) fn whole_steps(time_s: f64, step_s: f64) -> f64 {
    (time_s / step_s + ROUNDED).floor()
}

/// The force with which a finger presses, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Force {
    /// Of each row, seconds, ascending.
    pub time_s: Vec<f64>,
    /// Newtons, pressing positive; NaN where it is not known.
    pub force_n: Vec<f64>,
    /// Rows of which something else (a gate) says that the finger does not touch: their force is not looked at. Empty
    /// where nothing says so.
    pub lifted: Vec<bool>,
}

/// What is known of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Row {
    /// It presses with so many newtons.
    Known(f64),
    /// It does not touch.
    Lifted,
    /// Nothing.
    Unknown,
}

impl Force {
    /// The usual time between two rows, seconds: the median; none of fewer than two rows.
    #[must_use]
    pub fn period_s(&self) -> Option<f64> {
        let mut steps: Vec<f64> = self.time_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|s| *s > 0.0).collect();
        let middle = steps.len() / 2;
        (!steps.is_empty()).then(|| *steps.select_nth_unstable_by(middle, f64::total_cmp).1)
    }

    /// The longest time between two rows that is no gap, seconds.
    #[must_use]
    pub fn longest_step_s(&self) -> f64 {
        self.period_s().map_or(0.0, |period_s| GAP * period_s)
    }

    pub(super) fn row(&self, row: usize) -> Row {
        match self.force_n[row] {
            _ if self.lifted.get(row).copied().unwrap_or(false) => Row::Lifted,
            force_n if force_n.is_finite() => Row::Known(force_n),
            _ => Row::Unknown,
        }
    }

    /// Pairs of neighbouring rows between which something is known: no gap lies between them, and neither is unknown.
    pub(super) fn steps(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let longest_s = self.longest_step_s();
        (1..self.time_s.len()).filter_map(move |row| {
            let step_s = self.time_s[row] - self.time_s[row - 1];
            let known = step_s <= longest_s && self.row(row - 1) != Row::Unknown && self.row(row) != Row::Unknown;
            known.then_some((row, step_s))
        })
    }

    /// The time of which it is known whether and how the finger presses, seconds.
    #[must_use]
    pub fn known_s(&self) -> f64 {
        self.steps().map(|(_, step_s)| step_s).sum()
    }

    /// The time between the first and the last row of which that is not known, seconds.
    #[must_use]
    pub fn unknown_s(&self) -> f64 {
        let whole_s = self.time_s.last().zip(self.time_s.first()).map_or(0.0, |(last, first)| last - first);
        let unknown_s = whole_s - self.known_s();
        if unknown_s > SUMMED * whole_s { unknown_s } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_and_unknown_rows_are_no_time() {
        let mut force = Force {
            time_s: [0.0, 0.1, 0.2, 0.3, 1.3, 1.4, 1.5].to_vec(),
            force_n: [0.0, 0.0, 1.0, 1.0, 1.0, f64::NAN, 0.0].to_vec(),
            lifted: Vec::new(),
        };
        assert!((force.period_s().unwrap() - 0.1).abs() <= 1e-12);
        assert!((force.known_s() - 0.3).abs() <= 1e-12 && (force.unknown_s() - 1.2).abs() <= 1e-12);
        // A gate knows what the force does not say.
        force.lifted = [false, false, false, false, false, true, true].to_vec();
        assert!((force.known_s() - 0.5).abs() <= 1e-12);
        let one = Force { time_s: vec![1.0], force_n: vec![1.0], lifted: Vec::new() };
        assert_eq!((one.period_s(), one.known_s(), one.unknown_s()), (None, 0.0, 0.0));
    }
}
