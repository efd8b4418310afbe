//! What is to be chosen from, and what a choice costs.

use ndarray::{Array2, ArrayView2, Axis};
use thiserror::Error;

use crate::evaluate::sum::exact_mean;

/// The most candidates: a grid of 32 x 32.
pub const MOST_CANDIDATES: usize = 1024;
/// The most numbers that the second moments of all persons may have: 512 MiB.
const MOST_NUMBERS: usize = 1 << 26;

/// A place that a photodiode could have.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Its name; each has its own.
    pub name: String,
    /// Across the nail, millimetres from the axis: a mirror image has the opposite sign.
    pub across_mm: f64,
    /// Along the axis, millimetres.
    pub along_mm: f64,
}

/// What a cost is made of; see the module's head.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// RMSE of a linear model over the target's SD.
    Error,
    /// Classes that are taken for each other.
    Confusion,
}

impl Criterion {
    /// The cost of a column that explains `q`.
    pub(super) fn of(self, q: f64) -> f64 {
        match self {
            Self::Error => (1.0 - q).max(0.0).sqrt(),
            Self::Confusion => 0.5 * (-0.125 * q).exp(),
        }
    }
}

/// Why there is no problem to solve.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum LayoutFault {
    #[error("there are no {0}")]
    Empty(&'static str),
    #[error("target {column} is the same in all rows: no reading can explain it")]
    ConstantTarget { column: usize },
    #[error("{what} is not a finite number")]
    NotFinite { what: &'static str },
    #[error("the second moments of person {person} do not have one row per candidate, or as many targets as the first")]
    Shape { person: usize },
    #[error("two candidates are called {0}")]
    Twins(String),
    #[error("{candidates} candidates of {persons} persons are more than fit; choose a coarser grid")]
    TooMany { candidates: usize, persons: usize },
}

/// One person's second moments.
#[derive(Debug, Clone, PartialEq)]
pub struct Moments {
    /// Of readings, candidates x candidates, about their mean, with n.
    pub c: Array2<f64>,
    /// Of readings with what they are to explain, candidates x columns.
    pub b: Array2<f64>,
}

impl Moments {
    /// Of rows x candidates and rows x targets, for [`Criterion::Error`]: targets in units of their SD.
    ///
    /// # Errors
    /// [`LayoutFault`]: no rows, a constant target, a number that is not finite.
    pub fn of_rows(x: ArrayView2<f64>, y: ArrayView2<f64>) -> Result<Self, LayoutFault> {
        if x.nrows() == 0 || x.nrows() != y.nrows() {
            return Err(LayoutFault::Empty("rows"));
        }
        let rows = x.nrows() as f64;
        let centred = |all: ArrayView2<f64>| {
            let mut own = all.to_owned();
            for mut column in own.columns_mut() {
                let (mean, rest) = exact_mean(column.iter().copied());
                let constant = column.iter().all(|value| *value == column[0]);
                column.mapv_inplace(|value| if constant { 0.0 } else { (value - mean) - rest });
            }
            own
        };
        let (x, mut y) = (centred(x), centred(y));
        for (k, mut column) in y.columns_mut().into_iter().enumerate() {
            let sd = (column.dot(&column) / rows).sqrt();
            if sd == 0.0 {
                return Err(LayoutFault::ConstantTarget { column: k });
            }
            column /= sd;
        }
        let own = Self { c: x.t().dot(&x) / rows, b: x.t().dot(&y) / rows };
        own.check()?;
        Ok(own)
    }

    fn check(&self) -> Result<(), LayoutFault> {
        let finite = self.c.iter().chain(&self.b).all(|value| value.is_finite());
        if finite { Ok(()) } else { Err(LayoutFault::NotFinite { what: "a second moment" }) }
    }
}

/// Candidates and second moments, brought into an order of their own: from the tip down, from left to right, by name.
#[derive(Debug, Clone)]
pub struct LayoutProblem {
    pub(super) criterion: Criterion,
    pub(super) candidates: Vec<Candidate>,
    /// For each candidate, its place in the caller's order.
    pub(super) given: Vec<usize>,
    pub(super) persons: usize,
    pub(super) columns: usize,
    /// Persons x candidates x candidates; a diagonal of 1, or 0 where a reading is constant.
    pub(super) c: Vec<f64>,
    /// Persons x columns x candidates, in the same scales.
    pub(super) b: Vec<f64>,
    /// Persons x candidates: the variances that the scales took away, noise included.
    pub(super) variance: Vec<f64>,
}

impl LayoutProblem {
    /// `noise_sd`: what a photodiode adds to each reading of its own, in the readings' unit.
    pub fn new(
        criterion: Criterion,
        candidates: &[Candidate],
        persons: &[Moments],
        noise_sd: f64,
    ) -> Result<Self, LayoutFault> {
        let n = candidates.len();
        let Some(first) = persons.first() else { return Err(LayoutFault::Empty("persons")) };
        let columns = first.b.ncols();
        for (count, what) in [(n, "candidates"), (columns, "targets")] {
            if count == 0 {
                return Err(LayoutFault::Empty(what));
            }
        }
        Self::fits(n, persons.len())?;
        if !candidates.iter().all(|one| one.across_mm.is_finite() && one.along_mm.is_finite()) {
            return Err(LayoutFault::NotFinite { what: "a candidate's place" });
        }
        if noise_sd.is_nan() {
            return Err(LayoutFault::NotFinite { what: "the noise of a photodiode" });
        }
        let mut given: Vec<usize> = (0..n).collect();
        given.sort_by(|&i, &j| {
            let (a, b) = (&candidates[i], &candidates[j]);
            let along = b.along_mm.total_cmp(&a.along_mm);
            along.then(a.across_mm.total_cmp(&b.across_mm)).then_with(|| a.name.cmp(&b.name))
        });
        let mut names: Vec<&str> = candidates.iter().map(|one| one.name.as_str()).collect();
        names.sort_unstable();
        if let Some(twins) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(LayoutFault::Twins(twins[0].to_owned()));
        }
        let mut own = Self {
            criterion,
            candidates: given.iter().map(|&k| candidates[k].clone()).collect(),
            given,
            persons: persons.len(),
            columns,
            c: Vec::with_capacity(n * n * persons.len()),
            b: Vec::with_capacity(n * columns * persons.len()),
            variance: Vec::with_capacity(n * persons.len()),
        };
        for (person, moments) in persons.iter().enumerate() {
            if moments.c.dim() != (n, n) || moments.b.dim() != (n, columns) {
                return Err(LayoutFault::Shape { person });
            }
            moments.check()?;
            own.take(moments, noise_sd);
        }
        Ok(own)
    }

    /// Whether second moments of so many candidates and persons fit into memory: to be asked before they are made.
    ///
    /// # Errors
    /// [`LayoutFault::TooMany`].
    pub fn fits(candidates: usize, persons: usize) -> Result<(), LayoutFault> {
        let few = candidates <= MOST_CANDIDATES && candidates * candidates * persons <= MOST_NUMBERS;
        if few { Ok(()) } else { Err(LayoutFault::TooMany { candidates, persons }) }
    }

    fn take(&mut self, moments: &Moments, noise_sd: f64) {
        let order = &self.given;
        let variance = |k: usize| moments.c[[k, k]] + noise_sd * noise_sd;
        let scale: Vec<f64> =
            order.iter().map(|&k| variance(k)).map(|v| if v > 0.0 { v.sqrt().recip() } else { 0.0 }).collect();
        for (i, &from) in order.iter().enumerate() {
            let row = order.iter().enumerate().map(|(j, &to)| match i == j {
                true => f64::from(u8::from(scale[i] > 0.0 || variance(from).is_infinite())),
                false => moments.c[[from, to]] * scale[i] * scale[j],
            });
            self.c.extend(row);
        }
        for column in moments.b.axis_iter(Axis(1)) {
            self.b.extend(order.iter().zip(&scale).map(|(&k, scale)| column[k] * scale));
        }
        self.variance.extend(order.iter().map(|&k| variance(k)));
    }

    /// How many candidates there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.candidates.len()
    }

    /// Never: a problem has candidates.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.candidates.is_empty()
    }

    /// The same candidates without a person; none where nobody is left.
    #[must_use]
    pub fn without(&self, person: usize) -> Option<Self> {
        let (n, mut own) = (self.len(), self.clone());
        if self.persons < 2 {
            return None;
        }
        own.persons -= 1;
        for (numbers, each) in [(&mut own.c, n * n), (&mut own.b, n * self.columns), (&mut own.variance, n)] {
            numbers.drain(person * each..(person + 1) * each);
        }
        Some(own)
    }

    /// The problem with some of its candidates only, in this order; the caller's numbers stay with them.
    pub(super) fn reordered(&self, order: &[usize]) -> Self {
        let n = self.len();
        let starts = |blocks: usize, each: usize| (0..blocks).map(move |block| block * each);
        let gather = |all: &[f64], blocks: usize| -> Vec<f64> {
            starts(blocks, n).flat_map(|start| order.iter().map(move |&k| all[start + k])).collect()
        };
        let square = starts(self.persons, n * n);
        Self {
            criterion: self.criterion,
            candidates: order.iter().map(|&k| self.candidates[k].clone()).collect(),
            given: order.iter().map(|&k| self.given[k]).collect(),
            persons: self.persons,
            columns: self.columns,
            c: square
                .flat_map(|at| order.iter().flat_map(move |&i| order.iter().map(move |&j| self.c[at + i * n + j])))
                .collect(),
            b: gather(&self.b, self.persons * self.columns),
            variance: gather(&self.variance, self.persons),
        }
    }

    /// The problem's own number of the caller's candidate.
    pub(super) fn own(&self, given: usize) -> usize {
        self.given.iter().position(|&k| k == given).expect("a candidate of this problem")
    }

    /// The caller's numbers of own ones, in the problem's order.
    pub(super) fn callers(&self, own: &[usize]) -> Vec<usize> {
        let mut sorted = own.to_vec();
        sorted.sort_unstable();
        sorted.into_iter().map(|k| self.given[k]).collect()
    }
}
