//! Photodiodes that show nothing, or are cut off at the end of the recorded range.

use super::columns::cell;
use super::source::Source;
use crate::log::piles;

/// What is worth saying on a file's photodiodes. Rows that are left out for faults are not looked at; constant is one
/// that has a single value.
pub(super) fn warnings(source: &Source, keep_faults: bool) -> Vec<String> {
    let file = source.path.display();
    let mut warnings = Vec::new();
    let photodiodes = source.inputs.iter().zip(&source.x).filter(|(name, _)| cell(name).is_none());
    for (name, values) in photodiodes {
        let seen: Vec<f64> = values
            .iter()
            .zip(&source.faulty)
            .filter(|(value, faulty)| !value.is_nan() && (keep_faults || !**faulty))
            .map(|(value, _)| *value)
            .collect();
        let Some(&first) = seen.first() else { continue };
        if seen.len() > 1 && seen.iter().all(|&value| value == first) {
            warnings.push(format!(
                "{file}: {name} is {} V in all {} rows: dead or not connected",
                short(first),
                seen.len()
            ));
            continue;
        }
        for (pile, which) in piles(&seen).into_iter().zip(["least", "greatest"]) {
            let Some((value, count)) = pile else { continue };
            warnings.push(format!(
                "{file}: {name} stays at exactly {} V, its {which} value, in {count} of {} rows: saturated?",
                short(value),
                seen.len()
            ));
        }
    }
    warnings
}

/// A number without the hundreds of zeros of one near 1e-300, or the sign of one that is 0.
fn short(value: f64) -> String {
    let text = format!("{:?}", value + 0.0);
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
