//! The middle and the ends of some numbers.

use std::cmp::Ordering;

/// The standard deviation of normal numbers over the median of their magnitudes.
pub(crate) const SD_OF_MAD: f64 = 1.4826;

/// A number that can be sorted; NaN comes last.
pub(crate) trait Number: Copy {
    fn order(&self, other: &Self) -> Ordering;
}

impl Number for f32 {
    fn order(&self, other: &Self) -> Ordering {
        self.total_cmp(other)
    }
}

impl Number for f64 {
    fn order(&self, other: &Self) -> Ordering {
        self.total_cmp(other)
    }
}

impl Number for usize {
    fn order(&self, other: &Self) -> Ordering {
        self.cmp(other)
    }
}

/// The middle one, of an even number the upper of both; `None` of none. The values are reordered.
pub(crate) fn median<T: Number>(values: &mut [T]) -> Option<T> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, T::order).1)
}

/// [`median`] of what an iterator gives.
pub(crate) fn median_of<T: Number>(values: impl IntoIterator<Item = T>) -> Option<T> {
    median(&mut values.into_iter().collect::<Vec<T>>())
}

/// The least and the greatest; NaN is passed over. Of none `[INFINITY, NEG_INFINITY]`.
pub(crate) fn ends(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    values.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], one| [low.min(one), high.max(one)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_upper_one_of_an_even_number() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median_of([4_usize, 1, 3, 2]), Some(3));
        assert_eq!(median_of([f32::NAN, -1.0, -2.0]), Some(-1.0));
        assert_eq!(median::<f64>(&mut []), None);
    }

    #[test]
    fn ends_of_numbers_pass_over_those_that_are_none() {
        assert_eq!(ends([2.0, f64::NAN, -1.0]), [-1.0, 2.0]);
        assert_eq!(ends([]), [f64::INFINITY, f64::NEG_INFINITY]);
    }
}
