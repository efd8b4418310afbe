//! What was read: candidates with their places, second moments, and what they are of.

use lunula_predictor::{Criterion, LayoutProblem, Moments};
use ndarray::{Array1, Array2};
use serde::Serialize;

use super::places::Place;
use crate::layout::error::LayoutError;
use crate::layout::held_out::OwnRows;
use crate::layout::options::LayoutOptions;

#[derive(Debug, Clone)]
pub(in crate::layout) struct Given {
    pub(in crate::layout) criterion: Criterion,
    pub(in crate::layout) places: Vec<Place>,
    /// One of each person; of maps one of all.
    pub(in crate::layout) moments: Vec<Moments>,
    pub(in crate::layout) parts: Parts,
    pub(in crate::layout) persons: Vec<PersonFigures>,
    /// What the columns of B are.
    pub(in crate::layout) targets: Vec<Target>,
    pub(in crate::layout) left_out: LeftOutCandidates,
    /// Rows that determine a model: the fewest of a person.
    pub(in crate::layout) rows: usize,
    /// What changes from pose to pose, over the whole normalized picture; of maps only.
    pub(in crate::layout) contrast: Option<Contrast>,
    pub(in crate::layout) notes: Vec<String>,
    pub(in crate::layout) warnings: Vec<String>,
}

/// A target, or two poses to be separated.
#[derive(Debug, Clone)]
pub(in crate::layout) struct Target {
    pub(in crate::layout) name: String,
    /// Its SD for each person, in its unit; of poses none.
    pub(in crate::layout) sd: Vec<f64>,
}

/// What is left out for the intervals, one after the other.
#[derive(Debug, Clone)]
pub(in crate::layout) enum Parts {
    /// Each person, in whose rows the layout chosen without them is then judged.
    Persons(Vec<OwnRows>),
    /// Each subject of maps, whose pictures are put to poses by the layout chosen without them.
    Subjects(Vec<WithoutSubject>),
}

/// A subject of maps, and what all others say.
#[derive(Debug, Clone)]
pub(in crate::layout) struct WithoutSubject {
    /// Of the others.
    pub(in crate::layout) moments: Moments,
    /// The others' mean reading of each pose at each candidate.
    pub(in crate::layout) means: Vec<Array1<f64>>,
    /// The subject's own pictures: pose, reading at each candidate.
    pub(in crate::layout) own: Vec<(usize, Array1<f64>)>,
}

/// Every two of so many poses, in the order of the moments' columns.
pub(in crate::layout) fn pairs(poses: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..poses).flat_map(move |a| (a + 1..poses).map(move |b| [a, b]))
}

/// How much the maps' means differ from pose to pose, pixel by pixel.
#[derive(Debug, Clone)]
pub(in crate::layout) struct Contrast {
    /// SD over poses, fraction of full scale, rows from the distal edge of the picture.
    pub(in crate::layout) sd: Array2<f32>,
    /// The picture's side, as a multiple of the nail's box.
    pub(in crate::layout) margin: f64,
}

impl Given {
    /// The problem of all persons.
    pub(in crate::layout) fn problem(&self, options: &LayoutOptions) -> Result<LayoutProblem, LayoutError> {
        self.problem_of(&self.moments, options)
    }

    /// How many parts are left out, one after the other.
    pub(in crate::layout) fn parts(&self) -> usize {
        match &self.parts {
            Parts::Persons(each) if each.len() < 2 => 0,
            Parts::Persons(each) => each.len(),
            Parts::Subjects(each) => each.len(),
        }
    }

    /// The problem without a part: made when it is needed, as each is about as large as the whole.
    pub(in crate::layout) fn without(
        &self,
        part: usize,
        all: &LayoutProblem,
        options: &LayoutOptions,
    ) -> Option<LayoutProblem> {
        match &self.parts {
            Parts::Persons(_) => all.without(part),
            Parts::Subjects(each) => self.problem_of(std::slice::from_ref(&each[part].moments), options).ok(),
        }
    }

    fn problem_of(&self, moments: &[Moments], options: &LayoutOptions) -> Result<LayoutProblem, LayoutError> {
        let candidates: Vec<_> = self.places.iter().map(|place| place.candidate(options)).collect();
        Ok(LayoutProblem::new(self.criterion, &candidates, moments, options.noise)?)
    }
}

/// Candidates that were left out, each for the first reason that holds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct LeftOutCandidates {
    /// Too near to the edge of the nail's box, or outside of it.
    pub edge: usize,
    /// Missing in too many rows: outside of the outline, or hidden.
    pub missing: usize,
    /// The same in all rows.
    pub constant: usize,
}

/// A person's rows; of maps a subject's pictures.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PersonFigures {
    /// Who.
    pub name: String,
    /// Rows that were used.
    pub rows: usize,
    /// Rows in which a reading or a target is missing.
    pub incomplete: usize,
}
