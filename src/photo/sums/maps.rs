//! Normalized pictures of many subjects to their mean and standard deviation per pixel (section 4.2.2, Fig. 53 and 56).
//!
//! In: normalized pictures, one per subject. Out: mean, SD (n - 1) and count per pixel. Values are quantized to 16 bits
//! and summed, with their squares, in integers: sums made in any order, by any number of threads, in parts and merged,
//! are the same to the byte, and two equal pictures have an SD of exactly 0. A pixel that no subject shows has no
//! mean; one that fewer than two show has no SD: both are NaN.
//!
//! Where a photograph shows several nails, their mean is the subject's picture: nails of one hand are not
//! independent subjects.

use std::collections::{BTreeMap, BTreeSet};

use ndarray::Array2;

use super::look::Look;
use crate::photo::normalize::{self, Normalized};

/// Full scale of the quantized values.
const FULL_SCALE: f64 = normalize::FULL_SCALE as f64;
/// Pixels whose sums stay in a core's first cache (16 KB of its 32 or more).
const BLOCK: usize = 1024;

/// Sums over subjects, one per pixel, `size` x `size`, row by row from the top (distal).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sums {
    pub(crate) size: usize,
    pub(crate) sum: Vec<u64>,
    pub(crate) sum_sq: Vec<u64>,
    pub(crate) count: Vec<u32>,
    pub(crate) subjects: BTreeSet<String>,
    /// Those whose photographs are grey.
    pub(crate) grey: BTreeSet<String>,
    /// What their photographs look like; of sums by an earlier version none.
    pub(super) looks: BTreeMap<String, Look>,
}

/// Mean, SD and count over subjects; fractions of full scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Maps {
    /// NaN where no subject shows the pixel.
    pub mean: Array2<f32>,
    /// With n - 1; NaN where fewer than two subjects show the pixel.
    pub sd: Array2<f32>,
    /// How many subjects show the pixel.
    pub count: Array2<u32>,
}

impl Sums {
    /// No subject yet.
    pub fn new(size: usize) -> Self {
        let pixels = size * size;
        let (sum, sum_sq, count) = (vec![0; pixels], vec![0; pixels], vec![0; pixels]);
        let (subjects, grey, looks) = (BTreeSet::new(), BTreeSet::new(), BTreeMap::new());
        Self { size, sum, sum_sq, count, subjects, grey, looks }
    }

    /// Adds a subject, whose picture is the mean of `nails` where they show it.
    ///
    /// # Errors
    /// The subject's name where it has been added before: a subject counts once.
    ///
    /// # Panics
    /// Where a nail's size is not that of the sums.
    pub fn add(&mut self, subject: &str, nails: &[Normalized]) -> Result<(), DuplicateSubject> {
        assert!(nails.iter().all(|n| n.size == self.size), "pictures of one size");
        self.enter(subject)?;
        match nails {
            [whole @ Normalized { seen: None, .. }] => self.add_whole(std::slice::from_ref(whole)),
            several => self.add_seen((0..self.size * self.size).map(|at| mean_of_nails(several, at))),
        }
        Ok(())
    }

    /// Names a subject, whose picture is added next.
    pub(super) fn enter(&mut self, subject: &str) -> Result<(), DuplicateSubject> {
        if self.subjects.insert(subject.to_owned()) { Ok(()) } else { Err(DuplicateSubject(subject.to_owned())) }
    }

    /// Adds pictures that show every pixel, block by block, so that each sum is read and written once.
    ///
    /// # Panics
    /// Where a picture's size is not that of the sums.
    pub(super) fn add_whole(&mut self, pictures: &[Normalized]) {
        assert!(pictures.iter().all(|picture| picture.size == self.size), "pictures of one size");
        for (at, sums) in self.sum.chunks_mut(BLOCK).enumerate() {
            let squares = &mut self.sum_sq[at * BLOCK..][..sums.len()];
            for picture in pictures {
                let levels = &picture.levels[at * BLOCK..][..sums.len()];
                for ((sum, sum_sq), &level) in sums.iter_mut().zip(&mut *squares).zip(levels) {
                    let level = u32::from(level);
                    *sum += u64::from(level);
                    *sum_sq += u64::from(level * level);
                }
            }
        }
        let more = u32::try_from(pictures.len()).expect("a batch");
        self.count.iter_mut().for_each(|count| *count += more);
    }

