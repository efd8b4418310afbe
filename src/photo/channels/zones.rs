//! White and red zones of the nail's bed, chosen by other subjects and by no single channel.
//!
//! In: pictures of the subjects of a pose. Out: for each subject the cells that are lightest and darkest on the others'
//! mean picture. Sums are integers, so they do not depend on the order of the subjects.

use super::cells::{Cells, GRID};

/// How far the bed reaches, as a share of the box's half sides (assumed): along the rim the pictures of subjects differ
/// by trimming, folds and lunula (Fig. 56), not by blood.
const BED: f64 = 0.8;
/// Share of the bed that is white, and that is red (assumed).
const SHARE: f64 = 0.25;
/// A picture's value that is the mean over its bed.
const ONE: f64 = 65536.0;

/// The cells of the bed: within a rounded box.
pub(super) fn bed() -> impl Iterator<Item = usize> {
    let from_middle = |k: usize| (2.0 * (k as f64 + 0.5) / GRID as f64 - 1.0) / BED;
    (0..GRID * GRID).filter(move |at| from_middle(at / GRID).powi(4) + from_middle(at % GRID).powi(4) <= 1.0)
}

/// White and red zones: cells, the same in every channel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Zones {
    pub(super) white: Vec<usize>,
    pub(super) red: Vec<usize>,
}

/// Neutral pictures of a pose's subjects, added up.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Neutral {
    sum: Vec<u64>,
    count: Vec<u32>,
}

impl Neutral {
    /// Of all the subjects of a pose.
    pub(super) fn of<'a>(subjects: impl Iterator<Item = &'a Cells>) -> Self {
        let mut all = Self { sum: vec![0; GRID * GRID], count: vec![0; GRID * GRID] };
        for cells in subjects {
            for (at, value) in neutral(cells) {
                all.sum[at] += value;
                all.count[at] += 1;
            }
        }
        all
    }

    /// All but one of the subjects that were added.
    pub(super) fn without(&self, one: &Cells) -> Self {
        let mut others = self.clone();
        for (at, value) in neutral(one) {
            others.sum[at] -= value;
            others.count[at] -= 1;
        }
        others
    }

    /// The lightest and the darkest quarter of the bed; none where it is as light everywhere, or not seen.
    pub(super) fn zones(&self) -> Option<Zones> {
        let seen = bed().filter(|&at| self.count[at] > 0);
        let cells: Vec<(usize, f64)> = seen.map(|at| (at, self.sum[at] as f64 / f64::from(self.count[at]))).collect();
        let mut values: Vec<f64> = cells.iter().map(|&(_, value)| value).collect();
        values.sort_by(f64::total_cmp);
        let quarter = (SHARE * values.len() as f64) as usize;
        let darkest = *values.get(quarter.checked_sub(1)?)?;
        let lightest = values[values.len() - quarter];
        let of = |belongs: &dyn Fn(f64) -> bool| -> Vec<usize> {
            cells.iter().filter(|&&(_, value)| belongs(value)).map(|&(at, _)| at).collect()
        };
        (darkest < lightest)
            .then(|| Zones { white: of(&|value| value >= lightest), red: of(&|value| value <= darkest) })
    }
}

/// The mean over channels of the value as a fraction of the channel's mean on the bed, by cell of the bed that is seen.
/// A channel that is black has no vote.
fn neutral(cells: &Cells) -> impl Iterator<Item = (usize, u64)> {
    let seen: Vec<usize> = bed().filter(|&at| cells.seen[at]).collect();
    let sums = cells.levels.each_ref().map(|levels| seen.iter().map(|&at| u64::from(levels[at])).sum::<u64>());
    let channels = sums.iter().filter(|&&sum| sum > 0).count().max(1) as f64;
    let count = seen.len() as f64;
    seen.into_iter().map(move |at| {
        let of_mean = |(levels, &sum): (&Vec<u16>, &u64)| {
            if sum == 0 { 0.0 } else { f64::from(levels[at]) * count / sum as f64 }
        };
        let value: f64 = cells.levels.iter().zip(&sums).map(of_mean).sum();
        (at, (value / channels * ONE).round() as u64)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lighter from column to column, in every channel by its own exposure.
    fn ramp(exposure: [u16; 3]) -> Cells {
        let levels = exposure.map(|exposure| (0..GRID * GRID).map(|at| exposure * (100 + at % GRID) as u16).collect());
        Cells { levels, seen: vec![true; GRID * GRID] }
    }

    #[test]
    fn zones_are_quarters_of_the_bed_and_exposure_does_not_move_them() {
        let zones = Neutral::of([ramp([100, 200, 300])].iter()).zones().expect("zones");
        let cells = bed().count() as f64;
        for zone in [&zones.white, &zones.red] {
            // Whole columns are equally light.
            assert!((zone.len() as f64 - 0.25 * cells).abs() <= GRID as f64, "{} of {cells}", zone.len());
        }
        assert!(zones.white.iter().all(|at| at % GRID > GRID / 2) && zones.red.iter().all(|at| at % GRID < GRID / 2));
        assert_eq!(Neutral::of([ramp([300, 50, 7])].iter()).zones(), Some(zones));
    }

    #[test]
    fn what_is_left_without_one_is_the_sum_of_the_others() {
        let subjects = [ramp([100, 200, 300]), ramp([301, 20, 77]), ramp([9, 9, 10])];
        let all = Neutral::of(subjects.iter());
        assert_eq!(all.without(&subjects[1]), Neutral::of([&subjects[0], &subjects[2]].into_iter()));
    }

    #[test]
    fn a_bed_that_is_as_light_everywhere_has_no_zones() {
        let flat = Cells { levels: [(); 3].map(|()| vec![9000; GRID * GRID]), seen: vec![true; GRID * GRID] };
        assert_eq!(Neutral::of([flat].iter()).zones(), None);
        let unseen = Cells { levels: [(); 3].map(|()| vec![0; GRID * GRID]), seen: vec![false; GRID * GRID] };
        assert_eq!(Neutral::of([unseen].iter()).zones(), None);
    }
}
