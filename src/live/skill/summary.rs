//! Figures over trials and over people.

use std::collections::BTreeMap;

use lunula_live::spread::Spread;

use super::report::{FingerFigures, FingerSpread, MEASURES, PersonFigures, TrialFigures};
use crate::words::in_order;

pub(super) fn fingers(trials: &[TrialFigures]) -> Vec<String> {
    in_order(trials.iter().flat_map(|trial| &trial.fingers).map(|one| one.finger.clone()))
}

pub(super) fn people(trials: &[TrialFigures]) -> Vec<Option<String>> {
    in_order(trials.iter().map(|trial| trial.subject.clone()))
}

/// A person's figures over trials.
pub(super) fn person(subject: &Option<String>, trials: &[TrialFigures]) -> PersonFigures {
    let own: Vec<&TrialFigures> = trials.iter().filter(|trial| trial.subject == *subject).collect();
    let fingers = in_order(own.iter().flat_map(|trial| &trial.fingers).map(|one| one.finger.as_str()));
    let spread = |finger: &&str| {
        let all: Vec<&FingerFigures> =
            own.iter().flat_map(|trial| &trial.fingers).filter(|one| one.finger == *finger).collect();
        let over = |of: fn(&FingerFigures) -> Option<f64>| Spread::of(all.iter().filter_map(|one| of(one)));
        FingerSpread {
            finger: (*finger).to_owned(),
            over: MEASURES.iter().map(|measure| (measure.name, over(measure.of))).collect(),
        }
    };
    let mut first = BTreeMap::new();
    for finger in own.iter().filter_map(|trial| trial.first.clone()) {
        *first.entry(finger).or_default() += 1;
    }
    PersonFigures { subject: subject.clone(), trials: own.len(), fingers: fingers.iter().map(spread).collect(), first }
}

/// Each finger over the means of people who have names.
pub(super) fn over_people(people: &[PersonFigures]) -> Vec<FingerSpread> {
    let named = || people.iter().filter(|person| person.subject.is_some());
    let all = || named().flat_map(|person| &person.fingers);
    let one = |finger: &str| {
        let own = || all().filter(|one| one.finger == finger);
        let over = |name: &'static str| {
            let means = own().filter_map(|one| one.over.get(name).copied().flatten()).map(|spread| spread.mean);
            (name, Spread::of(means))
        };
        FingerSpread { finger: finger.to_owned(), over: MEASURES.iter().map(|measure| over(measure.name)).collect() }
    };
    in_order(all().map(|one| one.finger.as_str())).into_iter().map(one).collect()
}