    fn add_seen(&mut self, levels: impl Iterator<Item = Option<u64>>) {
        let cells = self.sum.iter_mut().zip(&mut self.sum_sq).zip(&mut self.count);
        for (((sum, sum_sq), count), level) in cells.zip(levels) {
            if let Some(level) = level {
                *sum += level;
                *sum_sq += level * level;
                *count += 1;
            }
        }
    }

    /// Adds the subjects of `other`.
    ///
    /// # Errors
    /// The first subject that both hold; nothing is added then.
    ///
    /// # Panics
    /// Where the sizes differ.
    pub fn merge(&mut self, other: &Self) -> Result<(), DuplicateSubject> {
        assert_eq!(self.size, other.size, "sums of one size");
        if let Some(both) = self.subjects.intersection(&other.subjects).next() {
            return Err(DuplicateSubject(both.clone()));
        }
        self.subjects.extend(other.subjects.iter().cloned());
        self.grey.extend(other.grey.iter().cloned());
        self.looks.extend(other.looks.iter().map(|(subject, look)| (subject.clone(), look.clone())));
        self.sum.iter_mut().zip(&other.sum).for_each(|(a, b)| *a += b);
        self.sum_sq.iter_mut().zip(&other.sum_sq).for_each(|(a, b)| *a += b);
        self.count.iter_mut().zip(&other.count).for_each(|(a, b)| *a += b);
        Ok(())
    }

    /// Names of the subjects added, sorted.
    pub fn subjects(&self) -> impl ExactSizeIterator<Item = &str> {
        self.subjects.iter().map(String::as_str)
    }

    /// Whether pictures exist that add up to this: what a file says is not taken on trust.
    pub(crate) fn are_possible(&self) -> bool {
        self.sum.iter().zip(&self.sum_sq).zip(&self.count).all(|((&sum, &sum_sq), &count)| {
            let (n, sum, sum_sq) = (u128::from(count), u128::from(sum), u128::from(sum_sq));
            count as usize <= self.subjects.len()
                && sum <= n * 65535
                && sum * sum <= n * sum_sq
                && sum_sq <= sum * 65535
        })
    }

    /// Mean, SD and count.
    pub fn maps(&self) -> Maps {
        let shape = (self.size, self.size);
        let cells = || self.sum.iter().zip(&self.sum_sq).zip(&self.count);
        Maps {
            mean: shaped(shape, cells().map(|((&sum, _), &n)| mean(sum, n)).collect()),
            sd: shaped(shape, cells().map(|((&sum, &sum_sq), &n)| sd(sum, sum_sq, n)).collect()),
            count: shaped(shape, self.count.clone()),
        }
    }
}

fn shaped<T>(shape: (usize, usize), values: Vec<T>) -> Array2<T> {
    Array2::from_shape_vec(shape, values).expect("one value a pixel")
}

/// A subject that would count twice.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("subject `{0}` is there twice")]
pub struct DuplicateSubject(pub String);

/// The rounded mean over the nails that show the pixel.
pub(in crate::photo) fn mean_of_nails(nails: &[Normalized], at: usize) -> Option<u64> {
    let seen = nails.iter().filter_map(|nail| nail.level(at));
    let (sum, count) = seen.fold((0, 0), |(sum, count), level| (sum + u64::from(level), count + 1));
    (count > 0).then(|| (2 * sum + count) / (2 * count))
}

fn mean(sum: u64, count: u32) -> f32 {
    if count == 0 {
        return f32::NAN;
    }
    (sum as f64 / f64::from(count) / FULL_SCALE) as f32
}

