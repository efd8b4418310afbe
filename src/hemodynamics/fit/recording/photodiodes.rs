//! Which columns are photodiodes, and above which capillary units.

use super::ReadRecording;
use crate::hemodynamics::HemodynamicsError;
use crate::hemodynamics::given::listed;
use crate::words::{in_order, nearest};

/// A photodiode's column, and the capillary unit below it, from 0 at the proximal end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhotodiodeColumn {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: usize,
}

impl PhotodiodeColumn {
    /// Reads `COLUMN=UNIT`; the unit is counted from 1.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let wrong =
            || format!("{text:?}: write COLUMN=UNIT, such as P3=1; units are counted from 1 at the proximal end");
        let (name, unit) = text.split_once('=').ok_or_else(wrong)?;
        let unit = unit.trim().parse::<usize>().ok().and_then(|unit| unit.checked_sub(1)).ok_or_else(wrong)?;
        Ok(Self { name: name.trim().to_owned(), unit })
    }
}

/// The photodiodes of a recording with the columns `names`: those `named` that it has, or `VP1`, `VP2`, ..
///
/// # Errors
/// It has none, or the model lacks a unit.
pub(super) fn of(names: &[String], named: &[PhotodiodeColumn], units: usize) -> Result<Vec<PhotodiodeColumn>, String> {
    if !named.is_empty() {
        for one in named {
            if one.unit >= units {
                return Err(format!(
                    "--photodiode {}={}: the model has {units} units; --units says how many",
                    one.name,
                    one.unit + 1
                ));
            }
        }
        let own: Vec<PhotodiodeColumn> = named.iter().filter(|one| names.contains(&one.name)).cloned().collect();
        let wanted: Vec<&str> = named.iter().map(|one| one.name.as_str()).collect();
        return if own.is_empty() {
            Err(format!("has none of the photodiodes {}; its columns are {}", wanted.join(", "), listed(names)))
        } else {
            Ok(own)
        };
    }
    let usual = (0..units).map(|unit| PhotodiodeColumn { name: format!("VP{}", unit + 1), unit });
    let own: Vec<PhotodiodeColumn> = usual.filter(|one| names.contains(&one.name)).collect();
    if own.is_empty() {
        return Err(format!(
            "has none of VP1, .. VP{units}; --photodiode P3=1 says which column is above which unit; its columns \
             are {}",
            listed(names)
        ));
    }
    Ok(own)
}

/// That there are photodiodes `VP3`, .. above units that the model lacks, where nothing says which are meant.
pub(super) fn beyond(names: &[String], named: &[PhotodiodeColumn], units: usize) -> Option<String> {
    let number = |name: &&String| name.strip_prefix("VP")?.parse::<usize>().ok();
    let others: Vec<&str> =
        names.iter().filter(|name| number(name).is_some_and(|number| number > units)).map(String::as_str).collect();
    (named.is_empty() && !others.is_empty()).then(|| {
        format!(
            "{} is not used: the model has {units} units; say --units, or which column is above which unit \
             (--photodiode {}=1)",
            others.join(", "),
            others[0]
        )
    })
}

/// Whether a photodiode is the same wherever it is known, in two samples or more: stuck at a rail, or dead. Whatever is
/// fitted to it, its offset leaves no residual, and its noise would be what rounding leaves of its mean.
pub(super) fn is_constant(voltages_v: &[f64]) -> bool {
    let mut known = voltages_v.iter().filter(|value| value.is_finite());
    let first = known.next();
    let mut others = known.peekable();
    others.peek().is_some() && others.all(|value| Some(value) == first)
}

/// A photodiode of no more values, of which so many follow their equals, is mostly its converter's steps (measured on
/// phantoms with steps of 4.9 mV and noise of 1 mV, 3 values: 45 of 60 intervals of 95 % held k_C, with 3 mV 57; with
/// 0.5 and 0.3 mV and noise of 0.05 mV, 10 and 16 values: 0 and 2 of 20. Noise of half a step and more leaves below
/// half of the rows equal).
const FEW_VALUES: usize = 24;
const EQUAL: f64 = 0.6;
const LEAST_ROWS: usize = 50;

/// That a photodiode takes few values, and keeps each from row to row.
pub(super) fn takes_few_values(name: &str, voltages_v: &[f64]) -> Option<String> {
    let mut known: Vec<f64> = voltages_v.iter().copied().filter(|value| value.is_finite()).collect();
    let rows = known.len();
    let equal = known.windows(2).filter(|pair| pair[0] == pair[1]).count();
    known.sort_unstable_by(f64::total_cmp);
    known.dedup();
    (known.len() <= FEW_VALUES && rows >= LEAST_ROWS && equal as f64 > EQUAL * rows as f64).then(|| {
        format!(
            "{name} takes {} values in {rows} rows: what is seen of it are the converter's steps, and standard errors \
             are too small; record it with more gain, or leave it out",
            known.len()
        )
    })
}

