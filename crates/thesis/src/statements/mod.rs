//! What the thesis' text says of its data figures, and whether a study's numbers agree.
//!
//! The statements are data: `statements.toml`, with each one's place in the thesis, its sentence, the test on
//! quantities by name that decides its [`Verdict`], and its [`Kind`], what agreement is worth on a phantom. Nothing
//! else decides. [`Statements::of_the_thesis`] reads them, [`Statements::judge`] compares them with [`Numbers`].

mod read;
mod test;
#[cfg(test)]
mod tests;

use std::fmt;

use serde::{Deserialize, Serialize};

use super::Numbers;
use lunula::words::in_order;
pub use read::StatementsError;
use test::Condition;

/// Where agreement comes from when the study is the phantom's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// The phantom was made after this sentence: agreement is no evidence.
    #[serde(rename = "put in")]
    PutIn,
    /// It is a consequence of the thesis' model, or of how models are trained, whatever sizes were assumed.
    Follows,
    /// It could have come out otherwise.
    Emerges,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::PutIn, Self::Follows, Self::Emerges];
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PutIn => "put in",
            Self::Follows => "follows",
            Self::Emerges => "emerges",
        })
    }
}

/// A computed figure that statements are tested by.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Quantity {
    /// Its name among the numbers, the part that it is of first.
    pub name: String,
    /// Its unit; empty for shares, counts and correlations.
    pub unit: String,
    /// What it means.
    pub means: String,
    /// The job that computes it.
    pub from: String,
}

/// Something that the thesis states.
#[derive(Debug, Clone)]
pub struct Statement {
    /// Its name, unlike any other's.
    pub id: String,
    /// The thesis' section.
    pub section: String,
    /// The thesis' figures, as `105-107`; empty: none.
    pub figure: String,
    /// What it says.
    pub sentence: String,
    /// What agreement is worth on a phantom.
    pub kind: Kind,
    /// What the judgement depends on; mostly empty.
    pub note: String,
    /// What is taken for agreeing, in words.
    pub test: String,
    conditions: Vec<Condition>,
}

/// All statements in the order of the thesis, and the quantities that they are tested by.
#[derive(Debug, Clone)]
pub struct Statements {
    /// The statements.
    pub all: Vec<Statement>,
    /// The quantities.
    pub quantities: Vec<Quantity>,
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
pub struct Judged<'a> {
    /// As it is in the thesis.
    pub statement: &'a Statement,
    /// What came out, in words: every quantity that is known.
    pub found: String,
    /// Whether it agrees.
    pub verdict: Verdict,
}

impl Statements {
    /// Judges all statements by numbers.
    #[must_use]
    pub fn judge(&self, numbers: &Numbers) -> Vec<Judged<'_>> {
        let one = |statement| Judged {
            statement,
            found: Statement::found(statement, numbers),
            verdict: Statement::verdict(statement, numbers),
        };
        self.all.iter().map(one).collect()
    }
}

impl Statement {
    /// The quantities that it depends on, each once.
    fn names(&self) -> Vec<&str> {
        in_order(self.conditions.iter().flat_map(Condition::names))
    }

    /// Whether the numbers agree. One condition that fails is enough, whatever is missing of the others.
    fn verdict(&self, numbers: &Numbers) -> Verdict {
        let held: Vec<Option<bool>> = self.conditions.iter().map(|one| one.holds(numbers)).collect();
        if held.contains(&Some(false)) {
            Verdict::DoesNot
        } else if held.contains(&None) {
            Verdict::CannotTell(self.lacking(numbers))
        } else {
            Verdict::Agrees
        }
    }

    /// Why it can't be judged.
    fn lacking(&self, numbers: &Numbers) -> String {
        let lacking: Vec<&str> = self.names().into_iter().filter(|name| numbers.get(name).is_none()).collect();
        let Some(part) = lacking.first().and_then(|name| name.split('.').next()) else {
            return "a quotient of zeros".to_owned();
        };
        if numbers.0.keys().any(|name| name.split('.').next() == Some(part)) {
            format!("not found: {}", lacking.join(", "))
        } else {
            format!("there are no results of \"{part}\"")
        }
    }

    /// What came out; names without their part where it is the same for all.
    fn found(&self, numbers: &Numbers) -> String {
        let names = self.names();
        let first = names.first().and_then(|name| Some(name.split_once('.')?.0)).unwrap_or_default();
        let part = format!("{first}.");
        let part = if names.iter().all(|name| name.starts_with(&part)) { part.as_str() } else { "" };
        in_order(self.conditions.iter().flat_map(|one| one.found(numbers, part))).join("; ")
    }
}
