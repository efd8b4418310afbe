//! The reproduction of S. Mascaro's thesis on fingernail sensors: a counterpart of every data figure of it from a
//! study's results, and a page that sets what the thesis says beside what came out.
//!
//! In: results of the library's jobs, of a phantom ([`phantom`]) or of one's own recordings. Out: pictures, tables, and
//! numbers by name ([`Numbers`]) for each part: the nail's colour as a sensor and a camera see it (2.3, 2.4), the
//! sensor's responses of 3.3, the coloration of 4.2, the simulations of 4.3 and presses of people ([`section_4_3`]),
//! the predictors of chapter 5 ([`compare`]), trials of appendix C; and what the thesis states of them, judged
//! ([`statements`]) and set on a page with all figures ([`study_page`]).
//!
//! Its jobs are stages of pipelines ([`kinds`]), its phantom a block of `[phantom]` ([`experiments`]): whoever runs
//! pipelines hands both to the engine, beside the library's own.

mod coloration;
pub mod compare;
mod film;
mod numbers;
mod page;
pub mod phantom;
mod predictors;
mod responses;
mod section;
pub mod statements;
mod typical;

use lunula::job::{Job as _, Kind};
use lunula::pipeline::Block;

pub use numbers::Numbers;
pub use page::{KindFigures, PageFigures, PageOptions, PageReport, Part, PartFolder, study_page};
pub use section::section_4_3;

/// The kinds of the study's jobs, by name.
#[must_use]
pub fn kinds() -> &'static [&'static Kind] {
    static KINDS: &[&Kind] = &[
        &compare::CompareChoices::KIND,
        &film::FilmJob::KIND,
        &compare::HalvesJob::KIND,
        &section::PressesJob::KIND,
        &responses::ResponsesOptions::KIND,
        &film::RisingJob::KIND,
        &section::SectionJob::KIND,
        &page::PageOptions::KIND,
        &typical::TypicalJob::KIND,
    ];
    KINDS
}

/// The experiments that the block `[phantom]` of a pipeline file may ask for, beside the library's scenes.
///
/// ```toml
/// [phantom]
/// study = { seed = 1, subjects = 4 }     # {phantom}/photos, {phantom}/s01/bending, {phantom}/tables, ..
/// ```
#[must_use]
pub fn experiments() -> &'static [Block] {
    &[phantom::BLOCK]
}

#[cfg(test)]
mod tests {
    use super::kinds;

    #[test]
    fn kinds_are_sorted_and_none_takes_a_key_that_it_does_not_know() {
        assert!(kinds().is_sorted_by_key(|kind| kind.name));
        let own = lunula::pipeline::kinds();
        for kind in kinds() {
            assert!(own.iter().all(|other| other.name != kind.name), "{} is a kind of the library", kind.name);
            let fault = (kind.prepare)(&"no_such_key = 1".parse().unwrap()).err();
            assert_eq!(fault.unwrap_or_else(|| panic!("{} takes any key", kind.name)).key, "no_such_key");
            let keys = (kind.keys)();
            assert!(kind.roles.iter().all(|role| keys.iter().all(|key| key != role.name)), "{}", kind.name);
        }
    }
}
