//! How the cone fills: the forces that were collected, as they come.
//!
//! In: measured forces of recorded rows. Out: which cells have one, at once; the largest hole and all of
//! [`cone_coverage`], on a thread of its own, as it takes longer than a sample may; at the end, exactly what
//! [`cone_coverage`] makes of the saved file.

mod extra;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use lunula_predictor::{CONE_CELLS, ConeCoverage, ForceSpace, cone_cell, cone_coverage};

pub use extra::Extra;
use extra::extra;

/// Below so much pressing and shear the finger is in the air, newtons (assumed: some times a transducer's noise).
pub const REST_N: f64 = 0.05;

/// The forces so far.
#[derive(Debug)]
pub(crate) struct Cover {
    space: ForceSpace,
    rows: Vec<[f64; 3]>,
    /// Which have a row.
    pub(in crate::prompt) cells: Vec<bool>,
    /// Rows that the latest coverage is of.
    looked_at: usize,
    looking: Arc<AtomicBool>,
    latest: Arc<Mutex<Option<ConeCoverage>>>,
}

impl Cover {
    /// Of nothing yet.
    #[must_use]
    pub(crate) fn new(space: ForceSpace) -> Self {
        Self {
            space,
            rows: Vec::new(),
            cells: vec![false; CONE_CELLS.iter().product()],
            looked_at: 0,
            looking: Arc::default(),
            latest: Arc::default(),
        }
    }

    /// A row that was recorded; forces that are not known are NaN.
    pub(crate) fn push(&mut self, force_n: [f64; 3]) {
        let rests = force_n[2].abs() <= REST_N && force_n[0].hypot(force_n[1]) <= REST_N;
        if let Some(cell) = cone_cell(&self.space, force_n).filter(|_| !rests) {
            self.cells[cell] = true;
        }
        self.rows.push(force_n);
    }

    /// The share of cells with a row.
    #[must_use]
    pub(crate) fn visited(&self) -> f64 {
        visited(&self.cells)
    }

    /// Rows so far.
    #[must_use]
    pub(crate) fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The coverage as it was a moment ago; looks again where there are more rows.
    #[must_use]
    pub(crate) fn lately(&mut self) -> Option<ConeCoverage> {
        if self.looked_at < self.rows.len() && !self.looking.swap(true, Ordering::AcqRel) {
            self.looked_at = self.rows.len();
            let (rows, space) = (self.rows.clone(), self.space);
            let (latest, looking) = (Arc::clone(&self.latest), Arc::clone(&self.looking));
            std::thread::spawn(move || {
                let found = cone_coverage(rows, &space, REST_N);
                *latest.lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
                looking.store(false, Ordering::Release);
            });
        }
        self.latest.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The coverage of all rows; takes a moment.
    #[must_use]
    pub(crate) fn coverage(&self) -> ConeCoverage {
        cone_coverage(self.rows.iter().copied(), &self.space, REST_N)
    }

    /// The way through the cells that have no row.
    #[must_use]
    pub(crate) fn extra(&self) -> Option<Extra> {
        extra(&self.space, &self.cells)
    }
}

fn visited(cells: &[bool]) -> f64 {
    cells.iter().filter(|cell| **cell).count() as f64 / cells.len() as f64
}

#[cfg(test)]
mod tests {
    use lunula_predictor::Spiral;

    use super::*;

    fn spiral(cover: &mut Cover, until: u32) {
        let spiral = Spiral::default();
        (0..until).for_each(|k| cover.push(spiral.forces_n(0.04 * f64::from(k))));
    }

    #[test]
    fn the_cells_are_those_of_cone_coverage() {
        let mut cover = Cover::new(ForceSpace::default());
        for force in [[0.0; 3], [f64::NAN, 0.0, -1.0], [3.0, 0.0, -1.0], [0.0, 0.0, 1.0]] {
            cover.push(force);
        }
        assert_eq!((cover.visited(), cover.rows()), (0.0, 4));
        spiral(&mut cover, 2500);
        let coverage = cover.coverage();
        assert!(cover.visited() > 0.3 && coverage.cylindrical.visited == cover.visited());
        assert_eq!((coverage.not_finite, coverage.outside), (1, 2));
    }

    #[test]
    fn the_latest_comes_by_itself_and_is_that_of_rows_that_were_there() {
        let mut cover = Cover::new(ForceSpace::default());
        assert_eq!(cover.lately(), None);
        spiral(&mut cover, 300);
        let expected = cover.coverage();
        let found = (0..2000).find_map(|_| {
            std::thread::sleep(std::time::Duration::from_millis(5));
            cover.lately()
        });
        assert_eq!(found, Some(expected));
    }
}
