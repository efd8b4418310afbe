//! What the thesis' text says of its data figures, as data, and whether a study's numbers agree.
//!
//! Each [`Statement`] is words of the thesis, in short, with the figure or relation that it states, and a [`Test`] on
//! numbers by name; nothing else decides a [`Verdict`]. Where the thesis says "about", a quarter more or less is taken;
//! where it says "little", "virtually no" or "comparable", what that is taken for stands in the statement's test and is
//! told beside it.

mod coloration;
mod hemodynamics;
mod predictors;
mod responses;
mod test;

use serde::Serialize;

use super::Numbers;
pub use test::Test;

/// Something that the thesis states.
#[derive(Debug, Clone, Copy)]
pub struct Statement {
    /// Its name: unlike any other's.
    pub id: &'static str,
    /// The thesis' section.
    pub section: &'static str,
    /// The thesis' figures, as `105-107`; empty: none.
    pub figure: &'static str,
    /// What it says, in short.
    pub says: &'static str,
    /// The figure or relation that it states.
    pub stated: &'static str,
    /// What decides.
    pub test: Test,
}

/// Whether what came out agrees.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It does.
    Agrees,
    /// It does not.
    DoesNot,
    /// It can't be judged, and why.
    CannotTell(String),
}

impl Verdict {
    /// In a word or two.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::DoesNot => "does not",
            Self::CannotTell(_) => "can't be judged",
        }
    }
}

/// A statement, judged.
#[derive(Debug, Clone)]
pub struct Judged {
    /// As it is in the thesis.
    pub statement: &'static Statement,
    /// What came out, in words.
    pub found: String,
    /// Whether it agrees.
    pub verdict: Verdict,
}

/// All statements in the order of the thesis.
pub fn statements() -> impl Iterator<Item = &'static Statement> {
    [responses::ALL, coloration::ALL, hemodynamics::ALL, predictors::ALL].into_iter().flatten()
}

/// Judges all statements by numbers.
#[must_use]
pub fn judge(numbers: &Numbers) -> Vec<Judged> {
    let one = |statement: &'static Statement| Judged {
        statement,
        found: statement.test.found(numbers),
        verdict: statement.test.verdict(numbers),
    };
    statements().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_occur_once_and_every_statement_is_complete() {
        let mut names = BTreeSet::new();
        for one in statements() {
            assert!(names.insert(one.id), "{}", one.id);
            assert!(!one.says.is_empty() && !one.stated.is_empty() && !one.section.is_empty(), "{}", one.id);
            assert!(!one.test.names().is_empty(), "{}", one.id);
        }
        assert!(names.len() > 90, "{}", names.len());
    }

    #[test]
    fn every_verdict_turns_both_ways_with_its_numbers() {
        for one in statements() {
            assert!(matches!(one.test.verdict(&Numbers::default()), Verdict::CannotTell(_)), "{}", one.id);
            for (holds, expected) in [(true, Verdict::Agrees), (false, Verdict::DoesNot)] {
                let mut numbers = Numbers::default();
                one.test.make(holds, &mut numbers);
                assert_eq!(one.test.verdict(&numbers), expected, "{}: {numbers:?}", one.id);
            }
        }
    }

    #[test]
    fn with_a_number_missing_nothing_is_judged_and_it_is_named() {
        for one in statements() {
            let mut numbers = Numbers::default();
            one.test.make(true, &mut numbers);
            let lacking = one.test.names()[0];
            numbers.0.remove(lacking);
            match one.test.verdict(&numbers) {
                Verdict::CannotTell(why) => assert!(why.contains(lacking.split('.').next().unwrap()), "{why}"),
                other => panic!("{}: {other:?}", one.id),
            }
        }
    }
}
