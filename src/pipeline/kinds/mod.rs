//! The kinds of jobs that pipelines know, a file each: what of a task's inputs and options the job of the same name is
//! given.

mod align;
mod analyse;
mod compare;
mod curve;
mod evaluate;
mod fit;
mod format;
mod given;
mod join;
mod log_keys;
mod maps;
mod nail;
mod normalize;
mod options;
mod phantom;
mod pool;
mod posture;
mod predict;
mod prune;
mod recordings;
mod responses;
mod section;
mod simulate;
mod study;
mod train;
mod trajectory;
mod truth;
mod typical;

use super::kind::Kind;

pub use phantom::phantom_catalogue;

/// All kinds of jobs, by name.
#[must_use]
pub fn kinds() -> &'static [&'static Kind] {
    KINDS
}

/// A line each, sorted by name.
static KINDS: &[&Kind] = &[
    &align::ALIGN,
    &analyse::ANALYSE,
    &compare::COMPARE,
    &evaluate::EVALUATE,
    &fit::FIT,
    &join::JOIN,
    &maps::MAPS,
    &normalize::NORMALIZE,
    &posture::POSTURE,
    &predict::PREDICT,
    &section::PRESSES,
    &prune::PRUNE,
    &responses::RESPONSES,
    &section::SECTION,
    &simulate::SIMULATE,
    &curve::STATIC,
    &study::STUDY,
    &train::TRAIN,
    &trajectory::TRAJECTORY,
    &typical::TYPICAL,
];

#[cfg(test)]
mod tests;
