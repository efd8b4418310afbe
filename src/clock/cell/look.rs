//! What a digit's cell looks like, as a vector that is independent of brightness.
//!
//! In: a crop and a cell's box in it. Out: a [`Look`]: the means of the luma over a grid of equal shares of the box,
//! less their own mean. Two looks are compared up to a gain, so that neither a light that flickers nor one that drifts
//! is seen.
//!
//! OpenCV's `resize` takes whole samples: at the nearest ones its look is 0.44 from ours at the box itself, in 2 to
//! 6 against 3 µs (`cargo test --lib opencv_looks -- --nocapture`).

use crate::clock::ink::crop::Gray;
use crate::clock::ink::pieces::Piece;

/// Columns and rows of the grid.
pub(in crate::clock) const COLUMNS: usize = 12;
pub(in crate::clock) const ROWS: usize = 18;
/// Cells of the grid.
pub(in crate::clock) const CELLS: usize = COLUMNS * ROWS;

/// A box in a crop: left, top, width, height, in samples from the top-left corner of the first one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::clock) struct Cut {
    pub(in crate::clock) left: f32,
    pub(in crate::clock) top: f32,
    pub(in crate::clock) width: f32,
    pub(in crate::clock) height: f32,
}

impl Cut {
    pub(in crate::clock) fn around(ink: &Piece) -> Self {
        Self { left: ink.left as f32, top: ink.top as f32, width: ink.width() as f32, height: ink.height() as f32 }
    }
}

/// A digit's look.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::clock) struct Look {
    pub(in crate::clock) values: [f32; CELLS],
    /// The length of `values`.
    pub(in crate::clock) norm: f32,
}

/// The share of each sample in one grid line: the first sample, and weights that add up to 1.
fn shares(start: f32, length: f32, parts: usize, samples: usize) -> Vec<(usize, Vec<f32>)> {
    let step = length / parts as f32;
    let last = samples.saturating_sub(1);
    (0..parts)
        .map(|part| {
            let (from, to) = (start + part as f32 * step, start + (part + 1) as f32 * step);
            // What lies outside of the crop continues its border.
            let first = (from.floor().max(0.0) as usize).min(last);
            let end = ((to.ceil() - 1.0).max(0.0) as usize).clamp(first, last);
            let mut weights: Vec<f32> =
                (first..=end).map(|sample| (to.min(sample as f32 + 1.0) - from.max(sample as f32)).max(0.0)).collect();
            let sum: f32 = weights.iter().sum();
            if sum > 0.0 {
                weights.iter_mut().for_each(|weight| *weight /= sum);
            } else {
                weights[0] = 1.0;
            }
            (first, weights)
        })
        .collect()
}

impl Look {
    /// The look of a box.
    pub(in crate::clock) fn cut(gray: &Gray, cut: Cut) -> Self {
        let mut values = [0.0; CELLS];
        if gray.width > 0 && gray.height > 0 {
            let across = shares(cut.left, cut.width, COLUMNS, gray.width);
            let down = shares(cut.top, cut.height, ROWS, gray.height);
            for ((first, weights), into) in down.iter().zip(values.chunks_exact_mut(COLUMNS)) {
                for (y, &weight) in (*first..).zip(weights) {
                    let row = gray.row(y);
                    for ((x, shares), value) in across.iter().zip(into.iter_mut()) {
                        let mean: f32 = row[*x..].iter().zip(shares).map(|(sample, share)| sample * share).sum();
                        *value += weight * mean;
                    }
                }
            }
        }
        Self::of(values)
    }

    /// From values that need not have mean 0.
    pub(in crate::clock) fn of(mut values: [f32; CELLS]) -> Self {
        let mean = values.iter().sum::<f32>() / CELLS as f32;
        values.iter_mut().for_each(|value| *value -= mean);
        let norm = dot(&values, &values).sqrt();
        Self { values, norm }
    }

    /// How far another look is from this one, once it has this one's gain, as a share of this one's length: 0 for the
    /// same look, about 1 for another digit, and more than 1 for its negative.
    pub(in crate::clock) fn distance(&self, other: &Self) -> f32 {
        let product = dot(&self.values, &other.values) / (self.norm * other.norm).max(1e-6);
        (2.0 - 2.0 * product).max(0.0).sqrt()
    }
}

pub(in crate::clock) fn dot(a: &[f32; CELLS], b: &[f32; CELLS]) -> f32 {
    // Eight sums side by side, so that they can be added at once.
    let mut sums = [0.0; 8];
    for (a, b) in a.chunks_exact(8).zip(b.chunks_exact(8)) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    sums.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_look_is_the_means_over_shares_of_the_box_whatever_gain_and_offset() {
        // A ramp across: the mean over a share is its middle's value.
        let ramp = |gain: f32, offset: f32| Gray {
            width: 40,
            height: 30,
            values: (0..1200).map(|k| offset + gain * (k % 40) as f32).collect(),
        };
        let cut = Cut { left: 4.3, top: 2.0, width: 18.0, height: 24.0 };
        let look = Look::cut(&ramp(2.0, 10.0), cut);
        for (k, value) in look.values.iter().enumerate() {
            let expected = 2.0 * 1.5 * ((k % COLUMNS) as f32 - 5.5);
            // Partial samples count by their share: 0.42 off at most on a ramp of 2.
            assert!((value - expected).abs() <= 0.45, "{k} {value} {expected}");
        }
        let other = Look::cut(&ramp(0.7, 90.0), cut);
        assert!(look.distance(&other) <= 1e-3);
        assert!(look.distance(&Look::cut(&ramp(-1.0, 90.0), cut)) >= 1.99);
        assert!(Look::cut(&ramp(0.0, 50.0), cut).norm <= 1e-3);
    }

    /// Prints how far OpenCV's look at the nearest whole samples is from ours at the box itself, and both times.
    #[test]
    fn opencv_looks_at_whole_samples_only() {
        // A stroke of a digit.
        let ink = |x: f32, y: f32| 200.0 * f32::from(u8::from((x - 14.0).abs() < 2.0 && y > 6.0 && y < 22.0));
        let values: Vec<f32> = (0..1200_u16).map(|k| ink(f32::from(k % 40), f32::from(k / 40))).collect();
        let gray = Gray { width: 40, height: 30, values };
        let cut = Cut { left: 6.5, top: 3.5, width: 14.0, height: 21.0 };
        let own = || Look::cut(&gray, cut);
        let theirs = || {
            let part = [7, 4, 14, 21];
            let values = crate::vision::peers::reduced_part(&gray.values, [40, 30], part, [COLUMNS, ROWS]);
            Look::of(values.try_into().unwrap())
        };
        let apart = own().distance(&theirs());
        assert!((0.1..=0.6).contains(&apart), "{apart}");
        let time = |work: &dyn Fn() -> Look| {
            let start = std::time::Instant::now();
            (0..1000).for_each(|_| assert!(work().norm > 0.0));
            start.elapsed() / 1000
        };
        println!("a look: own {:?}, OpenCV {:?}, {apart:.2} apart", time(&own), time(&theirs));
    }

    #[test]
    fn a_box_beyond_the_crop_continues_its_border() {
        let gray = Gray { width: 3, height: 2, values: vec![7.0; 6] };
        let look = Look::cut(&gray, Cut { left: -4.0, top: -4.0, width: 30.0, height: 30.0 });
        assert!(look.norm <= 1e-3);
        assert_eq!(Look::cut(&Gray::default(), Cut { left: 0.0, top: 0.0, width: 3.0, height: 3.0 }).norm, 0.0);
    }
}