/// `sqrt((n sum(x^2) - sum(x)^2) / (n (n - 1)))`: the difference is taken exactly, in integers.
fn sd(sum: u64, sum_sq: u64, count: u32) -> f32 {
    if count < 2 {
        return f32::NAN;
    }
    let n = u64::from(count);
    // Up to 2^15 subjects n sum(x^2) fits 64 bits.
    let spread = if n <= 1 << 15 {
        (n * sum_sq - sum * sum) as f64
    } else {
        (u128::from(n) * u128::from(sum_sq) - u128::from(sum) * u128::from(sum)) as f64
    };
    ((spread / (n as f64 * (n - 1) as f64)).sqrt() / FULL_SCALE) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn picture(values: &[f32]) -> Normalized {
        let size = values.len().isqrt();
        Normalized::from_values(size, values)
    }

    fn sums(pictures: &[(&str, Vec<f32>)]) -> Sums {
        let mut sums = Sums::new(2);
        for (subject, values) in pictures {
            sums.add(subject, &[picture(values)]).expect("each subject once");
        }
        sums
    }

    #[test]
    fn one_subject_has_no_sd_and_none_has_no_mean() {
        let none = Sums::new(2).maps();
        assert!(none.mean.iter().all(|v| v.is_nan()) && none.count.iter().all(|&n| n == 0));
        let one = sums(&[("a", vec![0.0, 0.25, 1.0, f32::NAN])]).maps();
        assert_eq!(one.count.as_slice(), Some(&[1, 1, 1, 0][..]));
        assert!(one.mean[[1, 1]].is_nan());
        assert_eq!((one.mean[[0, 0]], one.mean[[1, 0]]), (0.0, 1.0));
        assert!(one.sd.iter().all(|v| v.is_nan()));
    }

    #[test]
    fn equal_pictures_have_an_sd_of_exactly_zero() {
        let values = vec![0.1, 0.333, 0.777, 0.999];
        let maps = sums(&[("a", values.clone()), ("b", values.clone()), ("c", values)]).maps();
        assert!(maps.sd.iter().all(|&v| v == 0.0));
    }

    #[test]
    fn a_subject_counts_once() {
        let mut twice = sums(&[("a", vec![0.5; 4])]);
        assert_eq!(twice.add("a", &[picture(&[0.5; 4])]), Err(DuplicateSubject("a".into())));
        let other = twice.clone();
        assert_eq!(twice.merge(&other), Err(DuplicateSubject("a".into())));
        assert_eq!(twice, other);
    }

    #[test]
    fn nails_of_one_photograph_are_one_subject() {
        let mut sums = Sums::new(2);
        let (first, second) = (picture(&[0.2, f32::NAN, f32::NAN, 1.0]), picture(&[0.4, 0.8, f32::NAN, 1.0]));
        sums.add("a", &[first, second]).expect("once");
        let maps = sums.maps();
        assert_eq!(maps.count.as_slice(), Some(&[1, 1, 0, 1][..]));
        assert!((maps.mean[[0, 0]] - 0.3).abs() <= 1e-5 && (maps.mean[[0, 1]] - 0.8).abs() <= 1e-5);
    }

    proptest! {
        /// The sums' twin: the two-pass formula in f64 over the pictures themselves, quantization (1/131070) apart.
        #[test]
        fn mean_and_sd_are_the_textbook_s(
            rows in prop::collection::vec(prop::collection::vec(0.0_f32..=1.0, 4), 2..20),
        ) {
            let pictures: Vec<(String, Vec<f32>)> =
                rows.iter().enumerate().map(|(k, r)| (format!("s{k}"), r.clone())).collect();
            let named: Vec<(&str, Vec<f32>)> = pictures.iter().map(|(n, r)| (n.as_str(), r.clone())).collect();
            let maps = sums(&named).maps();
            for at in 0..4 {
                let column: Vec<f64> = rows.iter().map(|r| f64::from(r[at])).collect();
                let n = column.len() as f64;
                let mean = column.iter().sum::<f64>() / n;
                let sd = (column.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
                prop_assert!((f64::from(maps.mean[[at / 2, at % 2]]) - mean).abs() <= 8e-6);
                prop_assert!((f64::from(maps.sd[[at / 2, at % 2]]) - sd).abs() <= 2e-5);
            }
        }

        #[test]
        fn parts_in_any_order_merge_to_the_whole(
            rows in prop::collection::vec(prop::collection::vec(0.0_f32..=1.0, 4), 1..12),
            cut in 0_usize..12,
        ) {
            let names: Vec<String> = (0..rows.len()).map(|k| format!("s{k}")).collect();
            let named: Vec<(&str, Vec<f32>)> = names.iter().map(String::as_str).zip(rows).collect();
            let cut = cut.min(named.len());
            let whole = sums(&named);
            let (mut late, early) = (sums(&named[cut..]), sums(&named[..cut]));
            late.merge(&early).expect("no subject in both");
            prop_assert_eq!(late, whole);
        }
    }
}
