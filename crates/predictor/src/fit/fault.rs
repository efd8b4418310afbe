//! Why there is no model, in the photodiodes' names.

use thiserror::Error;

use crate::{Dependent, LeastSquaresFault, ModelFault};

/// Why there is no model.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum FitFault {
    #[error("there are no rows to fit to")]
    NoRows,
    #[error("{terms} terms need at least {} rows; there are {rows} (record more, or ask for minimum norm, dropping or \
             ridge)", .terms + 1)]
    TooFewRows { rows: usize, terms: usize },
    #[error("{} (leave out what is at fault, or ask for minimum norm, dropping or ridge)", .0.join("; "))]
    Deficient(Vec<String>),
    #[error(
        "what {target} has of {term} is beyond what a number can hold (1e-308 to 1e308): {term} is too small or too \
         large beside {target}; write them in volts and newtons"
    )]
    Range { term: String, target: String },
    #[error("{0} spreads over so little (or so much) that its squares can't be computed; scale it to volts")]
    Scale(String),
    #[error(
        "no cell changes over the rows: there is nothing to learn from; name recordings in which the finger presses"
    )]
    Unchanging,
    #[error("{whole} of {rows} rows have all cells, and at least {needed} are needed{cell}")]
    TooFewWhole { whole: usize, rows: usize, cell: String, needed: usize },
    #[error(transparent)]
    Solver(LeastSquaresFault),
    #[error(transparent)]
    Model(#[from] ModelFault),
}

/// `names`: of the terms; `targets`: of the targets; `inputs`: how many of them are photodiodes themselves. Faults of
/// photodiodes explain those of their products, which are reported only where there are no others.
pub(super) fn named(fault: LeastSquaresFault, names: &[String], targets: &[String], inputs: usize) -> FitFault {
    match fault {
        LeastSquaresFault::NoRows => FitFault::NoRows,
        LeastSquaresFault::TooFewRows { rows, columns } => FitFault::TooFewRows { rows, terms: columns },
        LeastSquaresFault::Deficient { constant, dependent } => {
            let own = |j: &usize| *j < inputs;
            let of_inputs: Vec<Dependent> =
                dependent.iter().filter(|one| own(&one.column) && one.with.iter().all(own)).cloned().collect();
            let constants: Vec<usize> = constant.iter().copied().filter(own).collect();
            FitFault::Deficient(if of_inputs.is_empty() && constants.is_empty() {
                sentences(&constant, &dependent, names)
            } else {
                sentences(&constants, &of_inputs, names)
            })
        }
        LeastSquaresFault::Range { column, target } => {
            FitFault::Range { term: names[column].clone(), target: targets[target].clone() }
        }
        other => FitFault::Solver(other),
    }
}

fn sentences(constant: &[usize], dependent: &[Dependent], names: &[String]) -> Vec<String> {
    let mut out: Vec<String> = constant.iter().map(|&j| format!("{} is constant", names[j])).collect();
    // Those that read like the same one are reported together.
    let mut alike: Vec<Vec<usize>> = Vec::new();
    for one in dependent {
        if let [with] = one.with[..] {
            match alike.iter_mut().find(|group| group.contains(&with)) {
                Some(group) => group.push(one.column),
                None => alike.push(vec![with, one.column]),
            }
        }
    }
    for group in &mut alike {
        group.sort_unstable();
        out.push(format!("{} read alike", listed(group, names)));
    }
    out.extend(dependent.iter().filter(|one| one.with.len() != 1).map(|one| {
        let column = &names[one.column];
        if one.with.is_empty() {
            format!("{column} is constant")
        } else {
            format!("{column} follows from {}", listed(&one.with, names))
        }
    }));
    out
}

/// "P1, P2 and P5".
pub(super) fn listed(columns: &[usize], names: &[String]) -> String {
    match columns {
        [] => String::new(),
        [one] => names[*one].clone(),
        [head @ .., last] => {
            let head: Vec<&str> = head.iter().map(|&j| names[j].as_str()).collect();
            format!("{} and {}", head.join(", "), names[*last])
        }
    }
}
