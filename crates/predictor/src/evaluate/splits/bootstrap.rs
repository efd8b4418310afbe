//! How sure an RMSE on more rows of these very recordings is: blocks of rows that follow each other in time are drawn
//! again and again (Künsch 1989, doi:10.1214/aos/1176347265), as neighbouring errors are alike. It says nothing of new
//! recordings, in which a sensor is put on again: what all rows of one share is in no block alone.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::Dataset;

/// Blocks of a recording: long against blood's time constants where a recording lasts a minute; assumed.
const BLOCKS: usize = 10;
/// Draws; the ends of an interval are then known to a tenth of its width.
const DRAWS: usize = 1000;
const SEED: u64 = 1;

/// Sums of squares over blocks of rows.
#[derive(Debug, Clone, Default)]
pub(super) struct Blocks {
    /// Of the errors, of the baseline's errors, rows.
    all: Vec<[f64; 3]>,
}

impl Blocks {
    /// Errors of rows against those of a baseline; rows with one that is not finite do not count.
    pub(super) fn of(data: &Dataset, errors: &[f64], baseline: &[f64]) -> Self {
        let mut all = Vec::new();
        for one in data.recordings() {
            let (start, rows) = (one.rows.start, one.rows.len());
            for block in 0..BLOCKS {
                let mut sums = [0.0; 3];
                for row in start + block * rows / BLOCKS..start + (block + 1) * rows / BLOCKS {
                    if errors[row].is_finite() && baseline[row].is_finite() {
                        sums[0] += errors[row] * errors[row];
                        sums[1] += baseline[row] * baseline[row];
                        sums[2] += 1.0;
                    }
                }
                if sums[2] > 0.0 {
                    all.push(sums);
                }
            }
        }
        Self { all }
    }

    /// The RMSE's 95 % interval, and whether the errors are surely below the baseline's: in 97.5 % of all draws. None
    /// of fewer than two blocks.
    pub(super) fn interval(&self) -> Option<([f64; 2], bool)> {
        let count = self.all.len();
        if count < 2 {
            return None;
        }
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        let (mut rmse, mut below) = (Vec::with_capacity(DRAWS), 0);
        for _ in 0..DRAWS {
            let mut sums = [0.0; 3];
            for _ in 0..count {
                let one = self.all[(random.next_u64() % count as u64) as usize];
                sums.iter_mut().zip(one).for_each(|(sum, one)| *sum += one);
            }
            rmse.push((sums[0] / sums[2]).sqrt());
            below += usize::from(sums[0] < sums[1]);
        }
        rmse.sort_by(f64::total_cmp);
        let at = |share: f64| rmse[(share * (DRAWS - 1) as f64).round() as usize];
        Some(([at(0.025), at(0.975)], below as f64 >= 0.975 * DRAWS as f64))
    }
}
