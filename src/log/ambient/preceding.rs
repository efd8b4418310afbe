//! The LED's own light of a stream: each lit sample less the unlit one before it, as in the thesis (3.1.2c).
//!
//! In: rows as they come. Out: lit rows, less the last unlit row before them. Nothing that comes later is needed, so
//! that a row can be answered at once; the price is that the ambient light is half a period of the LED old: of a ripple
//! of 1 Hz and 80 ms between unlit samples 50 % is left, where interpolation leaves 0.15 % ([`unlit`](super::unlit)).
//!
//! As there, never across a gap: an unlit row that is older than three usual times between unlit rows says nothing. The
//! usual time is the median of the last [`STEPS`]; before two unlit rows are known there is none, and any is taken.

use super::AmbientError;
use super::in_grains;
use super::rails::Rails;
use super::unlit::GAP_PERIODS;
use crate::median::median;

/// So many of the last times between unlit rows tell the usual one: assumed; a few lost rows don't move the median of
/// nine.
const STEPS: usize = 9;

/// What is said of it.
pub(crate) const RULE: &str = "from each lit row the unlit row before it is taken away (otherwise the unlit light of a \
                               file is interpolated at the row's own time)";

/// What is remembered of the rows before.
#[derive(Debug, Clone)]
pub(crate) struct Preceding {
    /// The last unlit row: when, and each channel's value, NaN where missing.
    at: f64,
    dark: Vec<f64>,
    /// The last times between unlit rows, and how many there have been.
    steps: [f64; STEPS],
    count: usize,
    rails: Option<Rails>,
}

impl Preceding {
    /// Of so many channels, and the range that can be recorded, where it is known.
    pub(crate) fn new(channels: usize, full_scale_v: Option<[f64; 2]>) -> Result<Self, AmbientError> {
        if let Some([low, high]) = full_scale_v {
            super::check_full_scale([low, high])?;
        }
        Ok(Self::of(full_scale_v.map(Rails::given), channels))
    }

    /// The same of a range that is one.
    pub(super) fn of(rails: Option<Rails>, channels: usize) -> Self {
        Self { at: f64::NAN, dark: vec![f64::NAN; channels], steps: [0.0; STEPS], count: 0, rails }
    }

    /// Forgets all: another recording begins.
    pub(crate) fn forget(&mut self) {
        (self.at, self.count) = (f64::NAN, 0);
        self.dark.fill(f64::NAN);
    }

    /// Takes an unlit row; `at` grows from row to row, and a row where it is NaN is passed over.
    pub(crate) fn unlit(&mut self, at: f64, values: &[f64]) {
        if at.is_nan() {
            return;
        }
        if at > self.at {
            self.steps[self.count % STEPS] = at - self.at;
            self.count += 1;
        }
        self.at = at;
        self.dark.copy_from_slice(values);
    }

    /// Takes the ambient light away from a lit row: NaN where it is not known. Returns whether a value is at the end of
    /// the range.
    pub(crate) fn lit(&self, at: f64, values: &mut [f64]) -> bool {
        // Of a row without time nothing is known.
        let known = at - self.at <= GAP_PERIODS * self.usual();
        let mut saturated = false;
        for (value, dark) in values.iter_mut().zip(&self.dark) {
            saturated |= self.rails.is_some_and(|rails| rails.reached(*value) || rails.reached(*dark));
            *value = if known { in_grains(*value - dark) } else { f64::NAN };
        }
        saturated
    }

    /// The usual time between unlit rows; infinite where it is not known yet.
    fn usual(&self) -> f64 {
        let mut steps = self.steps;
        median(&mut steps[..self.count.min(STEPS)]).unwrap_or(f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lit_row_is_less_the_unlit_row_before_it() {
        let mut preceding = Preceding::new(2, None).unwrap();
        let mut first = [3.0, 4.0];
        assert!(!preceding.lit(0.0, &mut first) && first.iter().all(|value| value.is_nan()));
        preceding.unlit(0.04, &[1.0, f64::NAN]);
        let mut next = [3.0, 4.0];
        preceding.lit(0.08, &mut next);
        assert!(next[0] == 2.0 && next[1].is_nan(), "{next:?}");
        preceding.unlit(0.12, &[1.5, 1.0]);
        let mut next = [3.0, 4.0];
        preceding.lit(0.16, &mut next);
        assert_eq!(next, [1.5, 3.0]);
    }

    #[test]
    fn an_old_unlit_row_says_nothing() {
        let mut preceding = Preceding::new(1, None).unwrap();
        for k in 0..5 {
            preceding.unlit(0.08 * f64::from(k), &[1.0]);
        }
        let lit = |at: f64| {
            let mut value = [3.0];
            preceding.lit(at, &mut value);
            value[0]
        };
        assert_eq!(lit(0.36), 2.0);
        // Three usual times of 0.08 s after the last, at 0.32 s.
        assert_eq!(lit(0.55), 2.0);
        assert!(lit(0.57).is_nan());
        let mut other = preceding.clone();
        other.forget();
        let mut value = [3.0];
        other.lit(0.36, &mut value);
        assert!(value[0].is_nan());
    }

    #[test]
    fn the_end_of_a_given_range_is_a_fault() {
        let mut preceding = Preceding::new(1, Some([0.0, 10.0])).unwrap();
        preceding.unlit(0.0, &[1.0]);
        assert!(preceding.lit(0.04, &mut [9.999]) && !preceding.lit(0.04, &mut [5.0]));
        preceding.unlit(0.08, &[10.0]);
        assert!(preceding.lit(0.12, &mut [5.0]));
        assert!(Preceding::new(1, Some([10.0, 0.0])).is_err());
    }
}