/// Their names.
pub(super) fn in_words(photodiodes: &[PhotodiodeColumn]) -> String {
    photodiodes.iter().map(|one| one.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// Refuses a column that is named twice: it is one photodiode, above one unit.
///
/// # Errors
/// [`HemodynamicsError::Options`] with the first such column.
pub(in crate::hemodynamics::fit) fn none_twice(named: &[PhotodiodeColumn]) -> Result<(), HemodynamicsError> {
    let is_twice = |(k, own): &(usize, &PhotodiodeColumn)| named[..*k].iter().any(|before| before.name == own.name);
    named.iter().enumerate().find(is_twice).map_or(Ok(()), |(_, own)| {
        let what = format!("--photodiode {}: is named twice; a column is one photodiode, above one unit", own.name);
        Err(HemodynamicsError::Options(vec![what]))
    })
}

/// Refuses names that no recording has.
///
/// # Errors
/// [`HemodynamicsError::Options`] with all of them, the columns there are, and names near to them.
pub(in crate::hemodynamics::fit) fn all_there(
    named: &[PhotodiodeColumn],
    recordings: &[ReadRecording],
) -> Result<(), HemodynamicsError> {
    let there = in_order(recordings.iter().flat_map(|read| &read.columns).cloned());
    let unnamed: Vec<&str> =
        there.iter().map(String::as_str).filter(|name| named.iter().all(|one| one.name != *name)).collect();
    let missing = named.iter().filter(|one| !there.contains(&one.name)).map(|PhotodiodeColumn { name, unit }| {
        let near = nearest(name, &unnamed).map_or(String::new(), |near| format!("; did you mean `{near}`?"));
        format!("--photodiode {name}={}: no recording has this column; they have {}{near}", unit + 1, listed(&there))
    });
    let missing: Vec<String> = missing.collect();
    if missing.is_empty() { Ok(()) } else { Err(HemodynamicsError::Options(missing)) }
}

/// Notes of each recording the photodiodes of others that it lacks, unless it has one of its own above the same unit.
pub(in crate::hemodynamics::fit) fn note_lacking(recordings: &mut [ReadRecording]) {
    let mut all: Vec<(String, usize)> = Vec::new();
    for read in &*recordings {
        for (name, trace) in read.photodiodes.iter().zip(&read.recording.photodiodes) {
            if !all.iter().any(|(known, _)| known == name) {
                all.push((name.clone(), trace.unit));
            }
        }
    }
    for read in recordings {
        // Of a constant one a warning says that it is left out.
        let constant = read.constant.iter().map(|one| one.unit);
        let units: Vec<usize> = read.recording.photodiodes.iter().map(|trace| trace.unit).chain(constant).collect();
        let lacking = all.iter().filter(|(_, unit)| !units.contains(unit)).map(|(name, _)| name.as_str());
        let lacking: Vec<&str> = lacking.collect();
        if !lacking.is_empty() {
            read.notes.push(format!("lacks {}, which other recordings have: fitted without", lacking.join(", ")));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn photodiodes_above_no_unit_are_named() {
        let names = ["time_s", "VP1", "VP2", "VP3", "VPx"].map(str::to_owned);
        assert!(beyond(&names, &[], 2).is_some_and(|said| said.starts_with("VP3 is not used: the model has 2 units")));
        let named = PhotodiodeColumn::parse("VP2=1").expect("a photodiode");
        assert_eq!([beyond(&names, &[], 3), beyond(&names, &[named], 2)], [None, None]);
    }

    #[test]
    fn a_photodiode_of_few_steps_is_doubted() {
        let rounded = |step_v: f64| {
            let volts = |k: u32| (0.02 * (0.02 * f64::from(k)).sin() / step_v).round() * step_v;
            takes_few_values("VP1", &(0..400).map(volts).collect::<Vec<_>>())
        };
        assert!(rounded(0.01).is_some_and(|said| said.starts_with("VP1 takes 5 values in 400 rows")));
        assert_eq!(
            [rounded(0.0005), takes_few_values("VP1", &[1.0, 1.5, f64::NAN, 1.2]), takes_few_values("VP1", &[])],
            [(); 3].map(|()| None)
        );
    }
}
